"""Problems in Python: the numbers of the command, arrays of any kind, faults that read well."""

from __future__ import annotations

import copy
import json
import multiprocessing
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexbody

from scenes import PENDULUM, PROBLEMS


def test_variables_and_functions_have_names_units_and_bounds(trebuchet: flexbody.Problem) -> None:
    assert trebuchet.name == "trebuchet"
    assert trebuchet.variables.names[:2] == ("counterweight mass", "link mass")
    assert trebuchet.variables.units == ("kg",) * 5 + ("rad",)
    assert trebuchet.variables.lower[0] == 300 and trebuchet.variables.upper[0] == 500
    assert trebuchet.functions.names == ("range", "clearance") and trebuchet.functions.units == ("m", "m")
    assert trebuchet.objective == flexbody.Objective("range", "maximise")
    (constraint,) = trebuchet.constraints
    assert (constraint.function, constraint.lower, constraint.upper) == ("clearance", 0, np.inf)
    with pytest.raises(ValueError):
        trebuchet.variables.start[0] = 1.0


@pytest.mark.parametrize("name", ["trebuchet.json", "trebuchet_release_time.json", "plate_stress.json"])
def test_gradients_are_those_of_the_command_to_the_last_bit(name: str, optimize: str, tmp_path: Path) -> None:
    """The log of an optimisation has the values and gradients of its start."""
    document = json.loads((PROBLEMS / name).read_text())
    document["optimiser"] = {**document.get("optimiser", {}), "iterations": 1}
    (tmp_path / "one.json").write_text(json.dumps(document))
    run = [optimize, str(tmp_path / "one.json"), "--output", str(tmp_path / "out"), "--quiet", "--no-certificate"]
    subprocess.run(run, capture_output=True, timeout=300)
    rows = [json.loads(line) for line in (tmp_path / "out" / "evaluations.jsonl").read_text().splitlines()]
    functions = rows[0]["functions"]
    problem = flexbody.Problem.from_file(PROBLEMS / name)
    start = problem.variables.start.tolist()
    of_start = [row for row in rows[1:] if row["design"] == start]
    values = next(row["values"] for row in of_start if "values" in row)
    gradients = next(row["gradients"] for row in of_start if "gradients" in row)
    found = problem.evaluate(functions=functions)
    assert found.values.tolist() == values
    assert found.gradients.tolist() == gradients


def test_values_and_gradients_by_array_and_by_name(pendulum: flexbody.Problem) -> None:
    x = [-9.81, 1.0]
    values = pendulum.values(x)
    assert values.shape == (3,) and pendulum.gradients(x).shape == (3, 2)
    both = pendulum.evaluate({"mass": 1.0, "gravity": -9.81})
    assert both["height"] == values[0] and both.gradient("mass") == {"gravity": 0.0, "mass": 1.0}
    assert list(both) == ["height", "speed", "mass"] and dict(both)["mass"] == 1
    assert pendulum.values(x, functions=["mass", "height"]).tolist() == [values[2], values[0]]


def test_the_gradient_is_that_of_the_values(pendulum: flexbody.Problem) -> None:
    h = 1e-4
    difference = (pendulum.values([-9.81 + h, 1]) - pendulum.values([-9.81 - h, 1])) / (2 * h)
    assert pendulum.gradients()[:, 0] == pytest.approx(difference, rel=1e-6)


@pytest.mark.parametrize("kind", ["int", "float32", "strided", "list", "reversed"])
def test_arrays_of_other_kinds_are_converted(pendulum: flexbody.Problem, kind: str) -> None:
    x: Any = {
        "int": np.array([-10, 1]),
        "float32": np.array([-10, 1], dtype=np.float32),
        "strided": np.array([-10.0, 7.0, 1.0, 7.0])[::2],
        "list": [-10, 1],
        "reversed": np.array([1.0, -10.0])[::-1],
    }[kind]
    assert pendulum.values(x).tolist() == pendulum.values([-10.0, 1.0]).tolist()


