"""Simulations in JAX."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import flexbody
from scenes import PROBLEMS
from scenes import PENDULUM

jax = pytest.importorskip("jax")
jnp = pytest.importorskip("jax.numpy")

from flexbody.jax import function, histories  # noqa: E402


@pytest.fixture(autouse=True)
def double_precision() -> Iterator[None]:
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", False)


@pytest.fixture(scope="module")
def trebuchet() -> flexbody.Problem:
    return flexbody.Problem.from_file(PROBLEMS / "trebuchet.json")


@pytest.fixture(scope="module")
def pendulum() -> flexbody.Problem:
    return flexbody.Problem.from_file(
        PROBLEMS / "extreme" / "flexible_pendulum.json", set={"/bodies/rod/beam/material/young": 1e8}
    )


def central(f: Any, x: Any, direction: Any, step: float) -> Any:
    """Derivative along a direction by differences of order six."""
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    return sum(w * (f(x + k * step * direction) - f(x - k * step * direction)) for k, w in weights.items()) / step


@pytest.mark.parametrize("name", ["trebuchet", "pendulum"])
def test_grad_of_a_program_around_a_simulation(name: str, request: pytest.FixtureRequest) -> None:
    problem = request.getfixturevalue(name)
    simulate = function(problem)
    scale = jnp.array(np.maximum(np.abs(problem.variables.start), 0.1))

    def cost(z: Any) -> Any:
        values = simulate(z * scale)
        return jnp.log(values[0] ** 2) + jnp.tanh(values[1] / 10) + (z**2).sum()

    z = jnp.array(problem.variables.start) / scale
    slope = jax.grad(cost)(z)
    assert np.asarray(jax.jit(jax.grad(cost))(z)) == pytest.approx(np.asarray(slope), rel=1e-12)
    for direction in np.eye(z.size):
        expected = float(central(cost, z, direction, 1e-4))
        assert float(slope @ direction) == pytest.approx(expected, rel=1e-8, abs=1e-8)


def test_forward_and_reverse_are_the_gradients_of_the_problem(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet, ["clearance", "range"])
    x = jnp.array(trebuchet.variables.start)
    exact = trebuchet.evaluate(None, ["clearance", "range"])
    assert np.asarray(simulate(x)) == pytest.approx(exact.values)
    for jacobian in (jax.jacfwd, jax.jacrev):
        assert np.asarray(jacobian(simulate)(x)) == pytest.approx(exact.gradients)


def test_vmap_and_mappings(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet, ["range"])
    x = jnp.array(trebuchet.variables.start)
    both = jax.vmap(simulate)(jnp.stack([x, x * 1.001]))
    assert both.shape == (2, 1)
    assert float(both[0, 0]) == pytest.approx(float(simulate(x)[0]))
    named = {name: float(value) for name, value in zip(trebuchet.variables.names, x, strict=True)}
    slope = jax.grad(lambda design: simulate(design)[0])(named)
    assert float(slope["arm mass"]) == pytest.approx(trebuchet.gradients(None, ["range"])[0, 2])
    with pytest.raises(ValueError, match="expected the variables"):
        simulate({"arm mass": 3.0})


def test_histories(pendulum: flexbody.Problem) -> None:
    at = np.linspace(0.1, 1.0, 10)
    motion = histories(pendulum, ["y", "x"], at)
    x = jnp.array(pendulum.variables.start)
    found = motion(x)
    assert found.shape == (2, 10)
    assert np.asarray(found[:, -1]) == pytest.approx(pendulum.values(None, ["y", "x"]), rel=1e-6)

    def cost(z: Any) -> Any:
        return (jnp.sin(motion(x * z)) ** 2).sum()

    z = jnp.ones(2)
    slope = jax.grad(cost)(z)
    assert np.asarray(jax.jit(jax.grad(cost))(z)) == pytest.approx(np.asarray(slope), rel=1e-12)
    for direction in np.eye(2):
        expected = float(central(cost, z, direction, 1e-4))
        assert float(slope @ direction) == pytest.approx(expected, rel=1e-8, abs=1e-8)
    whole = histories(pendulum, ["time"])(x)
    assert whole[0, 0] == 0 and whole[0, -1] == pytest.approx(1.0)


@pytest.fixture
def stopped() -> flexbody.Problem:
    """A pendulum whose duration is a variable."""
    duration = {"path": "/simulation/duration", "lower": 0.2, "upper": 2}
    return flexbody.Problem.from_dict({**PENDULUM, "variables": {"duration": duration}})


def test_instants_are_fixed_or_fractions_of_the_duration(stopped: flexbody.Problem) -> None:
    x = jnp.array([0.7])
    motion = histories(stopped, ["time", "height"], fractions=[0, 0.5, 1])
    assert np.asarray(motion(x)[0]) == pytest.approx([0, 0.35, 0.7])
    assert np.asarray(jax.jacrev(motion)(x)[0, :, 0]) == pytest.approx([0, 0.5, 1])
    speed = stopped.simulate([0.7]).histories["speed"][-1]
    assert float(jax.jacrev(motion)(x)[1, 2, 0]) == pytest.approx(speed, rel=1e-6)
    fixed = histories(stopped, ["time", "height"], at=[0.1, 0.5])
    assert np.asarray(jax.jacrev(fixed)(x)[:, :, 0]) == pytest.approx(np.zeros((2, 2)), abs=1e-4)
    with pytest.raises(ValueError, match="found both at and fractions"):
        histories(stopped, ["height"], [0.1], fractions=[0.1])
    with pytest.raises(ValueError, match="fractions: expected a list of numbers"):
        histories(stopped, ["height"], fractions=[[0.1]])


def test_a_motion_that_ends_before_the_last_instant_has_failed(stopped: flexbody.Problem) -> None:
    early = jnp.array([0.4])
    with pytest.raises(ValueError, match="instant"):
        histories(stopped, ["height"], at=[0.1, 0.5])(early)
    survives = histories(stopped, ["height"], at=[0.1, 0.5], failures="nan")
    assert np.isnan(survives(early)).all()
    assert np.isnan(jax.grad(lambda x: survives(x).sum())(early)).all()
    assert np.isfinite(survives(jnp.array([0.6]))).all()
    with pytest.raises(ValueError):
        histories(stopped, ["height"], at=[0.1, 5.0], failures="nan")


def test_a_function_named_time_is_this_function() -> None:
    named = {**PENDULUM, "functions": {**PENDULUM["functions"], "time": PENDULUM["functions"]["height"]}}
    problem = flexbody.Problem.from_dict(named)
    motion = histories(problem, ["time", "height"], at=[0.1, 0.5])
    x = jnp.array(problem.variables.start)
    found, slopes = motion(x), jax.jacrev(motion)(x)
    assert np.asarray(found[0]) == pytest.approx(np.asarray(found[1]), rel=1e-15)
    assert np.asarray(slopes[0]) == pytest.approx(np.asarray(slopes[1]), rel=1e-12)
    assert np.abs(slopes[0]).max() > 1e-3
    named["functions"]["time"] = "duration"
    with pytest.raises(ValueError, match='names: no "time"; there are height, speed'):
        histories(flexbody.Problem.from_dict(named), ["time"])


def test_single_precision_is_refused(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet)
    with pytest.raises(TypeError, match="x: expected float64, found float32"):
        simulate(jnp.zeros(6, dtype=jnp.float32))
    jax.config.update("jax_enable_x64", False)
    with pytest.raises(TypeError, match="jax_enable_x64"):
        simulate(jnp.zeros(6))


def test_wrong_arguments(trebuchet: flexbody.Problem) -> None:
    with pytest.raises(ValueError, match=r"x: expected shape \(6,\), found shape \(5,\)"):
        function(trebuchet)(jnp.zeros(5))
    with pytest.raises(ValueError, match='functions: no "rnage"; there are range, clearance'):
        function(trebuchet, ["rnage"])
    with pytest.raises(ValueError, match='names: no "rnage"'):
        histories(trebuchet, ["rnage"])
    with pytest.raises(TypeError, match='functions: expected a list of names, found "range"'):
        function(trebuchet, "range")
    with pytest.raises(ValueError, match='failures: expected "raise" or "nan"'):
        function(trebuchet, failures="ignore")


def test_second_derivatives_are_refused(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet)
    with pytest.raises(NotImplementedError, match="first derivatives only"):
        jax.hessian(lambda x: simulate(x)[0])(jnp.array(trebuchet.variables.start))


def test_failed_simulations() -> None:
    linkage = flexbody.Problem.from_file(PROBLEMS / "extreme" / "locking_linkage.json")
    far = jnp.array([9.0])
    simulate = function(linkage)
    with pytest.raises(flexbody.SimulationError):
        simulate(far)
    with pytest.raises(flexbody.SimulationError):
        jax.grad(lambda x: simulate(x)[0])(far)
    with pytest.raises(Exception, match="SimulationError"):
        jax.jit(simulate)(far)
    survives = function(linkage, failures="nan")
    assert np.isnan(survives(far)).all()
    assert np.isnan(jax.jit(jax.grad(lambda x: survives(x)[0]))(far)).all()
