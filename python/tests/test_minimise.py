"""The optimiser alone: `flexbody.minimise`."""

from __future__ import annotations

import types
from typing import Any

import numpy as np
import pytest

import flexbody
from flexbody import minimise


def rosenbrock(x: Any) -> Any:
    return 100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2


def rosenbrock_slope(x: Any) -> Any:
    return np.array([-400 * x[0] * (x[1] - x[0] ** 2) - 2 * (1 - x[0]), 200 * (x[1] - x[0] ** 2)])


DISC = {"type": "ineq", "fun": lambda x: 1 - x @ x, "jac": lambda x: -2 * x}
IN_DISC = [0.7864151510041724, 0.6176983125233904]


@pytest.mark.parametrize("jac", [rosenbrock_slope, "3-point", "cs"])
def test_rosenbrock_in_a_disc(jac: Any) -> None:
    found = minimise(rosenbrock, [0.0, 0.0], jac=jac, constraints=DISC)
    assert found.success and found.status == "converged"
    assert found.x == pytest.approx(IN_DISC, abs=1e-6)
    assert found.fun == pytest.approx(0.0456748087, abs=1e-8)
    assert found.multipliers["constraints"] != 0
    residual = found.jac + found.multipliers["constraints"] * DISC["jac"](found.x)
    assert np.abs(residual).max() < 1e-5


def test_default_is_forward_differences() -> None:
    found = minimise(rosenbrock, [0.5, 0.5], constraints=DISC, tol=1e-4)
    assert found.x == pytest.approx(IN_DISC, abs=1e-3)
    assert found.nfev > found.njev


def test_value_and_gradient_by_one_call() -> None:
    points = []

    def both(x: Any) -> Any:
        points.append(tuple(x))
        return rosenbrock(x), rosenbrock_slope(x)

    found = minimise(both, [0.0, 0.0], jac=True, constraints=DISC)
    assert found.success
    assert len(points) == len(set(points)) == found.nfev


def test_hs071_with_objects_of_scipy() -> None:
    optimize = pytest.importorskip("scipy.optimize")
    product = optimize.NonlinearConstraint(
        np.prod, 25, np.inf, jac=lambda x: np.prod(x) / x
    )
    sphere = optimize.NonlinearConstraint(lambda x: x @ x, 40, 40, jac=lambda x: 2 * x)
    found = minimise(
        lambda x: x[0] * x[3] * x[:3].sum() + x[2],
        [1, 5, 5, 1],
        jac=lambda x: np.array(
            [x[3] * (2 * x[0] + x[1] + x[2]), x[0] * x[3], x[0] * x[3] + 1, x[0] * x[:3].sum()]
        ),
        bounds=optimize.Bounds(1, 5),
        constraints=[product, sphere],
    )
    assert found.success
    assert found.fun == pytest.approx(17.0140173, abs=1e-6)
    assert found.x == pytest.approx([1, 4.742999, 3.821151, 1.379408], abs=1e-5)
    assert [values.shape for values in found.constraints] == [(1,), (1,)]
    assert found.rows == pytest.approx([25, 40])
    assert found.multipliers["lower"][0] > 0.1


def test_the_same_as_slsqp_with_all_forms_of_arguments() -> None:
    optimize = pytest.importorskip("scipy.optimize")
    call: dict[str, Any] = {
        "fun": lambda x, a: (x[0] - a) ** 2 + (x[1] + 1) ** 2 + x[2] ** 2,
        "x0": np.array([1.0, 1.0, 1.0]),
        "args": (2.0,),
        "bounds": [(None, 1.5), (-0.5, None), (None, None)],
        "constraints": [
            {"type": "eq", "fun": lambda x, s: x.sum() - s, "args": (2.0,)},
            optimize.LinearConstraint([[1, 0, -1], [0, 1, 1]], [-1, -np.inf], [np.inf, 3]),
        ],
    }
    ours, theirs = minimise(**call, tol=1e-5), optimize.minimize(**call, method="SLSQP")
    assert ours.x == pytest.approx(theirs.x, abs=1e-4)


def chain(n: int) -> dict[str, Any]:
    """A chain of n variables: neighbours differ by a tenth at most, the ends are held."""
    target = np.sin(np.arange(n))
    return {
        "fun": lambda x: ((x - target) ** 2).sum(),
        "x0": np.zeros(n),
        "jac": lambda x: 2 * (x - target),
        "bounds": [(0.0, 0.0), *[(-1.0, 1.0)] * (n - 1)],
    }