@pytest.mark.parametrize(
    ("x", "message"),
    [
        ([1.0], r"found a design of shape \(1,\), expected \(2,\)"),
        ([[1.0, 2.0]], r"found a design of shape \(1, 2\)"),
        (np.array([1j, 1]), "found a design of type complex128, expected real numbers"),
        (np.array(["a", "b"]), "found a design of type <U1"),
        ([np.nan, 1.0], 'found NaN for the variable "gravity", expected a finite number'),
        ([-9.81, np.inf], 'found inf for the variable "mass"'),
        ({"gravity": "9"}, "found '9' for the variable 'gravity', expected a real number"),
        ({"gravity": None}, "found None for the variable 'gravity'"),
        ([[1.0], [1.0, 2.0]], "found a ragged design"),
        ({"gravty": -9.0}, "found the variable 'gravty', expected one of the problem; did you mean 'gravity'?"),
    ],
)
def test_wrong_designs_are_refused_by_name(pendulum: flexbody.Problem, x: Any, message: str) -> None:
    with pytest.raises((ValueError, TypeError, KeyError), match=message):
        pendulum.values(x)


def test_wrong_functions_are_refused_by_name(pendulum: flexbody.Problem) -> None:
    with pytest.raises(KeyError, match="did you mean 'height'"):
        pendulum.values(functions=["hieght"])
    with pytest.raises(TypeError, match="expected a list of names"):
        pendulum.values(functions="height")


def test_faults_of_a_file_have_lines(tmp_path: Path) -> None:
    path = tmp_path / "wrong.json"
    document = copy.deepcopy(PENDULUM)
    document["bodies"]["bar"]["mas"] = document["bodies"]["bar"].pop("mass")
    path.write_text(json.dumps(document, indent=1))
    with pytest.raises(flexbody.ProblemError) as caught:
        flexbody.Problem.from_file(path)
    faults = caught.value.faults
    assert any(fault.path == "/bodies/bar/mas" and fault.line > 1 and '"mass"' in str(fault.hint) for fault in faults)
    assert "wrong.json:" in str(caught.value)
    with pytest.raises(flexbody.ProblemError, match="no file"):
        flexbody.Problem.from_file(tmp_path / "none.json")


def test_all_faults_of_a_document_are_told() -> None:
    document: dict[str, Any] = copy.deepcopy(PENDULUM)
    document["bodies"]["bar"]["mass"] = -1
    document["joints"]["hinge"]["revolute"]["between"] = ["bar", "grund"]
    with pytest.raises(flexbody.ProblemError) as caught:
        flexbody.Problem.from_dict(document)
    paths = [fault.path for fault in caught.value.faults]
    assert "/bodies/bar/mass" in paths and "/joints/hinge/revolute/between/1" in paths
    assert isinstance(caught.value, ValueError)
    document["bodies"]["bar"]["mass"] = float("nan")
    with pytest.raises(flexbody.ProblemError, match="what JSON does not have"):
        flexbody.Problem.from_dict(document)


def test_changes_and_the_way_back_to_a_file(tmp_path: Path) -> None:
    moon = flexbody.Problem.from_dict(PENDULUM, set={"/gravity/1": -1.62})
    assert moon.variables.start[0] == -1.62
    moon.to_file(tmp_path / "moon.json")
    again = flexbody.Problem.from_file(tmp_path / "moon.json")
    assert again.to_dict() == moon.to_dict()
    assert again.values().tolist() == moon.values().tolist()
    document = copy.deepcopy(PENDULUM)
    document["gravity"] = np.array([0, -1.62, 0])
    assert flexbody.Problem.from_dict(document).values().tolist() == moon.values().tolist()
    with pytest.raises(flexbody.ProblemError, match="/gravty/1"):
        flexbody.Problem.from_dict(PENDULUM, set={"/gravty/1": -1.62})


def test_changes_have_any_path(tmp_path: Path) -> None:
    document = copy.deepcopy(PENDULUM)
    document["bodies"]["a=b"] = {"shape": {"sphere": {"radius": 1}}, "mass": 1}
    found = flexbody.Problem.from_dict(document, set={"/bodies/a=b/mass": np.float64(2.0)})
    assert found.values(functions=["mass"]).tolist() == [3.0]
    for wrong, message in [
        ({"gravity": 1}, "expected a JSON Pointer"),
        ({"/gravity/1": float("nan")}, "not JSON compliant"),
        ([1], "expected a mapping of paths"),
    ]:
        with pytest.raises((ValueError, TypeError), match=message):
            flexbody.Problem.from_dict(PENDULUM, set=wrong)  # type: ignore[arg-type]


