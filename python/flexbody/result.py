"""Results of optimisations."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _flexbody
from .errors import SimulationError
from .page import Page

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["FoundOptimum", "History", "Result"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class History:
    """The iterations of a run. Arrays have one row per iteration."""

    iterations: NDArray[np.int64]
    evaluations: NDArray[np.int64]
    """Simulations so far."""
    objective: Array
    """In the user's sense: a maximised function is not negated."""
    infeasibility: Array
    """Largest violation of a constraint, in its unit."""
    optimality: Array
    """Largest scaled residual of the optimality conditions."""
    x: Array
    """Designs, shape (n, n_x)."""
    constraints: Array
    """Values of the constraints, shape (n, n_c)."""
    variable_names: tuple[str, ...]
    """Names of the variables."""
    constraint_names: tuple[str, ...]
    """Names of the constraints."""

    def __len__(self) -> int:
        return len(self.iterations)

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` with a row per iteration."""
        from .tables import frame

        columns: dict[str, Any] = {
            "evaluations": self.evaluations,
            "objective": self.objective,
            "infeasibility": self.infeasibility,
            "optimality": self.optimality,
        }
        columns |= {f"variable: {name}": self.x[:, k] for k, name in enumerate(self.variable_names)}
        columns |= {f"constraint: {name}": self.constraints[:, k] for k, name in enumerate(self.constraint_names)}
        return frame(columns, ("iteration", self.iterations))


@dataclass(frozen=True)
class FoundOptimum:
    """One of the distinct optima of several starts."""

    start: int
    """Number of the start that found it, from 1."""
    found_by: int
    """How many starts ended there."""
    objective: float
    x: Array
    """The design, shape (n_x,)."""


class Result:
    """The end of an optimisation. `save` writes it as the command does; a notebook shows its summary."""

    problem: Problem
    """The problem."""
    x: Array
    """The design, shape (n_x,)."""
    objective: float
    """The objective in the user's sense."""
    status: str
    """How the run ended: a word such as `"converged"`."""
    message: str
    """How the run ended: a sentence."""

    def __init__(self, problem: Problem, core: _flexbody.Optimum) -> None:
        self.problem = problem
        self._core = core
        self.x = core.design()
        self.objective = core.objective
        self.status, self.message = core.status

    @property
    def converged(self) -> bool:
        """Whether the first-order conditions hold to the tolerances."""
        return self.status == "converged"

    @property
    def verdict(self) -> str:
        """One line."""
        return f"{self.status}: {self.message}"

    @cached_property
    def record(self) -> dict[str, Any]:
        """The whole record, as the command writes it to `optimum.json`; the documentation of records has its keys.

        Raises
        ------
        SimulationError
            A number of it is not finite.
        """
        text = self._core.record
        if text is None:
            raise SimulationError("a number of the record is not finite")
        record: dict[str, Any] = json.loads(text)
        return record

    @property
    def variables(self) -> dict[str, float]:
        """The design by name."""
        return dict(zip(self.problem.variables.names, self.x.tolist(), strict=True))

    @property
    def multipliers(self) -> dict[str, dict[str, float]]:
        """Lagrange multipliers by name: of `"constraints"`, `"lower_bounds"` and `"upper_bounds"`."""
        found: dict[str, dict[str, float]] = self.record["multipliers"]
        return found

    @property
    def constraints(self) -> dict[str, dict[str, Any]]:
        """By constraint: `value`, `lower`, `upper`, `unit`, `multiplier` as the change of the objective for a unit
        change of the active bound, `active`, `estimated_error`."""
        found: dict[str, dict[str, Any]] = self.record["constraints"]
        return found

    @property
    def errors(self) -> dict[str, float | None]:
        """Estimated errors by the discretisation, of the objective and of constraints, by function; `None` where not
        known."""
        objective = self.record["objective"]
        errors = {objective["function"]: objective.get("estimated_error")}
        of = {own.name: own.function for own in self.problem.constraints}
        for name, own in self.constraints.items():
            errors.setdefault(of.get(name, name), own.get("estimated_error"))
        return errors

    @property
    def certificate(self) -> dict[str, Any] | None:
        """The comparison of the gradients at the end with the complex step, unless it was skipped."""
        found: dict[str, Any] | None = self.record.get("gradient_certificate")
        return found

    @property
    def warnings(self) -> list[str]:
        """Warnings about the result."""
        found: list[str] = self.record.get("warnings", [])
        return found

    @cached_property
    def history(self) -> History:
        """The iterations."""
        counts, columns, designs, constraints = self._core.history()
        both = np.array(counts, dtype=np.int64).reshape(-1, 2)
        names = (self.problem.variables.names, tuple(own.name for own in self.problem.constraints))
        objective, infeasibility, optimality = (columns[:, k].copy() for k in range(3))
        return History(
            both[:, 0], both[:, 1], objective, infeasibility, optimality, designs, constraints, *names
        )

    @cached_property
    def optima(self) -> list[FoundOptimum]:
        """The distinct optima of several starts, best first; empty for one start."""
        return [FoundOptimum(*own) for own in self._core.optima()]

    def summary(self) -> str:
        """The summary that the command prints."""
        return self._core.summary

    def save(self, directory: str | os.PathLike[str], report: bool = True) -> list[str]:
        """Writes record, history, state of the optimiser and figures into a directory, and the page `report.html`. The
        command reads them: `optimize compare`, `plot`, `report`, `--from`.

        Returns
        -------
        list of str
            Figures that could not be drawn.

        Raises
        ------
        OSError
            A file cannot be written; those of an earlier run are then untouched.
        """
        return self._core.save(os.fspath(directory), "flexbody for Python" if report else None)

    def animate(self) -> Page:
        """The page of the result: start and optimum in motion, and the convergence."""
        return Page(self._core.page("flexbody for Python"))

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.summary())}</pre>"

    def __repr__(self) -> str:
        return f"<Result of {self.problem.name!r}: {self.verdict}; objective {self.objective:.9g}>"