@pytest.mark.parametrize("form", ["csr_matrix", "coo_array", "dense"])
def test_sparse_jacobians(form: str) -> None:
    sparse = pytest.importorskip("scipy.sparse")
    optimize = pytest.importorskip("scipy.optimize")
    n = 40
    steps = sparse.diags([-np.ones(n), np.ones(n - 1)], [0, 1], shape=(n - 1, n))
    matrix = steps.toarray() if form == "dense" else getattr(sparse, form)(steps)
    limits = optimize.NonlinearConstraint(lambda x: np.diff(x), -0.1, 0.1, jac=lambda x: matrix)
    end = {"type": "eq", "fun": lambda x: x[-1] - 0.5, "jac": lambda x: np.eye(n)[-1]}
    found = minimise(**chain(n), constraints=[limits, end])
    assert found.success
    assert np.abs(np.diff(found.x)).max() <= 0.1 + 1e-6
    assert found.x[[0, -1]] == pytest.approx([0, 0.5], abs=1e-6)
    linear = optimize.LinearConstraint(matrix, -0.1, 0.1)
    assert minimise(**chain(n), constraints=[linear, end]).x == pytest.approx(found.x, abs=1e-5)


@pytest.mark.parametrize("method", ["interior_point", "trust_region", "auto"])
@pytest.mark.parametrize("scale", [1.0, 1e3, 1e4, 1e6])
def test_bounds_tell_the_sizes_of_variables(method: str, scale: float) -> None:
    sizes = np.array([1 / scale, scale])

    def value(x: Any) -> float:
        z = x / sizes
        return float(z[0] - 3 * z[1] + 0.1 * z @ z)

    def slope(x: Any) -> Any:
        return (np.array([1.0, -3.0]) + 0.2 * x / sizes) / sizes

    bounds = [(-size, 0.5 * size) for size in sizes]
    found = minimise(value, [0.0, 0.0], jac=slope, bounds=bounds, method=method)
    assert found.success, found.verdict
    assert found.x / sizes == pytest.approx([-1, 0.5], abs=1e-6)


def test_verdict_of_contradicting_constraints_names_one() -> None:
    found = minimise(
        lambda x: x[0],
        [0.0],
        jac=lambda x: np.ones(1),
        constraints=[
            {"type": "ineq", "fun": lambda x: x[0] - 1, "jac": lambda x: np.ones(1), "name": "at least one"},
            {"type": "ineq", "fun": lambda x: -1 - x[0], "jac": lambda x: -np.ones(1), "name": "at most minus one"},
        ],
    )
    assert not found.success
    assert found.status == "infeasible"
    assert "at least one" in found.message or "at most minus one" in found.message
    assert found.verdict.startswith("infeasible")
    assert found.maxcv == pytest.approx(1.0, abs=1e-3)


def test_functions_without_value_are_avoided() -> None:
    refused = []

    def logarithm(x: Any) -> float:
        if x[0] <= 0:
            refused.append(x[0])
            raise FloatingPointError("the logarithm of a negative number")
        return float(x[0] - 0.01 * np.log(x[0]))

    found = minimise(logarithm, [10.0], jac=lambda x: 1 - 0.01 / x)
    assert found.success
    assert found.x == pytest.approx([0.01], rel=1e-4)
    assert found.nfail == len(refused) > 0


def test_constraints_without_value_at_the_start_have_all_their_rows() -> None:
    """The first evaluation near the start that has values tells how many there are."""

    def rows(x: Any) -> Any:
        if x[0] <= 0:
            raise FloatingPointError("the logarithm of a negative number")
        return np.array([x[0] + x[1] - 1, np.log(x[0]) + 2, x[1]])

    limits = {"type": "ineq", "fun": rows, "name": "limits"}
    found = minimise(lambda x: x @ x, [0.0, 1.0], jac=lambda x: 2 * x, bounds=[(0, None)] * 2, constraints=limits)
    assert found.success
    assert found.x == pytest.approx([0.5, 0.5], abs=1e-5)
    assert found.constraints[0].shape == found.multipliers["constraints"].shape == (3,)


def test_infeasible_without_derivatives() -> None:
    problem: dict[str, Any] = {"fun": lambda x: ((x - 1) ** 2).sum(), "x0": [3.0, 4.0]}
    never = {"type": "eq", "fun": lambda x: x[0] ** 2 + 1, "name": "never"}
    assert minimise(**problem, constraints=never).status == "infeasible"
    blamed = minimise(**problem, constraints={**never, "jac": "2-point"})
    assert blamed.status in ("infeasible", "inconsistent")
    if blamed.status == "inconsistent":
        assert blamed.message.endswith("derivatives are differences, whose error may be the cause: give jac, never: jac")
        assert blamed.verdict == f"inconsistent: {blamed.message}"


