"""pyOptSparse: a problem as its `Optimization`.

```python
task, sens = optimization(problem)
found = pyoptsparse.OPT("IPOPT")(task, sens=sens)
```
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

try:
    import pyoptsparse  # type: ignore[import-not-found,import-untyped,unused-ignore]
except ImportError as error:
    raise ImportError(
        "flexbody.pyoptsparse needs pyOptSparse, which is built from its source: "
        "pip install git+https://github.com/mdolab/pyoptsparse (and cyipopt-wheels for IPOPT)"
    ) from error

from .errors import SimulationError
from .scipy import needed, scales

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["VARIABLES", "optimization"]

VARIABLES = "x"
"""The group of all variables (n_x,), in the order and the units of the file."""


def optimization(problem: Problem) -> tuple[Any, Callable[[Any, Any], tuple[dict[str, Any], bool]]]:
    """An `Optimization` and the function for the argument `sens` of an optimiser, with exact gradients.

    The variables are the group `x` (n_x,) in the units of the file, scaled by their `scale`. Objective and constraints
    have the names of the file; an objective that is maximised is negated. A failed simulation sets pyOptSparse's flag,
    and optimisers that know it take shorter steps.
    """
    if problem.objective is None:
        raise ValueError(f"{problem.name}: the problem has no objective")
    sign = -1.0 if problem.objective.sense == "maximise" else 1.0
    names = needed(problem)
    rows = {constraint.name: names.index(constraint.function) for constraint in problem.constraints}
    goal = _goal(problem.objective.function, rows)
    last: dict[bytes, Any] = {}

    def evaluated(x: Any) -> Any:
        key = np.ascontiguousarray(x, dtype=np.float64).tobytes()
        if key not in last:
            found = problem.evaluate(np.array(x, dtype=np.float64), names)
            last.clear()
            last[key] = found
        return last[key]

    def functions(design: Any) -> tuple[dict[str, Any], bool]:
        try:
            values = evaluated(design[VARIABLES]).values
        except SimulationError:
            return {goal: np.nan, **dict.fromkeys(rows, np.nan)}, True
        return {goal: sign * values[0], **{name: values[k] for name, k in rows.items()}}, False

    def sensitivities(design: Any, _: Any) -> tuple[dict[str, Any], bool]:
        try:
            slopes = evaluated(design[VARIABLES]).gradients
        except SimulationError:
            nothing = {VARIABLES: np.full((1, len(problem.variables)), np.nan)}
            return dict.fromkeys([goal, *rows], nothing), True
        found = {goal: {VARIABLES: sign * slopes[:1]}}
        found.update({name: {VARIABLES: slopes[k : k + 1]} for name, k in rows.items()})
        return found, False

    task = pyoptsparse.Optimization(problem.name, functions)
    variables = problem.variables
    task.addVarGroup(
        VARIABLES,
        len(variables),
        varType="c",
        value=np.array(variables.start, dtype=np.float64),
        lower=_absent(variables.lower),
        upper=_absent(variables.upper),
        scale=1.0 / scales(problem),
    )
    for constraint in problem.constraints:
        task.addConGroup(
            constraint.name, 1, lower=_absent([constraint.lower])[0], upper=_absent([constraint.upper])[0]
        )
    task.addObj(goal)
    return task, sensitivities


def _goal(function: str, rows: dict[str, int]) -> str:
    """The name of the objective, which no constraint has."""
    return function if function not in rows else f"{function} (objective)"


def _absent(bounds: Any) -> list[float | None]:
    """Bounds with None for infinite ones."""
    return [None if np.isinf(bound) else float(bound) for bound in bounds]
