"""Motions in Python: states against closed forms, and the exact derivatives of functions of histories."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import flexbody

from scenes import PENDULUM, PROBLEMS

Array = NDArray[np.float64]


def ball(**simulation: Any) -> flexbody.Problem:
    """A ball that is thrown up."""
    document = {
        "version": 1,
        "name": "ball",
        "gravity": [0, -10, 0],
        "bodies": {"ball": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2, "velocity": {"linear": [3, 4, 0]}}},
        "simulation": {"duration": 0.5, **simulation},
        "functions": {
            "x": {"final": {"position": {"body": "ball", "direction": [1, 0, 0]}}},
            "y": {"integral": {"position": {"body": "ball", "direction": [0, 1, 0]}}},
            "end": "duration",
        },
        "variables": {
            "up": {"path": "/bodies/ball/velocity/linear/1", "lower": 0, "upper": 9},
            "gravity": {"path": "/gravity/1", "lower": -20, "upper": -1},
        },
    }
    return flexbody.Problem.from_dict(document)


def test_states_are_those_of_a_throw() -> None:
    response = ball().simulate()
    t = response.times
    assert t[0] == 0 and t[-1] == response.duration == 0.5
    state = response.body("ball")
    assert state.position[:, 0] == pytest.approx(3 * t, abs=1e-12)
    assert state.position[:, 1] == pytest.approx(4 * t - 5 * t**2, abs=1e-10)
    assert state.velocity[:, 1] == pytest.approx(4 - 10 * t, abs=1e-10)
    assert state.orientation == pytest.approx(np.tile([1.0, 0, 0, 0], (len(t), 1)))
    assert response.histories["y"] == pytest.approx(state.position[:, 1], abs=1e-12)
    assert response.energy.kinetic == pytest.approx(9 + (4 - 10 * t) ** 2, abs=1e-9)
    assert response.energy.momentum[:, 0] == pytest.approx(6.0)
    assert response.drift["energy"] < 1e-9
    assert set(response.histories) == {"x", "y"}


def test_the_angular_velocity_is_in_ground_axes() -> None:
    """A body that has turned by a quarter about z and spins about its own x spins about y of the ground."""
    document: dict[str, Any] = {
        "version": 1,
        "name": "spin",
        "gravity": [0, 0, 0],
        "bodies": {
            "top": {
                "shape": {"sphere": {"radius": 0.5}},
                "mass": 1,
                "place": {"at": [0, 0, 0], "turn": {"axis": [0, 0, 1], "angle": np.pi / 2}},
                "velocity": {"angular": [0, 2, 0]},
            }
        },
        "simulation": {"duration": 0.1},
        "functions": {"spin": {"final": {"angular_velocity": {"body": "top", "direction": [0, 1, 0]}}}},
    }
    response = flexbody.Problem.from_dict(document).simulate()
    assert response.histories["spin"] == pytest.approx(2.0)
    spin = response.body("top").angular_velocity
    assert spin == pytest.approx(np.tile([0.0, 2.0, 0.0], (len(response.times), 1)), abs=1e-12)


def test_instants_between_samples() -> None:
    at = np.array([0.0, 0.1234, 0.25, 0.4999, 0.5])
    response = ball().simulate(at=at)
    assert response.times == pytest.approx(at)
    assert response.histories["y"] == pytest.approx(4 * at - 5 * at**2, abs=1e-10)
    assert response.body("ball").position[:, 0] == pytest.approx(3 * at, abs=1e-10)
    assert response.history_error("y") < 1e-9
    for wrong in ([0.6], [-0.1], [np.nan]):
        with pytest.raises(ValueError, match="expected one between 0 and the end"):
            ball().simulate(at=wrong)
    with pytest.raises(ValueError, match="expected one dimension"):
        ball().simulate(at=[[0.1]])


METHODS: list[dict[str, Any]] = [
    {},
    {"steps": 60},
    {"steps": 60, "method": {"radau": {"stages": 3}}},
    {"steps": 60, "method": {"bdf": {"order": 2}}},
    {"steps": 60, "method": {"generalised_alpha": {"radius": 0.8}}},
]


@pytest.mark.parametrize("simulation", METHODS, ids=lambda own: str(own.get("method", own or "default")))
@pytest.mark.parametrize("at", [None, [0.1, 0.33, 0.4]], ids=["samples", "between"])
def test_functions_of_histories_have_exact_derivatives(simulation: dict[str, Any], at: Any) -> None:
    """Σ sin(y_k) + Σ x_k² against central differences."""
    document: dict[str, Any] = copy.deepcopy(PENDULUM)
    document["simulation"] = {"duration": 0.5, **simulation}
    document["variables"]["length"] = {"path": "/bodies/bar/shape/box/size/0", "lower": 0.5, "upper": 2}
    problem = flexbody.Problem.from_dict(document)

    def value(x: Array) -> float:
        histories = problem.simulate(x, at=at).histories
        return float(np.sin(histories["height"]).sum() + (histories["speed"] ** 2).sum())

    x = problem.variables.start.copy()
    response = problem.simulate(x, at=at)
    cotangents = {"height": np.cos(response.histories["height"]), "speed": 2 * response.histories["speed"]}
    gradient = response.pull_back(cotangents)
    assert gradient == pytest.approx(differences(value, x), rel=1e-6, abs=1e-6 * np.abs(gradient).max())


def differences(value: Callable[[Array], float], x: Array, h: float = 1e-4) -> Array:
    found = np.zeros_like(x)
    for i in range(len(x)):
        step = h * max(abs(x[i]), 1e-2)
        moved = [x.copy() for _ in range(4)]
        for k, factor in enumerate((-2, -1, 1, 2)):
            moved[k][i] += factor * step
        v = [value(own) for own in moved]
        found[i] = (v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * step)
    return found


def test_the_last_instant_gives_the_gradient_of_a_final_value(pendulum: flexbody.Problem) -> None:
    response = pendulum.simulate()
    last = np.zeros_like(response.times)
    last[-1] = 1
    assert response.pull_back({"height": last}).tolist() == response.gradients[0].tolist()
    rows = response.pull_back_all([{"height": last}, {"speed": last}, {"height": last, "speed": 2 * last}])
    assert rows.shape == (3, 2)
    assert rows[2] == pytest.approx(rows[0] + 2 * rows[1], rel=1e-13, abs=1e-13)


def test_instants_move_with_a_designed_duration() -> None:
    """Instants keep their fraction s of the duration T: y(s T) = 4 s T − 5 (s T)², and t = s T itself."""
    document: dict[str, Any] = ball().to_dict()
    document["variables"]["duration"] = {"path": "/simulation/duration", "lower": 0.1, "upper": 1}
    problem = flexbody.Problem.from_dict(document)
    response = problem.simulate()
    weights = np.linspace(-1, 2, len(response.times))
    t = response.times
    by_y = response.pull_back({"y": weights})
    assert by_y[2] == pytest.approx((weights * (4 - 10 * t) * t / 0.5).sum(), rel=1e-9)
    assert by_y[0] == pytest.approx((weights * t).sum(), rel=1e-9)
    by_time = response.pull_back({"time": weights})
    assert by_time == pytest.approx([0, 0, (weights * t / 0.5).sum()], abs=1e-9)


def test_an_event_moves_the_instants() -> None:
    """A ball that falls to the ground y = −1: its last instant is that of the event, y does not move there."""
    document: dict[str, Any] = ball().to_dict()
    height = {"position": {"body": "ball", "direction": [0, 1, 0]}}
    document["simulation"] = {"duration": 5, "until": {"measure": height, "reaches": -1}}
    problem = flexbody.Problem.from_dict(document)
    response = problem.simulate()
    end = (4 + np.sqrt(16 + 20)) / 10
    assert response.times[-1] == pytest.approx(end, rel=1e-9)
    last = np.zeros_like(response.times)
    last[-1] = 1
    assert response.pull_back({"y": last}) == pytest.approx([0, 0], abs=1e-9)
    # dT/dv = (1 + v/√(v² + 2 g h)) / g, and x = 3 T.
    by_up = (1 + 4 / 6) / 10
    assert response.pull_back({"time": last})[0] == pytest.approx(by_up, rel=1e-9)
    assert response.pull_back({"x": last})[0] == pytest.approx(3 * by_up, rel=1e-9)


def test_wrong_cotangents_are_refused_by_name(pendulum: flexbody.Problem) -> None:
    response = pendulum.simulate(at=[0.1, 0.2])
    for cotangents, message in [
        ({"hieght": [1, 2]}, "found no history of 'hieght'"),
        ({"mass": [1, 2]}, '"mass" has no history'),
        ({"height": [1]}, r"of shape \(1,\) of 'height', expected numbers of shape \(2,\)"),
        ({"height": ["a", "b"]}, "found the cotangent"),
    ]:
        with pytest.raises((KeyError, ValueError, flexbody.SimulationError), match=message):
            response.pull_back(cotangents)
    with pytest.raises(KeyError, match="expected one of: bar"):
        response.body("bra")
    with pytest.raises(KeyError, match="expected one of: hinge"):
        response.reaction("hing")


def test_reactions_carry_the_weight(pendulum: flexbody.Problem) -> None:
    """F = m (a − g) of the only body."""
    response = pendulum.simulate()
    force = response.reaction("hinge").force
    velocity = response.body("bar").velocity
    acceleration = np.gradient(velocity, response.times, axis=0, edge_order=2)
    assert force == pytest.approx(acceleration - [0, -9.81, 0], abs=1e-3)


def test_elastic_bodies_have_coordinates_and_stresses() -> None:
    problem = flexbody.Problem.from_file(PROBLEMS / "flexible" / "trebuchet_flexible_arm.json")
    response = problem.simulate(at=np.linspace(0, 1, 5))
    arm = response.elastic("arm")
    assert arm.coordinates.shape == arm.rates.shape and len(arm.coordinates) == 5
    assert np.abs(arm.coordinates).max() > 1e-3
    assert response.stresses["arm"].shape == (5,) and response.stresses["arm"].max() > 0
    with pytest.raises(KeyError, match="expected one of: arm"):
        response.elastic("stone")


def test_a_frame_of_pandas(pendulum: flexbody.Problem) -> None:
    pytest.importorskip("pandas")
    response = pendulum.simulate()
    table = response.to_pandas()
    assert table.index.name == "time [s]" and len(table) == len(response.times)
    assert table["height"].tolist() == response.histories["height"].tolist()
    assert table["bar: position x"].iloc[0] == pytest.approx(0.5)


def test_fixed_instants_keep_their_time_where_the_end_moves() -> None:
    """A ball that falls to the ground: at fixed instants its height is 4 t − 5 t², whatever ends the motion."""
    document: dict[str, Any] = ball().to_dict()
    height = {"position": {"body": "ball", "direction": [0, 1, 0]}}
    document["simulation"] = {"duration": 5, "until": {"measure": height, "reaches": -1}}
    problem = flexbody.Problem.from_dict(document)
    at = np.array([0.0, 0.1, 0.35, 0.8])
    response = problem.simulate(at=at)
    assert response.histories["y"] == pytest.approx(4 * at - 5 * at**2, abs=1e-9)
    weights = np.array([3.0, -1.0, 2.0, 0.5])
    by_up, by_gravity = response.pull_back({"y": weights})
    assert by_up == pytest.approx((weights * at).sum(), rel=1e-7)
    assert by_gravity == pytest.approx((weights * at**2 / 2).sum(), rel=1e-7)
    assert response.pull_back({"time": weights}).tolist() == [0, 0]
    # As fractions of the duration they move with the end.
    moving = problem.simulate(fractions=at / response.duration)
    assert moving.times == pytest.approx(at)
    assert abs(moving.pull_back({"y": weights})[0] - by_up) > 0.01
    assert moving.pull_back({"time": [0, 0, 0, 1.0]})[0] > 0.01
    with pytest.raises(ValueError, match="found the fraction 1.5"):
        problem.simulate(fractions=[1.5])
    with pytest.raises(ValueError, match="expected one of both"):
        problem.simulate(at=at, fractions=at)


def test_fixed_instants_of_a_machine_against_differences() -> None:
    """The trebuchet whose sling lets go at an angle: the end of the motion is an event."""
    problem = flexbody.Problem.from_file(PROBLEMS / "trebuchet_release_angle.json")
    at = np.linspace(0.1, 0.9, 9) * problem.simulate().duration * 0.95

    def value(x: Array) -> float:
        return float((problem.simulate(x, at=at).histories["range"] ** 2).sum())

    x = problem.variables.start.copy()
    response = problem.simulate(x, at=at)
    gradient = response.pull_back({"range": 2 * response.histories["range"]})
    expected = differences(value, x, 1e-5)
    scale = np.abs(expected * problem.variables.scale).max() / problem.variables.scale
    assert np.abs((gradient - expected) / scale).max() < 1e-5


def test_a_function_of_the_name_time_is_a_function() -> None:
    document = ball().to_dict()
    document["functions"]["time"] = document["functions"].pop("y")
    problem = flexbody.Problem.from_dict(document)
    response = problem.simulate(at=[0.1, 0.2])
    assert response.histories["time"] == pytest.approx([0.35, 0.6], abs=1e-9)
    assert response.pull_back({"time": [0, 1.0]}) == pytest.approx([0.2, 0.02], abs=1e-7)


def test_a_response_is_freed_with_its_last_name(pendulum: flexbody.Problem) -> None:
    import weakref

    response = pendulum.simulate()
    response.histories["height"]
    seen = weakref.ref(response)
    del response
    assert seen() is None


def test_cotangents_that_are_not_finite_are_refused(pendulum: flexbody.Problem) -> None:
    with pytest.raises(ValueError, match="cotangent of 'height' that is not finite"):
        pendulum.simulate(at=[0.1]).pull_back({"height": [np.nan]})
