"""Minimise functions written in Python, with the interface of `scipy.optimize.minimize`."""

from __future__ import annotations

import inspect
import warnings
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _flexbody
from .differences import SCHEMES, Matrix, Vector, jacobian
from .errors import SimulationError

__all__ = ["OptimizeResult", "minimise", "minimize"]

METHODS = ("interior_point", "trust_region", "auto")
"""Names of the methods. `docs/optimiser.md` says what they are."""

_REMEMBERED = 8
"""Points whose values are kept, since gradients may be asked for at a point before the last one."""

_RENAMED = {"maxiter": "max_iterations", "maxfev": "max_evaluations"}
"""Options of SciPy and their names here."""

_POSITIVE = ("tolerance", "constraint_tolerance", "finite_diff_rel_step")
_COUNTS = {"max_iterations": 0, "max_evaluations": 0, "memory": 1, "dense_limit": 0}
"""Options that are whole numbers, and the least of each."""
_KNOWN = (
    "method",
    "tolerance",
    "constraint_tolerance",
    "max_iterations",
    "maxiter",
    "max_evaluations",
    "maxfev",
    "max_seconds",
    "unbounded_below",
    "scale_variables",
    "memory",
    "dense_limit",
    "finite_diff_rel_step",
    "disp",
)

_CENTRAL, _FORWARD = "3-point", "2-point"