def test_wrong_derivatives_are_not_blamed_on_differences() -> None:
    wrong = minimise(rosenbrock, [-1.2, 1.0], jac=lambda x: -rosenbrock_slope(x))
    assert wrong.status == "inconsistent"
    assert "differences" not in wrong.verdict


def test_arguments_that_are_no_tuple_are_one() -> None:
    found = minimise(lambda x, a: ((x - a) ** 2).sum(), [0.0, 0.0], args=[1.0, 2.0], jac=lambda x, a: 2 * (x - a))
    assert found.x == pytest.approx([1, 2], abs=1e-6)
    at_least = {"type": "ineq", "fun": lambda x, a, b: x[0] - a * b, "args": [1.5, 2.0]}
    found = minimise(lambda x, a: ((x - a) ** 2).sum(), [0.0, 0.0], args=1.0, constraints=at_least, tol=1e-4)
    assert found.x == pytest.approx([3, 1], abs=1e-3)


def test_start_without_value_is_a_verdict() -> None:
    def nowhere(x: Any) -> float:
        raise flexbody.SimulationError("the joint opens")

    found = minimise(nowhere, [1.0, 2.0], jac=lambda x: x)
    assert not found.success
    assert found.status == "undefined_start"


@pytest.mark.parametrize("where", ["fun", "jac", "constraint", "callback"])
def test_other_exceptions_reach_the_caller(where: str) -> None:
    class Own(Exception):
        pass

    def fail(*_: Any) -> Any:
        raise Own(where)

    functions: dict[str, Any] = {
        "fun": rosenbrock,
        "jac": rosenbrock_slope,
        "constraint": DISC["fun"],
        "callback": None,
    }
    functions[where] = fail
    with pytest.raises(Own, match=where):
        minimise(
            functions["fun"],
            [0.0, 0.0],
            jac=functions["jac"],
            constraints={"type": "ineq", "fun": functions["constraint"]},
            callback=functions["callback"],
        )


def test_callback_sees_iterates_and_stops() -> None:
    seen: list[Any] = []

    def old(x: Any) -> None:
        seen.append(x)

    whole = minimise(rosenbrock, [-1.2, 1.0], jac=rosenbrock_slope, callback=old)
    assert len(seen) >= whole.nit > 5
    assert all(x.shape == (2,) for x in seen)
    count: list[Any] = []

    def new(intermediate_result: Any) -> None:
        count.append(intermediate_result)
        if intermediate_result.nit >= 3:
            raise StopIteration

    stopped = minimise(rosenbrock, [-1.2, 1.0], jac=rosenbrock_slope, callback=new)
    assert not stopped.success
    assert stopped.status == "interrupted"
    assert len(count) < len(seen)
    assert count[0].fun > count[-1].fun
    for true in (True, 1, "enough"):
        at_once = minimise(rosenbrock, [-1.2, 1.0], jac=rosenbrock_slope, callback=lambda x, true=true: true)
        assert at_once.status == "interrupted" and at_once.nit <= 1


def test_differences_stay_within_bounds() -> None:
    lowest = []

    def root(x: Any) -> float:
        lowest.append(x.min())
        assert x.min() >= 0 and x.max() <= 1
        return float(np.sqrt(x[0]) + (x[1] - 2) ** 2)

    for scheme in ("2-point", "3-point"):
        found = minimise(root, [0.5, 1.0], jac=scheme, bounds=[(0.0, 1.0)] * 2, tol=1e-3)
        assert found.x[1] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize(("scheme", "error"), [("2-point", 1e-6), ("3-point", 1e-9), ("cs", 1e-14)])
def test_differences(scheme: str, error: float) -> None:
    from flexbody.differences import jacobian

    x = np.array([0.3, -2.0, 1.0])

    def function(x: Any) -> Any:
        return np.array([np.sin(x[0]) * x[1] ** 2, np.exp(x[2]) * x[0]])

    exact = np.array(
        [
            [np.cos(0.3) * 4, np.sin(0.3) * -4, 0],
            [np.exp(1.0), 0, np.exp(1.0) * 0.3],
        ]
    )
    free = np.full(3, np.inf)
    assert jacobian(function, x, None, scheme, -free, free) == pytest.approx(exact, rel=error, abs=error)
    # At an upper bound, and between bounds closer than a step.
    at_bound = jacobian(function, x, function(x), scheme, -free, x)
    assert at_bound == pytest.approx(exact, rel=10 * error, abs=10 * error)
    narrow = jacobian(function, x, function(x), scheme, x - 1e-9, x + 1e-10)
    assert narrow == pytest.approx(exact, abs=1e-4)


