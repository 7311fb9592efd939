"""SciPy: a problem as the arguments of `scipy.optimize.minimize`. SciPy itself is not needed here.

    call = scipy_problem(problem)
    found = scipy.optimize.minimize(**call, method="SLSQP")
    design = call["fun"].design(found.x)

The same arguments suit `cyipopt.minimize_ipopt`; its option `bound_relax_factor` of zero keeps designs within bounds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["Scaled", "scipy_problem"]

Array = NDArray[np.float64]


class Scaled:
    """A problem in the variables x / `scale`, minimised: a `"maximise"` is negated.

    One simulation serves the objective, all constraints and their derivatives at a point. Calling it gives the
    objective. Failed simulations raise `SimulationError`.
    """

    def __init__(self, problem: Problem) -> None:
        if problem.objective is None:
            raise ValueError(f"{problem.name}: the problem has no objective")
        self.problem = problem
        """The problem."""
        self.scale = scales(problem)
        """Sizes (n_x,) of the variables, in the units of the file."""
        self.names = needed(problem)
        """The function of the objective, then those of constraints."""
        self.sign = -1.0 if problem.objective.sense == "maximise" else 1.0
        """−1 if the file maximises, else 1."""
        self._last: tuple[bytes, Array, Array] | None = None

    def design(self, scaled: Any) -> Array:
        """A design (n_x,) in the units of the file."""
        variables = self.problem.variables
        x = np.asarray(scaled, dtype=np.float64) * self.scale
        # Rounding of the scale must not carry a design out of its bounds.
        return np.where(
            np.abs(x - variables.lower) <= 1e-14 * np.abs(x),
            variables.lower,
            np.where(np.abs(x - variables.upper) <= 1e-14 * np.abs(x), variables.upper, x),
        )

    def at(self, scaled: Any) -> tuple[Array, Array]:
        """Values (n_f,) of the objective and of the functions of all constraints, and gradients (n_f, n_x)."""
        x = self.design(scaled)
        if self._last is None or self._last[0] != x.tobytes():
            found = self.problem.evaluate(x, self.names)
            self._last = (
                x.tobytes(),
                np.array(found.values, dtype=np.float64),
                np.asarray(found.gradients, dtype=np.float64) * self.scale,
            )
        return self._last[1], self._last[2]

    def __call__(self, scaled: Any) -> float:
        """The objective, to be minimised."""
        return self.sign * float(self.at(scaled)[0][0])

    def jac(self, scaled: Any) -> Array:
        """Its gradient (n_x,)."""
        slope: Array = self.sign * self.at(scaled)[1][0]
        return slope

    def row(self, function: str, sign: float, bound: float) -> dict[str, Any]:
        """`fun` and `jac` of sign · (function − bound)."""
        k = self.names.index(function)
        return {
            "fun": lambda scaled: sign * (self.at(scaled)[0][k] - bound),
            "jac": lambda scaled: sign * self.at(scaled)[1][k],
        }


def scipy_problem(problem: Problem) -> dict[str, Any]:
    """`fun`, `jac`, `x0`, `bounds` and `constraints` (dictionaries, which all methods take) for
    `scipy.optimize.minimize` or `flexbody.minimise`.

    Variables are divided by their `scale`; `fun.design(x)` gives a design in the units of the file. A function that the
    file maximises is negated.
    """
    scaled = Scaled(problem)
    variables = problem.variables
    constraints: list[dict[str, Any]] = []
    for constraint in problem.constraints:
        if constraint.lower == constraint.upper:
            row = scaled.row(constraint.function, 1.0, constraint.lower)
            constraints.append({"type": "eq", **row})
            continue
        for bound, sign in ((constraint.lower, 1.0), (constraint.upper, -1.0)):
            if np.isfinite(bound):
                constraints.append({"type": "ineq", **scaled.row(constraint.function, sign, bound)})
    bounds = [
        (None if np.isinf(low) else float(low), None if np.isinf(high) else float(high))
        for low, high in zip(variables.lower / scaled.scale, variables.upper / scaled.scale, strict=True)
    ]
    return {
        "fun": scaled,
        "jac": scaled.jac,
        "x0": np.asarray(variables.start, dtype=np.float64) / scaled.scale,
        "bounds": bounds,
        "constraints": constraints,
    }


def scales(problem: Problem) -> Array:
    """Typical sizes (n_x,) of the variables: their `scale` where it is positive, else one."""
    scale = np.array(problem.variables.scale, dtype=np.float64)
    return np.where(np.isfinite(scale) & (scale > 0.0), scale, 1.0)


def needed(problem: Problem) -> list[str]:
    """The function of the objective and then those of the constraints, each once."""
    names = [constraint.function for constraint in problem.constraints]
    if problem.objective is not None:
        names.insert(0, problem.objective.function)
    return list(dict.fromkeys(names))
