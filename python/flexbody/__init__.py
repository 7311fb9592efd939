"""Design of flexible multibody systems by gradient: dynamics with exact adjoints, and an optimiser.

```python
import flexbody

problem = flexbody.Problem.from_file("problems/trebuchet.json")
problem.check().passed                    # every derivative against the complex step
result = problem.optimise()
result.objective, result.variables        # 849.8985 m
result.save("results/trebuchet")          # record, figures and page, as the command writes them
```

| Module | Content |
|---|---|
| `flexbody.Problem` | problem files: values, exact gradients, motions, optima |
| `flexbody.Machine`, `flexbody.parts` | scenes built by calls |
| `flexbody.minimise` | the optimiser alone, with the interface of `scipy.optimize.minimize` |
| `flexbody.openmdao` | a component and a driver |
| `flexbody.jax`, `flexbody.torch` | simulations as layers of a larger program |
| `flexbody.scipy`, `flexbody.pyoptsparse` | problems for other optimisers |

All numbers are in the units of the problem file, all arrays are of NumPy.
"""

from __future__ import annotations

from . import parts
from ._flexbody import set_threads as _set_threads
from ._flexbody import threads as _threads
from ._flexbody import version as __version__
from .errors import Fault, FlexbodyError, InternalError, ProblemError, SimulationError
from .machine import Machine
from .minimise import OptimizeResult, minimise, minimize
from .page import Page
from .problem import Check, Constraint, Evaluation, Functions, Objective, Problem, Variables
from .response import Response
from .rest import Modes, Rest
from .result import Result

__all__ = [
    "Check",
    "Constraint",
    "Evaluation",
    "Fault",
    "FlexbodyError",
    "Functions",
    "InternalError",
    "Machine",
    "Modes",
    "Objective",
    "OptimizeResult",
    "Page",
    "Problem",
    "ProblemError",
    "Response",
    "Rest",
    "Result",
    "SimulationError",
    "Variables",
    "__version__",
    "minimise",
    "minimize",
    "parts",
    "threads",
]


def threads(count: int | None = None) -> int:
    """The number of threads of simulations, gradients and optimisations; sets it if one is given (0: one for each
    processor). It holds from the next call on."""
    if count is not None:
        if count < 0:
            raise ValueError(f"found {count} threads, expected 0 or more")
        _set_threads(count)
    return _threads()