def test_start_out_of_bounds_and_single_number() -> None:
    found = minimise(lambda x: (x[0] - 3) ** 2, 10.0, jac=lambda x: 2 * (x - 3), bounds=[(None, 2.0)])
    assert found.x == pytest.approx([2.0], abs=1e-6)
    assert found.multipliers["upper"] == pytest.approx([2.0], rel=1e-3)


def test_result_has_attributes_and_prints() -> None:
    found = minimise(rosenbrock, [0.0, 0.0], jac=rosenbrock_slope)
    assert found["x"] is found.x
    assert "nfev" in dir(found) and "verdict" in repr(found)
    with pytest.raises(AttributeError, match="verdict"):
        found.optimum


def test_prints_only_if_asked(capsys: pytest.CaptureFixture[str]) -> None:
    minimise(rosenbrock, [0.0, 0.0], jac=rosenbrock_slope)
    assert capsys.readouterr().out == ""
    found = minimise(rosenbrock, [0.0, 0.0], jac=rosenbrock_slope, options={"disp": True})
    assert capsys.readouterr().out == found.verdict + "\n"


def test_names_of_options_in_scipy() -> None:
    found = minimise(rosenbrock, [-1.2, 1.0], jac=rosenbrock_slope, options={"maxiter": 3})
    assert found.status == "iteration_limit"
    assert found.nit <= 3


def test_hessians_are_not_used_with_a_warning() -> None:
    with pytest.warns(RuntimeWarning, match="hess is not used") as caught:
        minimise(rosenbrock, [0.0, 0.0], jac=rosenbrock_slope, hess=lambda x: np.eye(2))
    assert caught[0].filename == __file__


def test_constraints_are_not_kept_on_the_way_with_a_warning() -> None:
    limit = types.SimpleNamespace(fun=lambda x: x @ x, lb=-np.inf, ub=1.0, jac="3-point", keep_feasible=True)
    with pytest.warns(RuntimeWarning, match="constraints: keep_feasible is not used") as caught:
        found = minimise(rosenbrock, [0.0, 0.0], jac=rosenbrock_slope, constraints=limit)
    assert caught[0].filename == __file__
    assert found.x == pytest.approx(IN_DISC, abs=1e-6)


def test_alias() -> None:
    assert flexbody.minimize is flexbody.minimise


NONLINEAR = types.SimpleNamespace(fun=lambda x: x, lb=[0, 0, 0], ub=np.inf, jac="2-point")

MISUSES: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"fun": "x**2"}, TypeError, 'fun: expected a function of x, found "x**2"'),
    ({"x0": "here"}, TypeError, 'x0: expected numbers, found "here"'),
    ({"x0": []}, ValueError, "x0: expected a number at least, found an empty list"),
    ({"x0": [[1, 2]]}, ValueError, "x0: expected a list of numbers, found an array of shape (1, 2)"),
    ({"x0": [1, np.nan]}, ValueError, "x0: expected finite numbers, found nan at 1"),
    ({"x0": [1, 2j]}, TypeError, "x0: expected numbers, found a list"),
    ({"jac": "exact"}, ValueError, 'jac: expected a function, True, "2-point", "3-point" or "cs", found "exact"'),
    ({"jac": 3}, TypeError, "jac: expected a function, True or the name of differences, found an int"),
    ({"jac": True}, TypeError, "fun: expected a value and its derivatives, as jac=True says"),
    ({"jac": lambda x: [1, 2, 3]}, ValueError, "jac: expected derivatives of shape (2,), found shape (3,)"),
    ({"fun": lambda x: x}, ValueError, "fun: expected a number, found 2 of them"),
    ({"fun": lambda x: None}, TypeError, "fun: expected a number, found None"),
    ({"fun": lambda x: x[0] + 1j}, TypeError, "fun: expected a number, found a complex128"),
    ({"bounds": 3}, TypeError, "bounds: expected pairs (lower, upper), or an object with lb and ub, found an int"),
    ({"bounds": [(0, 1)]}, ValueError, "bounds: expected 2 pairs, one for each number of x0, found 1"),
    ({"bounds": [(0, 1), 1]}, TypeError, "bounds: expected a pair of numbers or None for x[1], found 1"),
    ({"bounds": [(0, 1), (1, 0)]}, ValueError, "bounds: the lower bound 1.0 of x[1] is above the upper bound 0.0"),
    ({"constraints": "x > 0"}, TypeError, 'constraints: expected dictionaries or NonlinearConstraint, found "x > 0"'),
    (
        {"constraints": [3]},
        TypeError,
        "constraints[0]: expected a dictionary, NonlinearConstraint or LinearConstraint, found an int",
    ),
    (
        {"constraints": {"type": "<", "fun": rosenbrock}},
        ValueError,
        "constraints: expected \"eq\" or \"ineq\" as type, found '<'",
    ),
    ({"constraints": [{"type": "eq"}]}, ValueError, 'constraints[0]: no "fun"'),
    (
        {"constraints": [{"type": "eq", "function": rosenbrock}]},
        ValueError,
        'constraints[0]: expected the keys type, fun, jac, args, name, found "function"',
    ),
    ({"constraints": [NONLINEAR]}, ValueError, "constraints[0]: fun: expected 3 numbers, found 2 of them"),
    ({"options": [1]}, TypeError, "options: expected a dictionary, found a list"),
    (
        {"method": "SLSQP"},
        ValueError,
        "method: expected one of \"interior_point\", \"trust_region\", \"auto\", found 'SLSQP'",
    ),
    ({"callback": 1}, TypeError, "callback: expected a function, found an int"),
]


