"""Simulations in PyTorch."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexbody
from scenes import PROBLEMS
from scenes import PENDULUM

torch = pytest.importorskip("torch")

from flexbody.torch import function, histories  # noqa: E402


@pytest.fixture(scope="module")
def trebuchet() -> flexbody.Problem:
    return flexbody.Problem.from_file(PROBLEMS / "trebuchet.json")


@pytest.fixture(scope="module")
def pendulum() -> flexbody.Problem:
    return flexbody.Problem.from_file(
        PROBLEMS / "extreme" / "flexible_pendulum.json", set={"/bodies/rod/beam/material/young": 1e8}
    )


def start(problem: flexbody.Problem) -> Any:
    return torch.tensor(np.array(problem.variables.start), requires_grad=True)


@pytest.mark.parametrize(("name", "step", "error"), [("trebuchet", 2e-6, 4e-8), ("pendulum", 1e-5, 1e-8)])
def test_gradcheck(name: str, step: float, error: float, request: pytest.FixtureRequest) -> None:
    """To the accuracy of its differences of order two; those of order six below are better."""
    problem = request.getfixturevalue(name)
    simulate = function(problem)
    size = torch.tensor(np.maximum(np.abs(problem.variables.start), 0.1))
    values = simulate(start(problem)).detach()

    def relative(z: Any) -> Any:
        return simulate(z * size) / values

    z = (start(problem).detach() / size).requires_grad_()
    assert torch.autograd.gradcheck(relative, (z,), eps=step, atol=error, rtol=error)


@pytest.mark.parametrize("name", ["trebuchet", "pendulum"])
def test_gradients_of_a_program_to_eight_digits(name: str, request: pytest.FixtureRequest) -> None:
    problem = request.getfixturevalue(name)
    simulate = function(problem)
    size = torch.tensor(np.maximum(np.abs(problem.variables.start), 0.1))

    def cost(z: Any) -> Any:
        values = simulate(z * size)
        return torch.log(values[0] ** 2) + torch.tanh(values[1] / 10) + (z**2).sum()

    z = (start(problem).detach() / size).requires_grad_()
    (slope,) = torch.autograd.grad(cost(z), z)
    weights, step = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}, 1e-4
    with torch.no_grad():
        for i, direction in enumerate(torch.eye(z.numel(), dtype=torch.float64)):
            expected = sum(
                w * (cost(z + k * step * direction) - cost(z - k * step * direction)) for k, w in weights.items()
            )
            assert float(slope[i]) == pytest.approx(float(expected) / step, rel=1e-8, abs=1e-8)


def test_batches_and_mappings(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet, ["range", "clearance"])
    x = start(trebuchet).detach()
    batch = torch.stack([x, x * 1.001]).requires_grad_()
    values = simulate(batch)
    assert values.shape == (2, 2)
    weights = torch.tensor([[1.0, 2.0], [3.0, 4.0]], dtype=torch.float64)
    (values * weights).sum().backward()
    for row in range(2):
        exact = trebuchet.gradients(batch[row].detach().numpy(), ["range", "clearance"])
        assert batch.grad[row].numpy() == pytest.approx(weights[row].numpy() @ exact)
    assert simulate(batch.reshape(1, 2, -1)).shape == (1, 2, 2)
    named = {name: x[i] for i, name in enumerate(trebuchet.variables.names)}
    assert float(simulate(named)[0]) == pytest.approx(float(values[0, 0].detach()))
    with pytest.raises(ValueError, match="expected the variables"):
        simulate({"arm mass": x[0]})


def test_histories(pendulum: flexbody.Problem) -> None:
    at = np.linspace(0.1, 1.0, 10)
    motion = histories(pendulum, ["y", "x"], at)
    x = start(pendulum)
    found = motion(x)
    assert found.shape == (2, 10)
    assert found[:, -1].detach().numpy() == pytest.approx(pendulum.values(None, ["y", "x"]), rel=1e-6)

    def cost(z: Any) -> Any:
        return (torch.sin(motion(x.detach() * z)) ** 2).sum()

    z = torch.ones(2, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(cost, (z,), eps=1e-5, atol=1e-6, rtol=1e-4)
    assert motion(torch.stack([x, x])).shape == (2, 2, 10)


@pytest.fixture
def stopped() -> flexbody.Problem:
    """A pendulum whose duration is a variable."""
    duration = {"path": "/simulation/duration", "lower": 0.2, "upper": 2}
    return flexbody.Problem.from_dict({**PENDULUM, "variables": {"duration": duration}})


def test_instants_are_fixed_or_fractions_of_the_duration(stopped: flexbody.Problem) -> None:
    x = torch.tensor([0.7], dtype=torch.float64, requires_grad=True)
    motion = histories(stopped, ["time", "height"], fractions=[0, 0.5, 1])
    found = motion(x)
    assert found[0].detach().numpy() == pytest.approx([0, 0.35, 0.7])
    found[0].sum().backward()
    assert x.grad.numpy() == pytest.approx([1.5])
    fixed = histories(stopped, ["time", "height"], at=[0.1, 0.5])(x)
    (slope,) = torch.autograd.grad(fixed.sum(), x)
    assert slope.numpy() == pytest.approx([0], abs=1e-4)


def test_a_motion_that_ends_before_the_last_instant_has_failed(stopped: flexbody.Problem) -> None:
    early = torch.tensor([[0.4], [0.6]], dtype=torch.float64, requires_grad=True)
    with pytest.raises(ValueError, match="instant"):
        histories(stopped, ["height"], at=[0.1, 0.5])(early)
    found = histories(stopped, ["height"], at=[0.1, 0.5], failures="nan")(early)
    assert torch.isnan(found[0]).all() and torch.isfinite(found[1]).all()
    found.sum().backward()
    assert torch.isnan(early.grad).flatten().tolist() == [True, False]


def test_weights_that_are_no_numbers_give_no_gradient(pendulum: flexbody.Problem) -> None:
    x = start(pendulum)
    (histories(pendulum, ["y"], [0.1])(x).sum() * np.nan).backward()
    assert torch.isnan(x.grad).all()


def test_empty_batches(trebuchet: flexbody.Problem, pendulum: flexbody.Problem) -> None:
    for simulate, shape in (
        (function(trebuchet), (0, 2)),
        (histories(pendulum, ["y", "x"], [0.1, 0.2, 0.3]), (0, 2, 3)),
    ):
        count = 6 if simulate.__qualname__.startswith("function") else 2
        none = torch.zeros((0, count), dtype=torch.float64, requires_grad=True)
        found = simulate(none)
        assert found.shape == shape
        found.sum().backward()
        assert none.grad.shape == none.shape
        with torch.no_grad():
            assert simulate(torch.zeros((3, 0, count), dtype=torch.float64)).shape == (3, *shape)


def test_precision_of_networks(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet)
    single = torch.tensor(np.array(trebuchet.variables.start), dtype=torch.float32, requires_grad=True)
    with pytest.raises(TypeError, match=r"expected torch.float64, found torch.float32; write x.double\(\)"):
        simulate(single)
    simulate(single.double())[0].backward()
    assert single.grad.dtype == torch.float32


def test_wrong_arguments(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet)
    with pytest.raises(ValueError, match=r"x: expected shape \(…, 6\), found shape \(5,\)"):
        simulate(torch.zeros(5, dtype=torch.float64))
    with pytest.raises(TypeError, match="x: expected a tensor of torch.float64, found list"):
        simulate([1.0, 2.0])
    with pytest.raises(ValueError, match='functions: no "rnage"; there are range, clearance'):
        function(trebuchet, ["rnage"])


def test_second_derivatives_are_refused(trebuchet: flexbody.Problem) -> None:
    simulate = function(trebuchet)
    with pytest.raises(NotImplementedError, match="first derivatives only"):
        torch.autograd.functional.hessian(lambda x: simulate(x)[0], start(trebuchet))


def test_failed_simulations() -> None:
    linkage = flexbody.Problem.from_file(PROBLEMS / "extreme" / "locking_linkage.json")
    far = torch.tensor([9.0], dtype=torch.float64, requires_grad=True)
    with pytest.raises(flexbody.SimulationError):
        function(linkage)(far)
    values = function(linkage, failures="nan")(far)
    values.sum().backward()
    assert torch.isnan(values).all() and torch.isnan(far.grad).all()


def test_controller_learns() -> None:
    example = Path(__file__).parents[1] / "examples" / "controller.py"
    run = subprocess.run(
        [sys.executable, str(example), "--rounds", "4"], capture_output=True, text=True, timeout=120, check=False
    )
    assert run.returncode == 0, run.stderr
    losses = [float(line.split()[-1]) for line in run.stdout.splitlines() if "loss" in line]
    assert losses[-1] < 0.2 * losses[0]