def test_problems_are_pickled(pendulum: flexbody.Problem, trebuchet: flexbody.Problem) -> None:
    for problem in (pendulum, trebuchet):
        again = pickle.loads(pickle.dumps(problem))
        assert again.values().tolist() == problem.values().tolist()
        assert copy.deepcopy(problem).name == problem.name
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(pendulum.values).tolist() == pendulum.values().tolist()


def test_a_problem_with_files_beside_it_stays_there(tmp_path: Path) -> None:
    bracket = flexbody.Problem.from_file(PROBLEMS / "flexible" / "modal_bracket.json")
    with pytest.raises(ValueError, match="names files in"):
        bracket.to_file(tmp_path / "bracket.json")
    folder = PROBLEMS / "flexible"
    again = flexbody.Problem.from_dict(bracket.to_dict(), directory=folder)
    assert again.variables.names == bracket.variables.names


def test_modes_are_as_many_as_there_are() -> None:
    problem = flexbody.Problem.from_dict(
        {
            "version": 1,
            "name": "strip",
            "materials": {"steel": {"young": 2e11, "poisson": 0.3, "density": 7800, "yield_stress": 3e8}},
            "structures": {
                "strip": {
                    "mesh": {"plate": {"length": 1, "width": 0.1, "elements": [1, 1]}},
                    "material": "steel",
                    "thickness": 0.01,
                    "supports": {"wall": {"nodes": ["x0"]}},
                }
            },
            "load_cases": {"push": {"p": {"pressure": {"faces": "all", "pressure": 1}}}},
            "functions": {"mass": "mass"},
        }
    )
    assert 0 < len(problem.modes(count=10**6)) < 100


def test_designs_without_values_are_exceptions() -> None:
    """A rod between two cranks of 1 m, whose axles are 2 m apart, is at most 4 m long."""
    document: dict[str, Any] = copy.deepcopy(PENDULUM)
    rocker = copy.deepcopy(document["bodies"]["bar"])
    rocker["place"] = {"put": "pin", "at": [2, 0, 0], "turn": {"axis": [0, 0, 1], "angle": 1}}
    document["bodies"]["rocker"] = rocker
    document["joints"] |= {
        "axle": {"revolute": {"between": ["rocker", "ground"], "at": [2, 0, 0], "axis": [0, 0, 1]}},
        "rod": {"rod": {"between": ["bar", "rocker"], "at": {"a": "tip", "b": "tip"}, "length": 2}},
    }
    document["simulation"]["duration"] = 0.1
    document["variables"] = {"length": {"path": "/joints/rod/rod/length", "lower": 0.1, "upper": 6}}
    problem = flexbody.Problem.from_dict(document)
    before = problem.values([2.0])
    for x in ([5.0], [4.1]):
        with pytest.raises(flexbody.SimulationError, match="cannot be assembled"):
            problem.values(x)
        with pytest.raises(flexbody.SimulationError):
            problem.simulate(x)
    # The problem is as good as before.
    assert problem.values([2.0]).tolist() == before.tolist()


def test_check_compares_every_derivative(pendulum: flexbody.Problem) -> None:
    check = pendulum.check()
    assert check.passed and len(check.rows) == 6 and check.worst < 1e-10
    assert "6 derivatives" in check.verdict and "height" in str(check)
    assert not pendulum.check(tolerance=0.0).passed


def test_steps_are_kept_and_forgotten(trebuchet: flexbody.Problem) -> None:
    start = trebuchet.values()
    moved = trebuchet.variables.start * [1, 1, 1.1, 1, 1, 1]
    on_kept_steps = trebuchet.values(moved)
    trebuchet.forget_steps()
    on_own_steps = trebuchet.values(moved)
    assert on_kept_steps == pytest.approx(on_own_steps, rel=1e-6)
    assert on_kept_steps.tolist() != on_own_steps.tolist()
    trebuchet.forget_steps()
    assert trebuchet.values().tolist() == start.tolist()