@pytest.mark.parametrize(("wrong", "kind", "message"), MISUSES, ids=[case[2] for case in MISUSES])
def test_misuse_is_refused_in_one_line(wrong: dict[str, Any], kind: type[Exception], message: str) -> None:
    call: dict[str, Any] = {"fun": rosenbrock, "x0": [0.0, 0.0], **wrong}
    with pytest.raises(kind) as caught:
        minimise(**call)
    assert str(caught.value) == message


WRONG_OPTIONS: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"maxiter": -1}, ValueError, "options: expected maxiter of at least 0, found -1"),
    ({"maxiter": 1e3}, TypeError, "options: expected a whole number as maxiter, found 1000.0"),
    ({"max_evaluations": True}, TypeError, "options: expected a whole number as max_evaluations, found True"),
    ({"memory": 0}, ValueError, "options: expected memory of at least 1, found 0"),
    ({"scale_variables": 3}, TypeError, "options: expected True or False as scale_variables, found 3"),
    ({"tolerance": 0}, ValueError, "options: expected a positive number as tolerance, found 0"),
    ({"tolerance": "small"}, TypeError, "options: expected a number as tolerance, found 'small'"),
    ({"max_seconds": -1.0}, ValueError, "options: expected max_seconds of at least 0, found -1.0"),
    ({"unbounded_below": np.nan}, ValueError, "options: expected a number as unbounded_below, found nan"),
    (
        {"finite_diff_rel_step": 2.0},
        ValueError,
        "options: expected finite_diff_rel_step between 0 and 1, found 2.0",
    ),
    ({"maxiter": 1, "max_iterations": 2}, ValueError, "options: found max_iterations twice, by both of its names"),
    (
        {"patience": 3},
        ValueError,
        "options: expected some of method, tolerance, constraint_tolerance, max_iterations, maxiter, max_evaluations, "
        "maxfev, max_seconds, unbounded_below, scale_variables, memory, dense_limit, finite_diff_rel_step, disp, "
        "found 'patience'",
    ),
]


@pytest.mark.parametrize(("wrong", "kind", "message"), WRONG_OPTIONS, ids=[case[2] for case in WRONG_OPTIONS])
def test_wrong_options_are_refused_by_name(wrong: dict[str, Any], kind: type[Exception], message: str) -> None:
    with pytest.raises(kind) as caught:
        minimise(rosenbrock, [0.0, 0.0], jac=rosenbrock_slope, options=wrong)
    assert str(caught.value) == message


def test_all_options_are_taken() -> None:
    options = {
        "method": "auto",
        "tolerance": np.float32(1e-4),
        "constraint_tolerance": 1e-5,
        "maxiter": np.int64(200),
        "maxfev": 1000,
        "max_seconds": 60,
        "unbounded_below": -1e10,
        "scale_variables": np.True_,
        "memory": 5,
        "dense_limit": 0,
        "finite_diff_rel_step": 1e-7,
        "disp": None,
    }
    assert minimise(rosenbrock, [0.0, 0.0], jac="3-point", options=options).success
    with pytest.raises(ValueError, match="options: expected a positive number as tol, found -1"):
        minimise(rosenbrock, [0.0, 0.0], tol=-1)
