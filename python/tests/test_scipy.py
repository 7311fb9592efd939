"""Problems for other optimisers of Python: SciPy and Ipopt."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import flexbody
from scenes import FTOL, OPTIMUM, PROBLEMS
from flexbody.scipy import Scaled, scipy_problem


@pytest.fixture(scope="module")
def trebuchet() -> flexbody.Problem:
    return flexbody.Problem.from_file(PROBLEMS / "trebuchet.json")


def test_slsqp_finds_the_optimum_of_the_trebuchet(trebuchet: flexbody.Problem) -> None:
    optimize = pytest.importorskip("scipy.optimize")
    call = scipy_problem(trebuchet)
    found = optimize.minimize(**call, method="SLSQP", options={"ftol": FTOL, "maxiter": 200})
    assert found.success
    assert -found.fun == pytest.approx(OPTIMUM, abs=1e-3)
    best = trebuchet.evaluate(call["fun"].design(found.x))
    assert best.values[0] == pytest.approx(OPTIMUM, abs=1e-3)
    assert best.values[1] >= -1e-6


def test_ipopt_finds_the_same_optimum(trebuchet: flexbody.Problem) -> None:
    cyipopt = pytest.importorskip("cyipopt")
    found = cyipopt.minimize_ipopt(
        **scipy_problem(trebuchet),
        options={
            "hessian_approximation": "limited-memory",
            "bound_relax_factor": 0.0,
            "print_level": 0,
            "sb": "yes",
            "tol": 1e-6,
        },
    )
    assert -found.fun == pytest.approx(OPTIMUM, abs=1e-3)


def test_own_optimiser_finds_the_same_optimum(trebuchet: flexbody.Problem) -> None:
    found = flexbody.minimise(**scipy_problem(trebuchet))
    assert found.success
    assert -found.fun == pytest.approx(OPTIMUM, abs=1e-3)


def test_scales_and_signs(trebuchet: flexbody.Problem) -> None:
    call = scipy_problem(trebuchet)
    scaled = call["fun"]
    x = np.clip(call["x0"] * 1.01, *np.array(call["bounds"], dtype=float).T)
    exact = trebuchet.evaluate(scaled.design(x))
    assert scaled(x) == -exact.values[0]
    assert call["jac"](x) == pytest.approx(-exact.gradients[0] * scaled.scale)
    (barrier,) = call["constraints"]
    assert barrier["type"] == "ineq"
    assert barrier["fun"](x) == exact.values[1]
    assert barrier["jac"](x) == pytest.approx(exact.gradients[1] * scaled.scale)
    assert scaled.design(call["x0"]) == pytest.approx(trebuchet.variables.start, rel=1e-15)


def test_one_simulation_for_a_point(trebuchet: flexbody.Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    class Counted:
        calls = 0

        def __getattr__(self, name: str) -> Any:
            return getattr(trebuchet, name)

        def evaluate(self, *args: Any) -> Any:
            self.calls += 1
            return trebuchet.evaluate(*args)

    counted = Counted()
    call = scipy_problem(counted)  # type: ignore[arg-type]
    for function in (call["fun"], call["jac"], *(row[key] for row in call["constraints"] for key in ("fun", "jac"))):
        function(call["x0"])
    assert counted.calls == 1


def test_problem_without_objective_is_refused(trebuchet: flexbody.Problem) -> None:
    document = trebuchet.to_dict()
    del document["objective"]
    with pytest.raises(ValueError, match="no objective"):
        Scaled(flexbody.Problem.from_dict(document))