def test_rest_and_modes_of_structures() -> None:
    problem = flexbody.Problem.from_file(PROBLEMS / "plate_stress.json")
    assert problem.is_at_rest
    rest = problem.rest()
    case = next(iter(rest.cases.values()))
    assert rest.nodes.shape == case.displacement.shape and case.shell_stress.min() > 0
    assert rest.values.tolist() == problem.values().tolist()
    modes = problem.modes(count=3)
    assert len(modes) == 3 and modes.shapes.shape == (3, *rest.nodes.shape)
    frequencies = [name for name in problem.functions.names if "frequency" in name]
    assert frequencies
    assert modes.frequencies[0] == pytest.approx(problem.values(functions=frequencies)[0], rel=1e-9)
    with pytest.raises(flexbody.SimulationError, match="do not move"):
        problem.simulate()


def test_rest_of_a_motion_is_its_equilibrium() -> None:
    """A clamped beam under its weight, small displacements: its tip hangs lower by q l⁴ / (8 E I)."""
    document: dict[str, Any] = {
        "version": 1,
        "name": "cantilever",
        "gravity": [0, 0, -9.81],
        "start": "equilibrium",
        "bodies": {
            "beam": {
                "beam": {
                    "length": 1,
                    "section": {"rectangle": {"width": 0.02, "height": 0.02}},
                    "material": {"young": 7e10, "density": 2700},
                },
                "place": {"put": "start", "at": [0, 0, 0]},
            }
        },
        "joints": {"clamp": {"weld": {"between": ["beam", "ground"], "at": [0, 0, 0]}}},
        "simulation": {"duration": 0.01},
        "functions": {"z": {"final": {"position": {"body": "beam", "point": "end", "direction": [0, 0, 1]}}}},
    }
    problem = flexbody.Problem.from_dict(document)
    rest = problem.rest()
    assert isinstance(rest, dict)
    assert rest["beam"].velocity == pytest.approx([0, 0, 0], abs=1e-12)
    assert len(rest["beam"].elastic) > 0
    exact = -2700 * 0.02**2 * 9.81 / (8 * 7e10 * 0.02**4 / 12)
    assert problem.simulate(at=[0]).histories["z"][0] == pytest.approx(exact, rel=1e-2)
    with pytest.raises(ValueError, match="equilibrium"):
        flexbody.Problem.from_dict(PENDULUM).rest()
    with pytest.raises(flexbody.SimulationError, match="no structures"):
        problem.modes()


def test_a_machine_rests() -> None:
    problem = flexbody.Problem.from_file(PROBLEMS / "desk_lamp.json")
    rest = problem.rest()
    assert isinstance(rest, dict)
    height, reach = problem.values(functions=["height", "reach"])
    assert rest["lamp"].position[:2] == pytest.approx([reach, height], abs=1e-12)
    assert rest["lamp"].velocity == pytest.approx([0, 0, 0], abs=0)
    response = problem.simulate()
    assert len(response.times) == 1 and response.histories["height"] == pytest.approx([height], abs=1e-12)


def test_a_page_shows_the_motion(pendulum: flexbody.Problem, tmp_path: Path) -> None:
    page = pendulum.animate()
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page.html and page.html.startswith("<!")
    assert "<iframe srcdoc=" in page._repr_html_()


def test_cases_are_problems_of_their_own() -> None:
    document = copy.deepcopy(PENDULUM)
    document["cases"] = {"short": {}, "long": {"set": {"/simulation/duration": 2 * document["simulation"]["duration"]}}}
    name = next(iter(document["functions"]))
    document["functions"]["mean"] = {"over_cases": {"function": name, "by": "mean"}}
    for key in ("objective", "constraints"):
        document.pop(key, None)
    problem = flexbody.Problem.from_dict(document)
    assert problem.cases == ("short", "long")
    assert {f"{name} in short", f"{name} in long", "mean"} <= set(problem.functions.names)
    values = problem.evaluate()
    assert np.isclose(values["mean"], (values[f"{name} in short"] + values[f"{name} in long"]) / 2, rtol=1e-15)
    short, long = problem.case("short"), problem.case("long")
    assert short.cases == () and short.functions.names[0] == name
    assert values[f"{name} in long"] == long.evaluate()[name]
    assert long.simulate().duration == 2 * short.simulate().duration
    assert problem.check().passed
    with pytest.raises(KeyError, match="did you mean 'long'"):
        problem.case("lon")
    with pytest.raises(flexbody.SimulationError, match="cases"):
        problem.simulate()
