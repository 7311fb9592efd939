"""OpenMDAO: simulations as an explicit component, and the optimiser as a driver.

`FlexbodyComp` gives values and exact total derivatives of the functions of a problem. Compare them with differences by

    prob.check_partials(form="central")

The component sets the steps, 1e-5 of each input, and central differences are its default. Forward differences do not
pass: their error is half the step times the second derivative, and functions of a motion are strongly curved. With a
step of 1e-6 they miss the derivative of the shipped trebuchet's clearance in the mass of its sling (6 g) by 5e-3 of
itself, central ones by 1e-6. Much shorter steps amplify rounding and the errors of the time steps instead. A complex
step does not enter the simulation.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

try:
    import openmdao.api as om  # type: ignore[import-not-found,import-untyped,unused-ignore]
    from openmdao.core.analysis_error import (  # type: ignore[import-not-found,import-untyped,unused-ignore]
        AnalysisError,
    )
    from openmdao.core.driver import (  # type: ignore[import-not-found,import-untyped,unused-ignore]
        Driver,
        RecordingDebugging,
    )
    from openmdao.utils.units import (  # type: ignore[import-not-found,import-untyped,unused-ignore]
        valid_units,
    )
except ImportError as error:
    raise ImportError("flexbody.openmdao needs OpenMDAO 3.45 or newer: pip install openmdao") from error

from . import _flexbody
from ._names import Group, groups
from .errors import SimulationError
from .minimise import OptimizeResult, checked_options, from_core

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["FlexbodyComp", "FlexbodyDriver", "unit"]

_CHECKED_STEP = 1e-5
"""Step of the differences that verify derivatives, relative to the input."""

_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def unit(written: str) -> str | None:
    """A unit of a problem file as OpenMDAO writes it: `"kg m²"` is `"kg*m**2"`. `None` for numbers without unit, and
    for a unit that OpenMDAO does not know."""
    parts: list[str] = []
    for letter in written.strip().replace("·", " "):
        plain = letter.translate(_SUPERSCRIPTS)
        if plain != letter and not (parts and parts[-1].startswith("**")):
            parts.append(f"**{plain}")
        elif plain != letter:
            parts[-1] += plain
        else:
            parts.append(letter)
    translated = "*".join("".join(parts).replace("^", "**").split()).replace("*/*", "/").replace("/*", "/")
    translated = translated.replace("*/", "/")
    if translated in ("", "1") or not valid_units(translated):
        return None
    return translated


class FlexbodyComp(om.ExplicitComponent):  # type: ignore[misc,unused-ignore]
    """Functions of a problem as outputs, its variables as inputs, in the units of the file.

    `FlexbodyComp(problem)` takes a `flexbody.Problem` or the path of a problem file. Options:

    - `functions`: names of the functions that are outputs; default all.
    - `shapes`: `"arrays"` (default): variables `name[0]`, `name[1]`, … are one input `name` of shape (n,), all others
      have shape (1,), and so have functions; `"scalars"`: each has its own input or output; `"vector"`: one input `x`
      of all variables, shape (n_x,), without unit; outputs as for "arrays".

    Names are made identifiers: "arm mass" is `arm_mass`, and a function that has the name of a variable gets `_2`.
    `input_names` and `output_names` tell the identifiers by the names of the file.

    A design that cannot be simulated raises `AnalysisError`, which drivers of pyOptSparse, designs of experiments and
    `FlexbodyDriver` survive; `ScipyOptimizeDriver` ends with it. The outputs are NaN then, by which failures are found
    among recorded cases (`DOEDriver` of OpenMDAO 3.45 records them as successful).
    """

    def __init__(self, problem: Problem | str | os.PathLike[str] | None = None, **options: Any) -> None:
        if problem is not None:
            options["problem"] = problem
        super().__init__(**options)

    def initialize(self) -> None:
        """Declares the options."""
        self.options.declare(
            "problem", default=None, recordable=False, desc="a flexbody.Problem or the path of a problem file"
        )
        self.options.declare("functions", default=None, desc="names of the functions that are outputs; None: all")
        self.options.declare(
            "shapes", default="arrays", values=("arrays", "scalars", "vector"), desc="shapes of inputs and outputs"
        )

    @property
    def problem(self) -> Problem:
        """The problem."""
        given = self.options["problem"]
        if isinstance(given, (str, os.PathLike)):
            from .problem import Problem

            given = self.options["problem"] = Problem.from_file(given)
        found: Problem = given
        return found

    @property
    def function_names(self) -> list[str]:
        """The functions that are outputs, by their names in the file."""
        names = self.options["functions"]
        known = list(self.problem.functions.names)
        if names is None:
            return known
        if isinstance(names, str):
            raise TypeError(f'functions: expected a list of names, found "{names}"')
        for name in names:
            if name not in known:
                raise ValueError(f'functions: the problem has no "{name}"; it has {", ".join(known)}')
        return list(names)

    @property
    def input_names(self) -> dict[str, str]:
        """The input of each variable: `x[3]` is an entry of an array."""
        return _entries(list(self.problem.variables.names), self._input_groups())

    @property
    def output_names(self) -> dict[str, str]:
        """The output of each function."""
        return _entries(self.function_names, self._output_groups())

    def pose(self, model: Any, path: str = "") -> None:
        """Adds the variables of the file with their bounds, its objective and its constraints to `model`.

        `path` is where this component is in `model`: `"arm."` for a subsystem, `""` if its variables are promoted.
        """
        variables = self.problem.variables
        for group in self._input_groups():
            at = group.positions
            scale = np.asarray(variables.scale, dtype=np.float64)[at]
            size = scale if np.all(np.isfinite(scale)) and np.all(scale > 0) and np.any(scale != 1) else None
            model.add_design_var(
                path + group.identifier, lower=variables.lower[at], upper=variables.upper[at], ref=size
            )
        place = {
            name: (path + group.identifier, entry)
            for group in self._output_groups()
            for entry, name in enumerate(self.function_names[position] for position in group.positions)
        }
        objective = self.problem.objective
        used: set[str] = set()
        if objective is not None:
            output, entry = _placed(place, objective.function)
            model.add_objective(output, index=entry, scaler=-1.0 if objective.sense == "maximise" else None)
            used.add(output)
        rows: dict[tuple[str, bool, int], list[tuple[int, float, float]]] = {}
        for constraint in self.problem.constraints:
            output, entry = _placed(place, constraint.function)
            equal, copy = constraint.lower == constraint.upper, 0
            while any(entry == row[0] for row in rows.get((output, equal, copy), [])):
                copy += 1
            rows.setdefault((output, equal, copy), []).append((entry, constraint.lower, constraint.upper))
        for (output, equal, _), entries in rows.items():
            columns, lower, upper = (np.array(column) for column in zip(*entries, strict=True))
            alias = None
            if output in used:
                count = 2
                while (alias := f"{output.replace('.', '_')}_limit_{count}") in used:
                    count += 1
            used.add(output if alias is None else alias)
            limits = {"equals": lower} if equal else {"lower": lower, "upper": upper}
            model.add_constraint(output, indices=columns.astype(int), flat_indices=True, alias=alias, **limits)

    def setup(self) -> None:
        """Declares inputs and outputs with units."""
        if self.options["problem"] is None:
            raise ValueError("FlexbodyComp: no problem; give a flexbody.Problem or the path of a problem file")
        variables, functions = self.problem.variables, self.problem.functions
        units = dict(zip(functions.names, functions.units, strict=True))
        names = self.function_names
        if len(variables) == 0:
            raise ValueError(f"FlexbodyComp: the problem {self.problem.name} has no variables, which are its inputs")
        if not names:
            raise ValueError(f"FlexbodyComp: no functions of {self.problem.name}, which are its outputs")
        for group in self._input_groups():
            first = group.positions[0]
            mixed = self.options["shapes"] == "vector"
            self.add_input(
                group.identifier,
                val=np.array(variables.start, dtype=np.float64)[group.positions],
                units=None if mixed else unit(variables.units[first]),
                desc=group.name,
            )
        for group in self._output_groups():
            name = names[group.positions[0]]
            self.add_output(
                group.identifier, shape=(len(group.positions),), units=unit(units[name]), desc=group.name
            )

    def setup_partials(self) -> None:
        """Declares exact derivatives of all outputs in all inputs, and central differences to verify them."""
        self.declare_partials("*", "*")
        variables = self.problem.variables
        for group in self._input_groups():
            at = group.positions
            sizes = np.abs(np.asarray(variables.start, dtype=np.float64)[at])
            with np.errstate(invalid="ignore"):
                widths = (np.asarray(variables.upper) - np.asarray(variables.lower))[at]
            sizes = np.where(sizes > 0, sizes, np.where(np.isfinite(widths) & (widths > 0), widths, 1.0))
            self.set_check_partial_options(
                wrt=group.identifier,
                method="fd",
                form="central",
                step=_CHECKED_STEP,
                step_calc="rel_element",
                minimum_step=_CHECKED_STEP * float(sizes.min()),
            )

    def compute(self, inputs: Any, outputs: Any, discrete_inputs: Any = None, discrete_outputs: Any = None) -> None:
        """Simulates. Outputs of a failed simulation are NaN."""
        for group in self._output_groups():
            outputs[group.identifier] = np.nan
        values = self._simulated(self.problem.values, inputs)
        for group in self._output_groups():
            outputs[group.identifier] = values[group.positions]

    def compute_partials(self, inputs: Any, partials: Any, discrete_inputs: Any = None) -> None:
        """Simulates and differentiates by the adjoint."""
        slopes = self._simulated(self.problem.gradients, inputs)
        for output in self._output_groups():
            for given in self._input_groups():
                partials[output.identifier, given.identifier] = slopes[np.ix_(output.positions, given.positions)]

    def _input_groups(self) -> list[Group]:
        names = list(self.problem.variables.names)
        if self.options["shapes"] == "vector":
            return [Group("x", "all variables", list(range(len(names))))]
        return groups(names, together=self.options["shapes"] == "arrays")

    def _output_groups(self) -> list[Group]:
        taken = [group.identifier for group in self._input_groups()]
        return groups(self.function_names, taken, together=self.options["shapes"] != "scalars")

    def _simulated(self, what: Any, inputs: Any) -> NDArray[np.float64]:
        x = np.empty(len(self.problem.variables))
        for group in self._input_groups():
            given = inputs[group.identifier]
            if np.iscomplexobj(given):
                raise TypeError(
                    "FlexbodyComp: a complex step does not enter the simulation; its derivatives are exact: check "
                    'them by method="fd", form="central"'
                )
            x[group.positions] = given
        try:
            found = np.asarray(what(x, self.function_names), dtype=np.float64)
        except SimulationError as error:
            raise AnalysisError(f"{self.problem.name}: {error}") from error
        if not np.all(np.isfinite(found)):
            raise AnalysisError(f"{self.problem.name}: a value or derivative is not finite")
        return found


def _placed(place: dict[str, tuple[str, int]], function: str) -> tuple[str, int]:
    if function not in place:
        raise ValueError(f'functions: the objective or a constraint needs "{function}", which is no output')
    return place[function]


def _entries(names: list[str], found: list[Group]) -> dict[str, str]:
    entries = {}
    for group in found:
        for entry, position in enumerate(group.positions):
            several = len(group.positions) > 1
            entries[names[position]] = f"{group.identifier}[{entry}]" if several else group.identifier
    return entries


class FlexbodyDriver(Driver):  # type: ignore[misc,unused-ignore]
    """The optimiser of flexbody for any model of OpenMDAO.

    It takes equality, inequality and two-sided constraints and one objective, and needs total derivatives. A model that
    raises `AnalysisError` has no value there: the optimiser takes shorter steps. The case recorder keeps every run of
    the model, with `success` 0 and a message where it failed.

    After a run `fail` tells whether it did not converge, `result.exit_status` the verdict in words, and `outcome` is
    an `OptimizeResult` in scaled units of the driver. Scalers may be negative, other than for drivers of OpenMDAO 3.45
    itself, which do not exchange the bounds then. Options that are `None` have the defaults of `docs/optimiser.md`.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        for kind in (
            "optimization",
            "gradients",
            "inequality_constraints",
            "equality_constraints",
            "two_sided_constraints",
            "simultaneous_derivatives",
        ):
            self.supports[kind] = True
        for kind in (
            "linear_constraints",
            "multiple_objectives",
            "active_set",
            "integer_design_vars",
            "distributed_design_vars",
        ):
            self.supports[kind] = False
        self.supports._read_only = True
        self.cite = ""
        """Nothing to cite."""
        self.fail = False
        """Whether the run did not converge."""
        self.outcome: OptimizeResult | None = None
        """The result in scaled units of the driver, after a run."""
        self._total_jac_format = "array"
        self._model_ran = False
        self._last: bytes | None = None
        self._metadata: dict[str, Any] = {}

    def _declare_options(self) -> None:
        declare = self.options.declare
        declare("method", None, values=(None, "interior_point", "trust_region", "auto"), desc="the method")
        declare("tolerance", None, desc="relative tolerance of the conditions of a minimum")
        declare("constraint_tolerance", None, desc="largest violation of a constraint, in scaled units")
        declare("max_iterations", None, desc="largest number of iterations")
        declare("max_evaluations", None, desc="largest number of runs of the model")
        declare("max_seconds", None, desc="longest time of a run [s]")
        declare("unbounded_below", None, desc="how far the objective falls before the problem counts as unbounded")
        declare("scale_variables", None, desc="whether variables with two bounds are divided by their distance")
        declare("disp", False, types=bool, desc="whether to print the verdict")

    def _get_name(self) -> str:
        return "FlexbodyDriver"

    def _setup_driver(self, problem: Any) -> None:
        super()._setup_driver(problem)
        if len(self._objs) > 1:
            raise RuntimeError(f"{self.msginfo} takes one objective, and {len(self._objs)} were added")

    def run(self) -> bool:
        """Optimises. Returns whether the run did not converge."""
        self.result.reset()
        self.outcome = None
        self.iter_count = 0
        self._total_jac = self._total_jac_linear = None
        self._model_ran = False
        self._last = None
        self._check_for_missing_objective()
        self._check_for_invalid_desvar_values()
        if not self._designvars:
            raise RuntimeError(f"{self.msginfo}: the model has no design variables")
        start = self.get_design_var_values()
        if self._coloring_info is not None and self._coloring_info.dynamic:
            self._problem().get_total_coloring(self._coloring_info, run_model=True)
        found = from_core(
            _flexbody.minimise(
                _joined(start),
                *self._limits("design_var", start),
                *self._limits("constraint", self.get_constraint_values()),
                _row_names(start),
                _row_names(self.get_constraint_values()),
                self._evaluated,
                self._differentiated,
                None,
                self._settings(),
            )
        )
        self.outcome = found
        self._run_at(np.asarray(found.x), quiet=True)
        self.fail = not found.success
        if self.options["disp"]:
            print(found.verdict)
        return self.fail

    def get_exit_status(self) -> str:
        """The verdict in words."""
        return "NOT_RUN" if self.outcome is None else str(self.outcome.verdict)

    def _get_recorder_metadata(self, case_name: str) -> dict[str, Any]:
        return {**self._metadata, "name": case_name}

    def _settings(self) -> dict[str, Any]:
        names = (
            "method",
            "tolerance",
            "constraint_tolerance",
            "max_iterations",
            "max_evaluations",
            "max_seconds",
            "unbounded_below",
            "scale_variables",
        )
        return checked_options({name: self.options[name] for name in names})

    def _limits(self, kind: str, values: dict[str, Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Bounds of variables or constraints in the units of the driver."""
        scaled = self._autoscaler.get_bounds_scaling(kind)
        lower: list[NDArray[np.float64]] = []
        upper: list[NDArray[np.float64]] = []
        for name, value in values.items():
            equals = scaled[name].equals if kind == "constraint" else None
            below, above = (
                _bound(bound if equals is None else equals, np.size(value))
                for bound in (scaled[name].lower, scaled[name].upper)
            )
            scaler = self._autoscaler._var_meta[kind][name]["total_scaler"]
            turned = np.less(1.0 if scaler is None else scaler, 0.0)
            low, high = np.where(turned, above, below), np.where(turned, below, above)
            lower.append(np.where(np.isnan(low), -np.inf, low))
            upper.append(np.where(np.isnan(high), np.inf, high))
        return _flat(lower), _flat(upper)

    def _run_at(self, x: NDArray[np.float64], quiet: bool = False) -> None:
        """Runs the model at a design, and records it."""
        model = self._problem().model
        failure: AnalysisError | None = None
        self._last = None
        self._metadata = {"success": 1, "msg": ""}
        self._vectors["design_var"].set_data(x.copy(), driver_scaling=True)
        self._set_design_vars(driver_scaling=True)
        with RecordingDebugging(self._get_name(), self.iter_count, self) as recording:
            self.iter_count += 1
            try:
                with model._relevance.nonlinear_active("iter", active=self._model_ran):
                    self._run_solve_nonlinear()
                self._model_ran = True
                self._last = x.tobytes()
            except AnalysisError as error:
                model._clear_iprint()
                self._metadata = {"success": 0, "msg": str(error)}
                failure = error
            recording.abs = recording.rel = 0.0
        if failure is not None and not quiet:
            raise ArithmeticError(str(failure)) from failure

    def _evaluated(self, x: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        self._run_at(x)
        (objective,) = self.get_objective_values().values()
        return float(np.asarray(objective).reshape(-1)[0]), _joined(self.get_constraint_values())

    def _differentiated(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        if self._last != x.tobytes():
            self._run_at(x)
        try:
            totals = self._compute_totals(
                of=[*self._objs, *self._cons], wrt=list(self._designvars), return_format=self._total_jac_format
            )
        except AnalysisError as error:
            self._problem().model._clear_iprint()
            raise ArithmeticError(str(error)) from error
        totals = np.array(totals, dtype=np.float64)
        return totals[0].copy(), np.ascontiguousarray(totals[1:])


def _bound(given: Any, size: int) -> NDArray[np.float64]:
    """A bound of OpenMDAO (size,), NaN where there is none."""
    full = np.broadcast_to(np.nan if given is None else np.asarray(given, dtype=np.float64).reshape(-1), size)
    return np.where(np.abs(full) >= 1e30, np.nan, full)


def _flat(parts: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    return np.concatenate(parts) if parts else np.empty(0)


def _joined(values: dict[str, Any]) -> NDArray[np.float64]:
    return _flat([np.asarray(value, dtype=np.float64).reshape(-1) for value in values.values()])


def _row_names(values: dict[str, Any]) -> list[str]:
    names = []
    for name, value in values.items():
        size = np.size(value)
        names += [name] if size == 1 else [f"{name}[{i}]" for i in range(size)]
    return names