class OptimizeResult(dict[str, Any]):
    """A result: a dictionary whose entries are attributes too.

    For n variables and m rows of constraints:

    - `x` (n,), `fun`, `jac` (n,): the best point, the objective and its gradient there;
    - `success`, `status`, `message`, `verdict`: whether the run converged, how it ended as a word and as a sentence,
      and both in one line;
    - `constraints`: a list of the values of each given constraint; `rows` (m,): the same in one array;
    - `multipliers`: `"constraints"` (m,), `"lower"` (n,), `"upper"` (n,); at the solution
      `jac + J.T @ multipliers["constraints"] - multipliers["lower"] + multipliers["upper"]` vanishes;
    - `maxcv`: the largest violation of a constraint or bound; `stationarity` and `complementarity`: the other
      residuals of the conditions of a minimum, in the units of `fun` and `x`; `optimality`: the largest residual in
      scaled units;
    - `nit`, `nfev`, `njev`, `nfail`: iterations, calls of `fun` (also for differences), gradients, and evaluations that
      had no value; `seconds`; `method`: the one that found the end.
    """

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"the result has no {name!r}; it has {', '.join(self)}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value

    def __delattr__(self, name: str) -> None:
        try:
            del self[name]
        except KeyError:
            raise AttributeError(f"the result has no {name!r}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        width = max((len(name) for name in self), default=0)
        with np.printoptions(precision=6, threshold=8):
            return "\n".join(f"{name:>{width}}: {value!r}" for name, value in self.items())


def minimise(
    fun: Callable[..., Any],
    x0: ArrayLike,
    args: Any = (),
    method: str | None = None,
    jac: Callable[..., Any] | str | bool | None = None,
    hess: Any = None,
    hessp: Any = None,
    bounds: Any = None,
    constraints: Any = (),
    tol: float | None = None,
    callback: Callable[..., Any] | None = None,
    options: Mapping[str, Any] | None = None,
) -> OptimizeResult:
    """Minimises a function of n variables within bounds and constraints.

    Arguments are those of `scipy.optimize.minimize`. SciPy itself is not needed.

    - `fun(x, *args)`: the objective, a number, of an array (n,). With `jac=True` it returns the objective and its
      gradient (n,); it is then called once for a point. `args` that is no tuple is one argument.
    - `x0`: the start (n,). One outside of the bounds is moved inside.
    - `method`: `"interior_point"` (default), `"trust_region"` or `"auto"`.
    - `jac`: `jac(x, *args)`, the gradient (n,); or `True`; or differences: `"2-point"` (the default, `None`),
      `"3-point"`, or `"cs"`, a complex step, for functions that take complex numbers. Differences stay within bounds.
    - `hess`, `hessp`: not used, with a warning, since second derivatives are approximated.
    - `bounds`: n pairs (lower, upper) with `None` for none, or an object with `lb` and `ub` as `scipy.optimize.Bounds`.
      They hold at every evaluation.
    - `constraints`: one or a sequence of dictionaries `{"type": "eq" or "ineq", "fun": …, "jac": …, "args": …,
      "name": …}`, where "ineq" means a value of at least zero and "name" is for verdicts; of objects with `fun`, `lb`,
      `ub`, `jac` as `scipy.optimize.NonlinearConstraint`; or with `A`, `lb`, `ub` as `LinearConstraint`. Their
      Jacobians may be sparse matrices or arrays of SciPy, which stay sparse. Without "jac" their derivatives are
      central differences: with forward ones, constraints that contradict each other are not recognised.
    - `tol`: the tolerance, as the option of this name.
    - `callback`: after every iteration `callback(x)`, or `callback(intermediate_result=…)` with an `OptimizeResult` if
      that is the name of its only parameter. The run stops if it returns a true value or raises `StopIteration`.
    - `options`: `tolerance`, `constraint_tolerance`, `max_iterations` (or `maxiter`), `max_evaluations` (or `maxfev`),
      `max_seconds`, `unbounded_below`, `memory`, `dense_limit`; `scale_variables` (default True): variables with two
      bounds are divided by their distance, so that a variable of 1e-6 counts as much as one of 1e6, and bounds far
      beyond all values are better left out; `finite_diff_rel_step`, the relative step of differences; `disp`: print
      the verdict.

    Where a function has no value it raises an `ArithmeticError` (such as `FloatingPointError`) or a `SimulationError`,
    or it returns NaN: the optimiser then takes shorter steps. Any other exception ends the run and is raised here. A
    run that does not converge is no exception: look at `success` and `verdict` of the result.
    """
    start = _start(x0)
    lower, upper = _bounds(bounds, start.size)
    settings = checked_options(options, method, tol)
    relative_step = settings.pop("finite_diff_rel_step", None)
    shown = bool(settings.pop("disp", False))
    for name, given in (("hess", hess), ("hessp", hessp)):
        if given is not None:
            warnings.warn(f"{name} is not used: second derivatives are approximated", RuntimeWarning, stacklevel=2)
    frame = _Frame(lower, upper, relative_step)
    if not callable(fun):
        raise TypeError(f"fun: expected a function of x, found {_kind(fun)}")
    objective = _Function("fun", "jac", fun, jac, _arguments(args), frame, size=1)
    rows = []
    for label, item in _listed(constraints):
        if np.any(getattr(item, "keep_feasible", False)):
            what = f"{label}: keep_feasible is not used: constraints may be violated on the way, bounds never are"
            warnings.warn(what, RuntimeWarning, stacklevel=2)
        rows.append(_constraint(label, item, frame))
    inside = np.clip(start, lower, upper)

    def evaluate(x: Vector) -> tuple[float, Vector]:
        value = float(objective.value(x)[0])
        return value, np.concatenate([row.value(x) for row in rows]) if rows else np.empty(0)

    def gradients(x: Vector) -> tuple[Vector, Any]:
        slope = _dense(objective.jacobian(x)).reshape(-1)
        return slope, _stacked([row.function.jacobian(x) for row in rows], x.size)

    def run() -> dict[str, Any]:
        for row in rows:
            row.measure(inside)
        return _flexbody.minimise(
            start,
            lower,
            upper,
            np.concatenate([row.lower for row in rows]) if rows else np.empty(0),
            np.concatenate([row.upper for row in rows]) if rows else np.empty(0),
            [f"x[{i}]" for i in range(start.size)],
            [name for row in rows for name in row.names()],
            evaluate,
            gradients,
            _observer(callback, objective),
            settings,
        )

    while True:
        try:
            found = run()
            break
        except _OtherSize:
            # A constraint without values at the start had them near it: now its number of rows is known.
            continue
    result = from_core(found)
    result.nfev = objective.calls
    if result.status == "inconsistent":
        functions = (objective, *(row.function for row in rows))
        differences = [own.jac_label for own in functions if own.jac in (_FORWARD, _CENTRAL)]
        if differences:
            _blame(result, differences)
    ends = np.cumsum([row.lower.size for row in rows])
    result.constraints = np.split(result.rows, ends[:-1]) if rows else []
    if shown:
        print(result.verdict)
    return result


minimize = minimise


class _Frame:
    """What the functions of one call share: the bounds (n,) and the step of differences."""

    def __init__(self, lower: Vector, upper: Vector, relative_step: Any) -> None:
        self.lower, self.upper = lower, upper
        self.relative_step: float | None = None
        if relative_step is not None:
            self.relative_step = _checked_option("finite_diff_rel_step", "finite_diff_rel_step", relative_step)


class _Function:
    """A function of x with `size` values (None: as many as it first returns) and its derivatives."""

    def __init__(
        self,
        label: str,
        jac_label: str,
        fun: Callable[..., Any],
        jac: Any,
        args: tuple[Any, ...],
        frame: _Frame,
        size: int | None,
    ) -> None:
        if jac is None or jac is False:
            jac = _FORWARD if size == 1 else _CENTRAL
        if isinstance(jac, str) and jac not in SCHEMES:
            raise ValueError(f'{jac_label}: expected a function, True, "2-point", "3-point" or "cs", found "{jac}"')
        if not (isinstance(jac, str) or jac is True or callable(jac)):
            raise TypeError(f"{jac_label}: expected a function, True or the name of differences, found {_kind(jac)}")
        self.label, self.jac_label = label, jac_label
        self.fun, self.jac, self.args = fun, jac, args
        self.frame = frame
        self.size = size
        self.calls = 0
        self.known: OrderedDict[bytes, tuple[Vector, Any]] = OrderedDict()

    def value(self, x: Vector) -> Vector:
        """The values (m,) at x (n,)."""
        return self._at(x)[0]

    def jacobian(self, x: Vector) -> Any:
        """The derivatives (m, n) at x (n,): an array or a `_Rows`."""
        if self.jac is True:
            return self._derivatives(self._at(x)[1], x.size)
        if isinstance(self.jac, str):
            known = None if self.jac == "cs" else self.value(x)
            return jacobian(
                self._moved, x, known, self.jac, self.frame.lower, self.frame.upper, self.frame.relative_step
            )
        return self._derivatives(self.jac(x.copy(), *self.args), x.size)

    def _at(self, x: Vector) -> tuple[Vector, Any]:
        key = x.tobytes()
        if key not in self.known:
            self.known[key] = self._called(x)
            if len(self.known) > _REMEMBERED:
                self.known.popitem(last=False)
        return self.known[key]

    def _called(self, x: Vector) -> tuple[Vector, Any]:
        self.calls += 1
        returned = self.fun(x.copy(), *self.args)
        slope = None
        if self.jac is True:
            if not isinstance(returned, (tuple, list)) or len(returned) != 2:
                raise TypeError(f"{self.label}: expected a value and its derivatives, as {self.jac_label}=True says")
            returned, slope = returned
        return self._values(returned, complex_=False).astype(np.float64), slope

    def _moved(self, x: NDArray[Any]) -> NDArray[Any]:
        self.calls += 1
        return self._values(self.fun(x, *self.args), complex_=np.iscomplexobj(x))

    def _values(self, returned: Any, complex_: bool) -> NDArray[Any]:
        """What the function returned, as an array (m,)."""
        expected = "a number" if self.size == 1 else "numbers"
        values = np.asarray(_dense(returned))
        if values.dtype.kind not in "fiubc" or (values.dtype.kind == "c" and not complex_):
            raise TypeError(f"{self.label}: expected {expected}, found {_kind(returned)}")
        values = values.reshape(-1)
        if self.size is None:
            self.size = values.size
        if values.size != self.size:
            expected = "a number" if self.size == 1 else f"{self.size} numbers"
            raise ValueError(f"{self.label}: expected {expected}, found {values.size} of them")
        return values

    def _derivatives(self, returned: Any, n: int) -> Any:
        """What was given as derivatives, as a matrix (m, n)."""
        size = self.size if self.size is not None else 1
        rows: Any
        if hasattr(returned, "tocsr"):
            rows = _Rows.of(returned, n)
        else:
            try:
                rows = np.asarray(returned, dtype=np.float64)
            except (TypeError, ValueError):
                raise TypeError(f"{self.jac_label}: expected derivatives, found {_kind(returned)}") from None
        shape = rows.shape
        if shape == (n,) or (n == 1 and shape in ((), (size,))):
            rows = rows.reshape(-1, n)
        if rows.shape != (size, n):
            expected = f"({n},)" if size == 1 else f"({size}, {n})"
            raise ValueError(f"{self.jac_label}: expected derivatives of shape {expected}, found shape {shape}")
        return rows


class _Constraint:
    """Rows lower ≤ c(x) ≤ upper."""

    def __init__(self, name: str, function: _Function, lower: Any, upper: Any) -> None:
        self.name, self.function = name, function
        self.given = {"lb": _limit(name, "lb", lower), "ub": _limit(name, "ub", upper)}
        self.lower, self.upper = self.given["lb"], self.given["ub"]
        known = max(self.lower.size, self.upper.size)
        if function.size is None and known > 1:
            function.size = known

    def measure(self, x: Vector) -> None:
        """Finds the number of rows, by an evaluation at x if it is not known. Without a value there it is taken for one,
        until there is a value."""
        if self.function.size is None:
            try:
                self.function.value(x)
            except (ArithmeticError, SimulationError):
                pass
        size = 1 if self.function.size is None else self.function.size
        for key, limit in self.given.items():
            if limit.size not in (1, size):
                raise ValueError(f"{self.name}: expected {size} numbers as {key}, found {limit.size}")
        self.lower, self.upper = (np.array(np.broadcast_to(limit, size)) for limit in self.given.values())

    def value(self, x: Vector) -> Vector:
        """The values (m,) at x (n,)."""
        values = self.function.value(x)
        if values.size != self.lower.size:
            raise _OtherSize
        return values

    def names(self) -> list[str]:
        size = self.lower.size
        return [self.name] if size == 1 else [f"{self.name}[{j}]" for j in range(size)]


class _OtherSize(Exception):
    """A constraint has another number of rows than was assumed."""


class _Rows:
    """A sparse matrix by compressed rows."""

    def __init__(self, indptr: NDArray[np.int64], indices: NDArray[np.int64], data: Vector, n: int) -> None:
        self.indptr, self.indices, self.data, self.n = indptr, indices, data, n

    @property
    def shape(self) -> tuple[int, int]:
        return self.indptr.size - 1, self.n

    @classmethod
    def of(cls, matrix: Any, n: int) -> _Rows:
        """Of a sparse matrix or array of SciPy."""
        csr = (matrix if matrix.ndim == 2 else matrix.reshape((1, -1))).tocsr()
        if not csr.has_canonical_format:
            csr = csr.copy()
            csr.sum_duplicates()
        if csr.shape[1] != n:
            return cls(np.zeros(csr.shape[0] + 1, np.int64), np.empty(0, np.int64), np.empty(0), csr.shape[1])
        return cls(
            np.ascontiguousarray(csr.indptr, np.int64),
            np.ascontiguousarray(csr.indices, np.int64),
            np.ascontiguousarray(csr.data, np.float64),
            n,
        )

    @classmethod
    def filled(cls, matrix: Matrix) -> _Rows:
        """Of an array, with all its entries."""
        m, n = matrix.shape
        indices = np.tile(np.arange(n, dtype=np.int64), m)
        return cls(np.arange(m + 1, dtype=np.int64) * n, indices, np.ascontiguousarray(matrix).reshape(-1), n)


def _stacked(blocks: list[Any], n: int) -> Any:
    """Blocks one below the other: an array (m, n), or (indptr, indices, data) if one of them is sparse."""
    if not any(isinstance(block, _Rows) for block in blocks):
        return np.ascontiguousarray(np.vstack(blocks)) if blocks else np.empty((0, n))
    rows = [block if isinstance(block, _Rows) else _Rows.filled(block) for block in blocks]
    starts = np.cumsum([0, *(row.data.size for row in rows)])
    indptr = [rows[0].indptr[:1], *(row.indptr[1:] + first for row, first in zip(rows, starts, strict=False))]
    return (
        np.concatenate(indptr).astype(np.int64),
        np.concatenate([row.indices for row in rows]),
        np.concatenate([row.data for row in rows]),
    )


def _dense(matrix: Any) -> Any:
    """Sparse matrices as arrays."""
    if isinstance(matrix, _Rows):
        full = np.zeros(matrix.shape)
        row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        full[row, matrix.indices] = matrix.data
        return full
    return matrix.toarray() if hasattr(matrix, "toarray") else matrix


def _kind(thing: Any) -> str:
    """What an argument is, for a message."""
    if thing is None:
        return "None"
    if isinstance(thing, str):
        return f'"{thing}"'
    name = type(thing).__name__
    return f"{'an' if name[0] in 'aeiouAEIOU' else 'a'} {name}"


def _numbers(what: str, given: Any) -> Vector:
    """Numbers as a new array."""
    given = _dense(given)
    try:
        array = np.asarray(given)
        if array.dtype.kind == "c":
            raise TypeError
        return np.array(array, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{what}: expected numbers, found {_kind(given)}") from None


def _start(x0: Any) -> Vector:
    start = np.atleast_1d(_numbers("x0", x0))
    if start.ndim != 1:
        raise ValueError(f"x0: expected a list of numbers, found an array of shape {start.shape}")
    if start.size == 0:
        raise ValueError("x0: expected a number at least, found an empty list")
    wrong = np.flatnonzero(~np.isfinite(start))
    if wrong.size:
        raise ValueError(f"x0: expected finite numbers, found {start[wrong[0]]} at {wrong[0]}")
    return start


def _bounds(bounds: Any, n: int) -> tuple[Vector, Vector]:
    """The bounds as arrays (n,)."""
    if bounds is None:
        return np.full(n, -np.inf), np.full(n, np.inf)
    if hasattr(bounds, "lb") and hasattr(bounds, "ub"):
        sides = [np.atleast_1d(_numbers(f"bounds.{key}", getattr(bounds, key))) for key in ("lb", "ub")]
        for key, side in zip(("lb", "ub"), sides, strict=True):
            if side.shape not in ((1,), (n,)):
                raise ValueError(f"bounds.{key}: expected {n} numbers, found shape {side.shape}")
        lower, upper = (np.array(np.broadcast_to(side, n)) for side in sides)
    else:
        lower, upper = _pairs(bounds, n)
    for i in range(n):
        if np.isnan(lower[i]) or np.isnan(upper[i]):
            raise ValueError(f"bounds: expected numbers or None for x[{i}], found NaN")
        if lower[i] > upper[i]:
            raise ValueError(f"bounds: the lower bound {lower[i]} of x[{i}] is above the upper bound {upper[i]}")
    return lower, upper


def _pairs(bounds: Any, n: int) -> tuple[Vector, Vector]:
    if isinstance(bounds, (str, Mapping)) or not isinstance(bounds, Iterable):
        raise TypeError(f"bounds: expected pairs (lower, upper), or an object with lb and ub, found {_kind(bounds)}")
    pairs = list(bounds)
    if len(pairs) != n:
        raise ValueError(f"bounds: expected {n} pairs, one for each number of x0, found {len(pairs)}")
    lower, upper = np.empty(n), np.empty(n)
    for i, pair in enumerate(pairs):
        try:
            low, high = pair
            lower[i] = -np.inf if low is None else low
            upper[i] = np.inf if high is None else high
        except (TypeError, ValueError):
            raise TypeError(f"bounds: expected a pair of numbers or None for x[{i}], found {pair!r}") from None
    return lower, upper


def _limit(name: str, key: str, given: Any) -> Vector:
    limit = np.atleast_1d(_numbers(f"{name}: {key}", given)).reshape(-1)
    if np.isnan(limit).any():
        raise ValueError(f"{name}: expected numbers as {key}, found NaN")
    return limit


def _arguments(args: Any) -> tuple[Any, ...]:
    return args if isinstance(args, tuple) else (args,)


def _listed(constraints: Any) -> list[tuple[str, Any]]:
    """The constraints, each with what a message calls it."""
    if constraints is None:
        return []
    if isinstance(constraints, Mapping) or hasattr(constraints, "lb"):
        return [("constraints", constraints)]
    if isinstance(constraints, str) or not isinstance(constraints, Iterable):
        raise TypeError(f"constraints: expected dictionaries or NonlinearConstraint, found {_kind(constraints)}")
    return [(f"constraints[{k}]", item) for k, item in enumerate(constraints)]


def _constraint(label: str, item: Any, frame: _Frame) -> _Constraint:
    if isinstance(item, Mapping):
        return _of_dictionary(label, item, frame)
    if all(hasattr(item, key) for key in ("A", "lb", "ub")):
        return _linear(label, item, frame)
    if all(hasattr(item, key) for key in ("fun", "lb", "ub")):
        return _nonlinear(label, item, frame)
    raise TypeError(
        f"{label}: expected a dictionary, NonlinearConstraint or LinearConstraint, found {_kind(item)}"
    )


def _of_dictionary(label: str, item: Mapping[str, Any], frame: _Frame) -> _Constraint:
    known = ("type", "fun", "jac", "args", "name")
    for key in item:
        if key not in known:
            raise ValueError(f'{label}: expected the keys {", ".join(known)}, found "{key}"')
    for key in ("type", "fun"):
        if key not in item:
            raise ValueError(f'{label}: no "{key}"')
    if str(item["type"]).lower() not in ("eq", "ineq"):
        raise ValueError(f'{label}: expected "eq" or "ineq" as type, found {item["type"]!r}')
    if not callable(item["fun"]):
        raise TypeError(f"{label}: expected a function as fun, found {_kind(item['fun'])}")
    upper = 0.0 if str(item["type"]).lower() == "eq" else np.inf
    name = str(item.get("name", label))
    args = item.get("args", ())
    args = tuple(args) if isinstance(args, list) else _arguments(args)
    function = _Function(f"{name}: fun", f"{name}: jac", item["fun"], item.get("jac"), args, frame, size=None)
    return _Constraint(name, function, 0.0, upper)


def _nonlinear(label: str, item: Any, frame: _Frame) -> _Constraint:
    if not callable(item.fun):
        raise TypeError(f"{label}: expected a function as fun, found {_kind(item.fun)}")
    step = getattr(item, "finite_diff_rel_step", None)
    own = frame if step is None else _Frame(frame.lower, frame.upper, step)
    jac = getattr(item, "jac", None)
    function = _Function(f"{label}: fun", f"{label}: jac", item.fun, jac, (), own, size=None)
    return _Constraint(label, function, item.lb, item.ub)


def _linear(label: str, item: Any, frame: _Frame) -> _Constraint:
    matrix = item.A if hasattr(item.A, "tocsr") else np.atleast_2d(_numbers(f"{label}: A", item.A))
    n = frame.lower.size
    if matrix.ndim != 2 or matrix.shape[1] != n:
        raise ValueError(f"{label}: expected a matrix A of {n} columns, found shape {matrix.shape}")
    function = _Function(
        f"{label}: A", f"{label}: A", lambda x: matrix @ x, lambda x: matrix, (), frame, size=int(matrix.shape[0])
    )
    return _Constraint(label, function, item.lb, item.ub)


def checked_options(options: Mapping[str, Any] | None, method: Any = None, tol: Any = None) -> dict[str, Any]:
    """The options under their names here, without those that are `None`; variables are scaled by default."""
    if options is None:
        options = {}
    if not isinstance(options, Mapping):
        raise TypeError(f"options: expected a dictionary, found {_kind(options)}")
    settings: dict[str, Any] = {}
    for key, value in options.items():
        if key not in _KNOWN:
            raise ValueError(f"options: expected some of {', '.join(_KNOWN)}, found {key!r}")
        name = _RENAMED.get(key, key)
        if name in settings:
            raise ValueError(f"options: found {name} twice, by both of its names")
        if value is not None:
            settings[name] = _checked_option(key, name, value)
    if method is not None:
        settings["method"] = method
    if settings.get("method", METHODS[0]) not in METHODS:
        known = ", ".join(f'"{name}"' for name in METHODS)
        raise ValueError(f"method: expected one of {known}, found {settings['method']!r}")
    if tol is not None:
        settings.setdefault("tolerance", _checked_option("tol", "tolerance", tol))
    settings.setdefault("scale_variables", True)
    return settings


def _checked_option(key: str, name: str, value: Any) -> Any:
    """The value of an option as the core takes it; `key` is what the caller calls it."""
    is_flag = isinstance(value, (bool, np.bool_))
    number = None if is_flag or not isinstance(value, (int, float, np.integer, np.floating)) else float(value)
    if name in _COUNTS:
        if is_flag or not isinstance(value, (int, np.integer)):
            raise TypeError(f"options: expected a whole number as {key}, found {value!r}")
        if value < _COUNTS[name]:
            raise ValueError(f"options: expected {key} of at least {_COUNTS[name]}, found {value!r}")
        return int(value)
    if name in _POSITIVE or name in ("max_seconds", "unbounded_below"):
        if number is None:
            raise TypeError(f"options: expected a number as {key}, found {value!r}")
        if name in _POSITIVE and not 0.0 < number < np.inf:
            raise ValueError(f"options: expected a positive number as {key}, found {value!r}")
        if name == "finite_diff_rel_step" and number >= 1.0:
            raise ValueError(f"options: expected finite_diff_rel_step between 0 and 1, found {value!r}")
        if name == "max_seconds" and not number >= 0.0:
            raise ValueError(f"options: expected max_seconds of at least 0, found {value!r}")
        if np.isnan(number):
            raise ValueError(f"options: expected a number as {key}, found {value!r}")
        return number
    if name == "scale_variables" and not is_flag:
        raise TypeError(f"options: expected True or False as {key}, found {value!r}")
    return bool(value) if name in ("scale_variables", "disp") else value


def _blame(result: OptimizeResult, differences: list[str]) -> None:
    """Adds to the verdict that differences may be the cause of it."""
    advice = f"; derivatives are differences, whose error may be the cause: give {', '.join(differences)}"
    result.message += advice
    result.verdict += advice


def _observer(callback: Any, objective: _Function) -> Callable[[dict[str, Any]], bool] | None:
    """The callback in the form of the core: True stops."""
    if callback is None:
        return None
    if not callable(callback):
        raise TypeError(f"callback: expected a function, found {_kind(callback)}")
    try:
        whole = set(inspect.signature(callback).parameters) == {"intermediate_result"}
    except (TypeError, ValueError):
        whole = False

    def observe(state: dict[str, Any]) -> bool:
        x = np.array(state["x"], dtype=np.float64)
        try:
            if not whole:
                return bool(callback(x))
            intermediate = OptimizeResult(
                x=x,
                fun=state["objective"],
                nit=state["iteration"],
                nfev=objective.calls,
                maxcv=state["infeasibility"],
                optimality=state["optimality"],
                barrier=state["barrier"],
                step=state["step"],
                rows=np.array(state["constraints"]),
            )
            return bool(callback(intermediate_result=intermediate))
        except StopIteration:
            return True

    return observe


def from_core(found: Mapping[str, Any]) -> OptimizeResult:
    """What the core found, with all constraints in one list of rows."""
    status, message = str(found["status"]), str(found["message"])
    rows = np.asarray(found["constraints"], dtype=np.float64)
    return OptimizeResult(
        x=np.asarray(found["x"], dtype=np.float64),
        fun=float(found["fun"]),
        success=bool(found["success"]),
        status=status,
        message=message,
        verdict=f"{status.replace('_', ' ')}: {message}",
        jac=np.asarray(found["jac"], dtype=np.float64),
        constraints=[rows] if rows.size else [],
        rows=rows,
        multipliers={key: np.asarray(value) for key, value in found["multipliers"].items()},
        maxcv=float(found["violation"]),
        stationarity=float(found["stationarity"]),
        complementarity=float(found["complementarity"]),
        optimality=float(found["optimality"]),
        nit=int(found["nit"]),
        nfev=int(found["nfev"]),
        njev=int(found["njev"]),
        nfail=int(found["nfail"]),
        seconds=float(found["seconds"]),
        method=str(found["method"]),
    )
