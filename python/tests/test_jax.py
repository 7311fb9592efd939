"""Simulations in JAX."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexbody

jax = pytest.importorskip("jax")
jnp = pytest.importorskip("jax.numpy")

from flexbody.jax import function, histories  # noqa: E402

PROBLEMS = Path(__file__).parents[2] / "problems"


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
