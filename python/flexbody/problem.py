"""Problems: values, exact gradients, motions, checks and optima."""

from __future__ import annotations

import difflib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _flexbody
from .errors import ProblemError
from .page import Page
from .response import Response
from .rest import Modes, Rest, State
from .result import Result

__all__ = ["Check", "Constraint", "Design", "Evaluation", "Functions", "Objective", "Problem", "Variables"]

Vector = NDArray[np.float64]
Design = ArrayLike | Mapping[str, float] | None
"""A design: one number per variable in the units of the file, numbers by name (others as at the start), or `None` for
the start."""

TOLERANCE = 1e-10
"""Largest relative difference of two derivatives that agree."""


@dataclass(frozen=True)
class Variables:
    """Design variables in the order of the file. All arrays have the shape (n_x,)."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    """Units of the numbers, such as `"kg"` or `"m"`."""
    lower: Vector
    """Lower bounds, −∞ if there is none."""
    upper: Vector
    """Upper bounds, +∞ if there is none."""
    start: Vector
    """The design in the file."""
    scale: Vector
    """Typical changes, by which the optimiser divides."""
    paths: tuple[tuple[str, ...], ...]
    """JSON Pointers to the numbers that share the value of each variable."""

    def __len__(self) -> int:
        return len(self.names)


@dataclass(frozen=True)
class Functions:
    """Functions of interest in the order of the file."""

    names: tuple[str, ...]
    units: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.names)


@dataclass(frozen=True)
class Objective:
    """The function that is optimised."""

    function: str
    sense: str
    """`"minimise"` or `"maximise"`."""


@dataclass(frozen=True)
class Constraint:
    """Bounds on a function, in its unit."""

    name: str
    function: str
    lower: float
    """−∞ if there is none."""
    upper: float
    """+∞ if there is none; equal to `lower` for an equality."""


@dataclass(frozen=True)
class Evaluation:
    """Values and gradients of functions at a design. `evaluation["range"]` is a value, `dict(evaluation)` has all by name."""

    names: tuple[str, ...]
    """Names of the functions, n_f."""
    values: Vector
    """Values, shape (n_f,)."""
    gradients: NDArray[np.float64]
    """Exact derivatives by the variables, shape (n_f, n_x)."""
    variables: tuple[str, ...]
    """Names of the variables, n_x."""

    def __getitem__(self, name: str) -> float:
        return float(self.values[_index(name, self.names, "function")])

    def gradient(self, name: str) -> dict[str, float]:
        """The derivatives of a function, by variable."""
        row = self.gradients[_index(name, self.names, "function")]
        return dict(zip(self.variables, row.tolist(), strict=True))

    def keys(self) -> tuple[str, ...]:
        """Names of the functions."""
        return self.names

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)


@dataclass(frozen=True)
class CheckedDerivative:
    """A derivative by the adjoint and by the complex step."""

    function: str
    variable: str
    adjoint: float
    complex_step: float
    difference: float
    """|adjoint − complex step| relative to the complex step; to the size of its terms if that is zero."""
    agrees: bool
    """Whether the difference is below the tolerance, or is the round-off of larger terms."""


@dataclass(frozen=True)
class Check:
    """Every derivative, computed twice."""

    rows: list[CheckedDerivative]
    tolerance: float
    unresolved: list[str]
    """Why derivatives mean nothing although they are exact for the time steps; empty if these resolve them."""

    @property
    def passed(self) -> bool:
        """Whether all derivatives agree and the time steps resolve them."""
        return not self.unresolved and all(row.agrees for row in self.rows)

    @property
    def worst(self) -> float:
        """The largest relative difference, without those of round-off."""
        differences = [row.difference for row in self.rows if row.agrees and row.difference <= self.tolerance]
        differences += [row.difference for row in self.rows if not row.agrees]
        return max(differences, default=0.0)

    @property
    def verdict(self) -> str:
        """One sentence."""
        failed = sum(not row.agrees for row in self.rows)
        text = f"{len(self.rows)} derivatives, largest relative difference {self.worst:.1e}, {failed} above "
        return "\n".join([text + f"{self.tolerance:.1e}", *self.unresolved])

    def __str__(self) -> str:
        widths = [max([len(name), *(len(getattr(row, name)) for row in self.rows)]) for name in ("function", "variable")]
        head = f"{'function':{widths[0]}}  {'variable':{widths[1]}}  {'adjoint':>23}  {'complex step':>23}  difference"
        lines = [head]
        for row in self.rows:
            numbers = f"{row.adjoint:>23.15e}  {row.complex_step:>23.15e}  {row.difference:>10.1e}"
            note = "" if row.agrees else "  exceeds the tolerance"
            lines.append(f"{row.function:{widths[0]}}  {row.variable:{widths[1]}}  {numbers}{note}")
        return "\n".join([*lines, self.verdict])

    def to_pandas(self) -> Any:
        """The rows as a `pandas.DataFrame`."""
        from .tables import frame

        names = ("function", "variable", "adjoint", "complex_step", "difference", "agrees")
        return frame({name: [getattr(row, name) for row in self.rows] for name in names})


class Problem:
    """A scene, or structures under load cases, with its design variables, functions, objective and constraints.

    Designs are arrays of shape (n_x,) in the units of the file, mappings by name, or `None` for the design in the file.

    Values are smooth in the design and gradients exact, since the time steps are kept from design to design. They are
    chosen at the first design and anew where their error has grown; `forget_steps` chooses them anew at the next one.

    A problem may be used from several threads. Its designs are then simulated one after the other; two problems are
    simulated beside each other.
    """

    variables: Variables
    """Design variables."""
    functions: Functions
    """Functions of interest."""
    _core: _flexbody.Problem

    def __init__(self, core: _flexbody.Problem, directory: Path | None = None) -> None:
        if not isinstance(core, _flexbody.Problem):
            raise TypeError("make a problem by Problem.from_file, Problem.from_dict or Machine.problem")
        self._core = core
        self._directory = directory
        rows = core.variables
        self.variables = Variables(
            names=tuple(row[0] for row in rows),
            units=tuple(row[1] for row in rows),
            lower=_fixed([row[2] for row in rows]),
            upper=_fixed([row[3] for row in rows]),
            start=_fixed([row[4] for row in rows]),
            scale=_fixed([row[5] for row in rows]),
            paths=tuple(tuple(row[6]) for row in rows),
        )
        functions = core.functions
        self.functions = Functions(tuple(name for name, _ in functions), tuple(unit for _, unit in functions))

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], set: Mapping[str, object] | None = None) -> Problem:
        """Reads a problem file.

        Parameters
        ----------
        path
            The file, JSON.
        set
            One-off changes by JSON Pointer, such as `{"/gravity/1": -1.62}`.

        Raises
        ------
        ProblemError
            All faults of the file, each with its line.
        """
        file = Path(path)
        return cls(_flexbody.Problem.load(os.fspath(file), _changes(set)), file.parent.absolute())

    @classmethod
    def from_dict(
        cls,
        document: Mapping[str, Any],
        directory: str | os.PathLike[str] | None = None,
        set: Mapping[str, object] | None = None,
    ) -> Problem:
        """Makes a problem of a document, such as `json.load` reads; arrays of NumPy stand for lists.

        Parameters
        ----------
        document
            The document of a problem file.
        directory
            Where files that the document names are, default the working directory.
        set
            One-off changes by JSON Pointer.

        Raises
        ------
        ProblemError
            All faults of the document, each with its path.
        """
        if not isinstance(document, Mapping):
            raise TypeError(f"found a document of type {type(document).__name__}, expected a mapping")
        try:
            text = json.dumps(document, default=_plain, allow_nan=False)
            text.encode()
        except ValueError as error:
            raise ProblemError(f"the document holds what JSON does not have: {error}") from None
        name = document.get("name")
        place = Path(directory or ".").absolute()
        name = name if isinstance(name, str) and name and "/" not in name and "\\" not in name else "problem"
        try:
            return cls(_flexbody.Problem.parse(text, os.fspath(place / f"{name}.json"), _changes(set)), place)
        except ProblemError as error:
            raise error.without_lines() from None

    def __reduce__(self) -> tuple[Any, ...]:
        return (_revived, (type(self), self._core.document, self._directory))

    def to_dict(self) -> dict[str, Any]:
        """The document of the problem, with its changes applied."""
        document: dict[str, Any] = json.loads(self._core.document)
        return document

    def to_file(self, path: str | os.PathLike[str]) -> None:
        """Writes the problem file, whole or not at all. One that names files beside it stays in its folder."""
        from .machine import text, write

        folder = Path(path).absolute().parent
        if self._core.names_files and folder.resolve() != (self._directory or folder).resolve():
            raise ValueError(f"the problem names files in {self._directory}: write it there, not to {folder}")
        write(path, text(self.to_dict()) + "\n")

    @property
    def name(self) -> str:
        """Name of the problem."""
        return self._core.name

    @property
    def cases(self) -> tuple[str, ...]:
        """Names of its cases; empty if it has none."""
        return tuple(self._core.cases)

    def case(self, name: str) -> Problem:
        """The problem of one case: the machine with its values, its functions without "in CASE", no objective.

        Motions, rests and modes are those of a case: `problem.case("full").simulate()`.

        Raises
        ------
        KeyError
            There is no case of this name.
        """
        _index(name, self.cases, "case")
        return type(self)(self._core.case(name), self._directory)

    @property
    def objective(self) -> Objective | None:
        """The function that is optimised, if the file states one."""
        found = self._core.objective
        if found is None:
            return None
        return Objective(self.functions.names[found[0]], "maximise" if found[1] else "minimise")

    @property
    def constraints(self) -> list[Constraint]:
        """Bounds on functions."""
        names = self.functions.names
        return [Constraint(name, names[f], lower, upper) for name, f, lower, upper in self._core.constraints]

    @property
    def is_at_rest(self) -> bool:
        """Whether it has structures under load cases, which do not move."""
        return self._core.is_at_rest

    @property
    def notes(self) -> list[str]:
        """Notes on the file for its author."""
        return self._core.notes

    def design(self, x: Design = None) -> Vector:
        """A design as an array of shape (n_x,)."""
        names = self.variables.names
        if x is None:
            return self.variables.start.copy()
        if isinstance(x, Mapping):
            all = self.variables.start.copy()
            for name, value in x.items():
                place = _index(name, names, "variable")
                number = np.asarray(value)
                if number.dtype.kind not in "iuf" or number.size != 1:
                    raise TypeError(f"found {value!r} for the variable {name!r}, expected a real number")
                all[place] = number.item()
            return all
        try:
            array = np.asarray(x)
        except ValueError:
            raise ValueError(f"found a ragged design, expected {(len(names),)}: one number per variable") from None
        if array.dtype.kind not in "iuf":
            raise TypeError(f"found a design of type {array.dtype}, expected real numbers")
        if array.shape != (len(names),):
            raise ValueError(f"found a design of shape {array.shape}, expected {(len(names),)}: one number per variable")
        return np.ascontiguousarray(array, dtype=np.float64)

    def _which(self, functions: Sequence[str] | None) -> list[int]:
        if isinstance(functions, str):
            raise TypeError(f"found the text {functions!r} for functions, expected a list of names")
        names = self.functions.names
        return list(range(len(names))) if functions is None else [_index(f, names, "function") for f in functions]

    def values(self, x: Design = None, functions: Sequence[str] | None = None) -> Vector:
        """Values of the functions in their units, shape (n_f,); of those named, or of all.

        Raises
        ------
        SimulationError
            The design cannot be simulated, or a value is not finite.
        """
        return self._core.evaluate(self.design(x), self._which(functions), (True, False))[0]

    def gradients(self, x: Design = None, functions: Sequence[str] | None = None) -> NDArray[np.float64]:
        """Exact derivatives of the functions by the variables, shape (n_f, n_x).

        One backward march of the discrete adjoint gives those of all functions.

        Raises
        ------
        SimulationError
            The design cannot be simulated, a function has a kink there, or the time steps do not resolve derivatives.
        """
        return self._core.evaluate(self.design(x), self._which(functions), (False, True))[1]

    def evaluate(self, x: Design = None, functions: Sequence[str] | None = None) -> Evaluation:
        """Values and exact gradients, as arrays and by name.

        Raises
        ------
        SimulationError
            As of `values` and `gradients`.
        """
        which = self._which(functions)
        values, gradients = self._core.evaluate(self.design(x), which, (True, True))
        names = tuple(self.functions.names[f] for f in which)
        return Evaluation(names, values, gradients, self.variables.names)

    def forget_steps(self) -> None:
        """Chooses the time steps anew at the next design."""
        self._core.forget_steps()

    def simulate(
        self, x: Design = None, at: ArrayLike | None = None, fractions: ArrayLike | None = None
    ) -> Response:
        """Simulates a design: states, energies, reactions and histories over time.

        Parameters
        ----------
        x
            The design.
        at
            Fixed instants in s between 0 and the end of the motion, shape (n_t,); default those of tables and figures.
            Between the samples of the integration, polynomials of degree five give the values; `Response.history_error`
            says how large their error is.
        fractions
            Instants as fractions of the duration, from 0 to 1, instead of `at`. They move with the end where it depends
            on the design, as the default instants do.

        Raises
        ------
        SimulationError
            The design cannot be simulated, or it has no motion.
        ValueError
            An instant is not inside the motion.
        """
        if at is not None and fractions is not None:
            raise ValueError("found instants and fractions, expected one of both")
        times, parts = (None if own is None else _instants(own) for own in (at, fractions))
        return Response(self, self._core.motion(self.design(x), times, parts))

    def rest(self, x: Design = None) -> Rest | dict[str, State]:
        """What is at rest: the solved load cases of structures, or the state of each body: of a machine with
        `"analysis": "rest"`, or of a motion with `"start": "equilibrium"`.

        Raises
        ------
        SimulationError
            There is no solution.
        ValueError
            The motion does not start in equilibrium.
        """
        design = self.design(x)
        if self.is_at_rest:
            return Rest(self, design, *self._core.rest(design))
        if not self._core.starts_in_equilibrium:
            raise ValueError('the motion does not start at rest: set "start" to "equilibrium", or "analysis" to "rest"')
        return {name: State(*map(np.array, numbers)) for name, *numbers in self._core.start_states(design)}

    def modes(self, x: Design = None, count: int = 10) -> Modes:
        """The lowest natural frequencies and shapes of structures; those of a motion are not computed.

        Raises
        ------
        SimulationError
            The modes are not found, or the problem is one of a motion.
        """
        if count < 1:
            raise ValueError(f"found {count} modes, expected at least 1")
        return Modes(*self._core.modes(self.design(x), count))

    def check(self, x: Design = None, tolerance: float = TOLERANCE) -> Check:
        """Compares every derivative by the adjoint with the complex step, one simulation per variable.

        Raises
        ------
        SimulationError
            A simulation fails.
        """
        rows, unresolved = self._core.check(self.design(x))
        found = []
        for f, v, adjoint, complex_step, _, round_off in rows:
            difference = abs(adjoint - complex_step)
            if complex_step != 0:
                difference /= abs(complex_step)
            agrees = bool(round_off or difference <= tolerance)
            names = (self.functions.names[f], self.variables.names[v])
            found.append(CheckedDerivative(*names, adjoint, complex_step, difference, agrees))
        return Check(found, tolerance, unresolved)

    def optimise(
        self,
        *,
        callback: Callable[[dict[str, Any]], Any] | None = None,
        starts: int | None = None,
        directory: str | os.PathLike[str] | None = None,
        resume: str | os.PathLike[str] | None = None,
        progress: bool = False,
        certificate: bool = True,
    ) -> Result:
        """Finds the best design from that of the file.

        Parameters
        ----------
        callback
            Called at every iteration with a dictionary: `iteration`, `evaluations`, `objective`, `infeasibility`,
            `optimality`, `x` (n_x,), `constraints`. The run ends where it returns true.
        starts
            Number of starts, spread between the bounds of the variables and optimised beside each other; the result is
            the best, and `Result.optima` has the others. The callback is of one start, so both together are refused.
        directory
            Where every evaluation is logged as it happens, so that an interrupted run can be resumed. Without it nothing
            is written; `Result.save` writes the results.
        resume
            The directory of an interrupted run, of this method or of the command. What it evaluated is not repeated.
        progress
            Shows a bar of iterations by tqdm.
        certificate
            Compares the gradients at the end with the complex step.

        Raises
        ------
        SimulationError
            The start has no values.
        ValueError
            There is nothing to optimise, or an argument makes no sense.
        """
        if starts is not None and (isinstance(starts, bool) or not isinstance(starts, (int, np.integer)) or starts < 1):
            raise ValueError(f"found {starts!r} starts, expected a whole number of at least 1")
        if callback is not None and not callable(callback):
            raise TypeError(f"found a callback of type {type(callback).__name__}, expected a function")
        if starts is not None and callback is not None:
            raise ValueError("found a callback and several starts, expected one of both")
        wanted = {
            "starts": None if starts is None else int(starts),
            "directory": _path(directory),
            "resume": _path(resume),
            "certificate": certificate,
        }
        if not progress or starts is not None:
            return Result(self, self._core.optimise(callback, wanted))
        from .progress import Bar

        with Bar(self.name, callback) as bar:
            return Result(self, self._core.optimise(bar, wanted))

    def animate(self, x: Design = None) -> Page:
        """The page of a design: what moves, and the curves of its functions. A notebook shows it; `save` writes it."""
        return Page(self._core.page(self.design(x), "flexbody for Python"))

    def __repr__(self) -> str:
        counts = f"{len(self.variables)} variables, {len(self.functions)} functions"
        return f"<Problem {self.name!r}: {counts}, {len(self.constraints)} constraints>"


def _fixed(numbers: list[float]) -> Vector:
    """An array that cannot be changed."""
    array = np.array(numbers, dtype=np.float64)
    array.flags.writeable = False
    return array


def _index(name: str, names: tuple[str, ...], what: str) -> int:
    """Where a name is in a list."""
    try:
        return names.index(name)
    except ValueError:
        near = difflib.get_close_matches(str(name), names, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else f"; there are {', '.join(names) or 'none'}"
        raise KeyError(f"found the {what} {name!r}, expected one of the problem{hint}") from None


def _path(path: str | os.PathLike[str] | None) -> str | None:
    """A path as text."""
    found = None if path is None else os.fspath(path)
    if found is not None and not isinstance(found, str):
        raise TypeError(f"found the path {found!r}, expected text or a pathlib.Path")
    return found


def _revived(kind: type[Problem], document: str, directory: Path | None) -> Problem:
    """A problem from its document, for pickle: its steps are chosen anew."""
    return kind.from_dict(json.loads(document), directory)


def _plain(value: Any) -> Any:
    """What JSON has for a value of NumPy."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"found a value of type {type(value).__name__} in the document, expected what JSON has")


def _changes(set: Mapping[str, object] | None) -> list[tuple[str, str]]:
    """Changes as pairs of a JSON Pointer and JSON."""
    if set is not None and not isinstance(set, Mapping):
        raise TypeError(f"found changes of type {type(set).__name__}, expected a mapping of paths to values")
    return [(path, json.dumps(value, default=_plain, allow_nan=False)) for path, value in (set or {}).items()]


def _instants(at: ArrayLike) -> Vector:
    array = np.asarray(at)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"found instants of type {array.dtype}, expected real numbers")
    if array.ndim != 1:
        raise ValueError(f"found instants of shape {array.shape}, expected one dimension")
    return np.ascontiguousarray(array, dtype=np.float64)
