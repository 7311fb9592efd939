"""What the layers of JAX and PyTorch have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import SimulationError

if TYPE_CHECKING:
    from .problem import Problem
    from .response import Response

Array = NDArray[np.float64]


class Functions:
    """Values (n_f,) of functions of a problem and their gradients (n_f, n_x) at designs (n_x,)."""

    def __init__(self, problem: Problem, names: Sequence[str] | None, failures: str) -> None:
        known = list(problem.functions.names)
        self.problem = problem
        self.names = known if names is None else checked(names, known, "functions")
        self.nan = survives(failures)
        self.inputs = len(problem.variables)

    def values(self, x: Any) -> Array:
        """Values (n_f,)."""
        try:
            return np.asarray(self.problem.values(design(x), self.names), dtype=np.float64)
        except SimulationError:
            if not self.nan:
                raise
            return np.full(len(self.names), np.nan)

    def both(self, x: Any) -> tuple[Array, Array]:
        """Values (n_f,) and gradients (n_f, n_x)."""
        try:
            found = self.problem.evaluate(design(x), self.names)
            return np.asarray(found.values, dtype=np.float64), np.asarray(found.gradients, dtype=np.float64)
        except SimulationError:
            if not self.nan:
                raise
            return np.full(len(self.names), np.nan), np.full((len(self.names), self.inputs), np.nan)


class Histories:
    """Histories (n_names, n_t) of the quantities of functions, and what a weight of them does to a design (n_x,).

    The start of the file is simulated to learn which there are. "time" stands for the instants, unless a function has
    that name.
    """

    def __init__(
        self,
        problem: Problem,
        names: Sequence[str],
        at: ArrayLike | None,
        fractions: ArrayLike | None,
        failures: str,
    ) -> None:
        self.problem = problem
        if at is not None and fractions is not None:
            raise ValueError("histories: found both at and fractions, expected one of them")
        self.when: dict[str, Array] = {}
        for argument, given in (("at", at), ("fractions", fractions)):
            if given is not None:
                self.when[argument] = np.array(given, dtype=np.float64)
                if self.when[argument].ndim != 1:
                    what = f"expected a list of numbers, found shape {self.when[argument].shape}"
                    raise ValueError(f"{argument}: {what}")
        self.nan = survives(failures)
        self.inputs = len(problem.variables)
        start = problem.simulate(None, **self.when)
        self.instants = int(start.times.size)
        known = list(start.histories)
        self.names = checked(names, known if "time" in problem.functions.names else [*known, "time"], "names")

    def run(self, x: Any) -> tuple[Array, Response | None]:
        """Histories (n_names, n_t), and the response that they are of; none if the simulation failed."""
        try:
            response = self.problem.simulate(design(x), **self.when)
        except (SimulationError, ValueError) as error:
            # With fixed instants, the motion of another design than the start may end before the last of them.
            failed = isinstance(error, SimulationError) or "at" in self.when
            if not (self.nan and failed):
                raise
            return np.full((len(self.names), self.instants), np.nan), None
        functions = self.problem.functions.names
        rows = [response.histories[name] if name in functions else response.times for name in self.names]
        found = np.asarray(rows, dtype=np.float64).reshape(len(self.names), -1)
        if found.shape[1] != self.instants:
            raise ValueError(
                f"histories: this design has {found.shape[1]} instants, that of the file {self.instants}; give the "
                "instants by at or fractions"
            )
        return found, response

    def pull_back(self, response: Response | None, weights: Any) -> Array:
        """Σ_k w_k dq(t_k)/dx (n_x,) for weights (n_names, n_t)."""
        weights = np.asarray(weights, dtype=np.float64)
        if response is None or not np.isfinite(weights).all():
            return np.full(self.inputs, np.nan)
        together: dict[str, Array] = {}
        for name, row in zip(self.names, weights, strict=True):
            if row.any():
                together[name] = together[name] + row if name in together else np.array(row)
        if not together:
            return np.zeros(self.inputs)
        return np.asarray(response.pull_back(together), dtype=np.float64)


def design(x: Any) -> Array:
    """A design as an own array (n_x,)."""
    return np.array(x, dtype=np.float64)


def checked(names: Sequence[str], known: list[str], argument: str) -> list[str]:
    """Names that the problem has."""
    if isinstance(names, str):
        raise TypeError(f'{argument}: expected a list of names, found "{names}"')
    for name in names:
        if name not in known:
            raise ValueError(f'{argument}: no "{name}"; there are {", ".join(known)}')
    return list(names)


def survives(failures: str) -> bool:
    """Whether failed simulations give NaN."""
    if failures not in ("raise", "nan"):
        raise ValueError(f'failures: expected "raise" or "nan", found {failures!r}')
    return failures == "nan"
