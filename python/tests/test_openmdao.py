"""Simulations as components of OpenMDAO, and the optimiser as its driver."""

from __future__ import annotations

import importlib
import json
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexbody
from scenes import FTOL, OPTIMUM, PENDULUM, PROBLEMS

om = pytest.importorskip("openmdao.api")

from flexbody.openmdao import FlexbodyComp, FlexbodyDriver, unit  # noqa: E402


@pytest.fixture(autouse=True)
def own_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """OpenMDAO writes reports where it runs."""
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", category=om.OpenMDAOWarning)
        yield


@pytest.fixture(scope="module")
def trebuchet() -> flexbody.Problem:
    return flexbody.Problem.from_file(PROBLEMS / "trebuchet.json")


@pytest.fixture(scope="module")
def linkage() -> flexbody.Problem:
    return flexbody.Problem.from_file(PROBLEMS / "extreme" / "locking_linkage.json")


def throw(problem: flexbody.Problem, driver: Any = None, **options: Any) -> Any:
    """A model of one component, posed as its file says."""
    task = om.Problem(reports=None)
    throwing = task.model.add_subsystem("throw", FlexbodyComp(problem, **options), promotes=["*"])
    throwing.pose(task.model)
    if driver is not None:
        task.driver = driver
    task.setup()
    return task


@pytest.mark.parametrize(
    ("written", "translated"),
    [
        ("kg", "kg"),
        ("kg m²", "kg*m**2"),
        ("m/s²", "m/s**2"),
        ("N m/rad", "N*m/rad"),
        ("N m s/rad", "N*m*s/rad"),
        ("kg m²/s", "kg*m**2/s"),
        ("N/m³", "N/m**3"),
        ("1/s", "1/s"),
        ("m⁻¹", "m**-1"),
        ("Pa", "Pa"),
        ("Hz", "Hz"),
        ("rad", "rad"),
        ("1", None),
        ("", None),
        ("parsec per fortnight", None),
    ],
)
def test_units(written: str, translated: str | None) -> None:
    assert unit(written) == translated


def test_inputs_and_outputs_have_names_values_and_units(trebuchet: flexbody.Problem) -> None:
    task = throw(trebuchet)
    task.run_model()
    assert task["range"] == pytest.approx(trebuchet.values()[:1])
    assert task.get_val("arm_mass", units="g") == pytest.approx([40000.0])
    assert task.get_val("arm_angle", units="deg") == pytest.approx([0.0])
    assert task.get_val("clearance", units="cm") == pytest.approx(100 * trebuchet.values()[1:])
    throwing = task.model.throw
    assert throwing.input_names["sling mass"] == "sling_mass"
    assert throwing.output_names == {"range": "range", "clearance": "clearance"}


def test_partials_are_exact(trebuchet: flexbody.Problem) -> None:
    task = throw(trebuchet)
    task.run_model()
    checked = task.check_partials(form="central", out_stream=None)
    importlib.import_module("openmdao.utils.assert_utils").assert_check_partials(checked, atol=1e-6, rtol=1e-6)
    assert task.check_totals(
        of=["range"], wrt=["arm_mass"], form="central", step=1e-4, out_stream=None, compact_print=True
    )


def test_vector_of_all_variables(trebuchet: flexbody.Problem) -> None:
    task = throw(trebuchet, shapes="vector")
    task.run_model()
    assert task["x"].shape == (6,)
    totals = task.compute_totals(of=["range"], wrt=["x"])
    assert totals["range", "x"] == pytest.approx(trebuchet.gradients(None, ["range"]))


def test_numbered_variables_are_arrays() -> None:
    problem = flexbody.Problem.from_file(PROBLEMS / "scordelis_lo.json")
    names = [name for name in problem.variables.names if name.endswith("]")]
    assert len(names) == 8
    task = throw(problem)
    base = names[0].partition("[")[0].replace(" ", "_")
    assert task.get_val(base).shape == (len(names),)
    task.run_model()
    component = task.model.throw
    assert component.input_names[names[1]] == f"{base}[1]"
    scalars = throw(problem, shapes="scalars")
    assert scalars.get_val(f"{base}_1").shape == (1,)


@pytest.mark.parametrize("shapes", ["arrays", "scalars", "vector"])
def test_arrays_of_thicknesses_and_their_constraints(shapes: str) -> None:
    document = json.loads((PROBLEMS / "plate_stress.json").read_text())
    plate = document["structures"]["plate"]
    plate["mesh"]["plate"]["elements"] = [4, 4]
    plate["thickness"] = {"per": "patch", "patches": [2, 2], "value": 0.012}
    document["functions"]["stress"]["von_mises"]["per"] = "thickness"
    problem = flexbody.Problem.from_dict(document)
    task = om.Problem(driver=FlexbodyDriver(), reports=None)
    component = task.model.add_subsystem("plate", FlexbodyComp(problem, shapes=shapes))
    component.pose(task.model, "plate.")
    task.setup()
    assert task.run_driver().success
    assert task["plate.mass"] == pytest.approx([problem.optimise().objective], rel=1e-6)
    assert task["plate.lowest_frequency"] >= 110 * (1 - 1e-6)
    if shapes == "scalars":
        assert task["plate.stress_3"] <= 1 + 1e-6
    else:
        assert task["plate.stress"].shape == (4,)
        assert task["plate.stress"].max() <= 1 + 1e-6


def test_driver_finds_the_optimum_of_the_trebuchet(
    trebuchet: flexbody.Problem, capsys: pytest.CaptureFixture[str]
) -> None:
    task = throw(trebuchet, FlexbodyDriver())
    result = task.run_driver()
    assert result.success and not task.driver.fail
    assert result.exit_status.startswith("converged")
    assert task.driver.outcome.status == "converged"
    assert task["range"] == pytest.approx([OPTIMUM], abs=1e-3)
    assert task["clearance"] >= -1e-6
    assert capsys.readouterr().out == ""


def test_slsqp_of_openmdao_finds_the_same(trebuchet: flexbody.Problem) -> None:
    pytest.importorskip("scipy")
    task = throw(trebuchet, om.ScipyOptimizeDriver(optimizer="SLSQP", tol=FTOL, disp=False))
    assert task.run_driver().success
    assert task["range"] == pytest.approx([OPTIMUM], abs=1e-2)


def priced(problem: flexbody.Problem, driver: Any, reports: Any = None) -> Any:
    """The trebuchet beside a component of costs: masses cost money, throws earn it."""
    task = om.Problem(reports=reports)
    model = task.model
    model.add_subsystem(
        "throw",
        FlexbodyComp(problem),
        promotes=["counterweight_mass", "arm_mass", "arm_angle", "range", "clearance"],
    )
    masses = {"counterweight_mass": {"units": "kg"}, "arm_mass": {"units": "kg"}}
    price = om.ExecComp("cost = 0.02 * counterweight_mass ** 1.5 + 3 * arm_mass", **masses)
    model.add_subsystem("price", price, promotes=["*"])
    model.add_subsystem("trade", om.ExecComp("profit = range - cost", range={"units": "m"}), promotes=["*"])
    model.set_input_defaults("counterweight_mass", 400.0, units="kg")
    model.set_input_defaults("arm_mass", 40.0, units="kg")
    model.add_design_var("counterweight_mass", lower=300, upper=500, ref=100)
    model.add_design_var("arm_mass", lower=30, upper=60, ref=15)
    model.add_design_var("arm_angle", lower=-0.3, upper=0.5)
    model.add_objective("profit", ref=-100)
    model.add_constraint("clearance", lower=0)
    model.add_constraint("cost", upper=320, ref=100)
    task.driver = driver
    task.setup()
    return task


def test_simulation_beside_another_component(trebuchet: flexbody.Problem) -> None:
    ours = priced(trebuchet, FlexbodyDriver())
    assert ours.run_driver().success
    assert ours["cost"] <= 320 * (1 + 1e-6)
    assert ours["clearance"] >= -1e-6
    pytest.importorskip("scipy")
    theirs = priced(trebuchet, om.ScipyOptimizeDriver(optimizer="SLSQP", tol=FTOL, disp=False))
    theirs.run_driver()
    assert ours["profit"] == pytest.approx(theirs["profit"], rel=1e-4)


def test_n2_and_reports(trebuchet: flexbody.Problem, tmp_path: Path) -> None:
    task = priced(trebuchet, FlexbodyDriver(), reports=True)
    task.run_driver()
    om.n2(task, outfile=str(tmp_path / "n2.html"), show_browser=False)
    assert (tmp_path / "n2.html").stat().st_size > 10_000
    reports = {path.name for path in Path(task.get_reports_dir()).rglob("*")}
    assert {"n2.html", "opt_report.html", "driver_scaling_report.html"} <= reports
    task.list_driver_vars(out_stream=None)


def test_recorder_keeps_every_run(trebuchet: flexbody.Problem) -> None:
    driver = FlexbodyDriver(max_iterations=5)
    driver.add_recorder(om.SqliteRecorder("cases.sql"))
    driver.recording_options["record_derivatives"] = True
    task = throw(trebuchet, driver)
    task.run_driver()
    task.cleanup()
    assert not driver.result.success
    assert driver.fail
    assert driver.result.exit_status.startswith("iteration limit")
    reader = om.CaseReader(task.get_outputs_dir() / "cases.sql")
    cases = [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]
    assert len(cases) == driver.iter_count > 5
    assert cases[-1].get_objectives()["range"] == pytest.approx(task["range"])
    assert all(case.success == 1 for case in cases)


def test_driver_backs_off_from_failed_simulations() -> None:
    """The optimum is beside designs that fail."""
    task = om.Problem(reports=None)

    class Cliff(om.ExplicitComponent):  # type: ignore[misc]
        def setup(self) -> None:
            self.add_input("x", 10.0)
            self.add_output("y", 0.0)
            self.declare_partials("y", "x")

        def compute(self, inputs: Any, outputs: Any) -> None:
            if inputs["x"][0] <= 0:
                raise om.AnalysisError("no value there")
            outputs["y"] = inputs["x"] - 0.01 * np.log(inputs["x"])

        def compute_partials(self, inputs: Any, partials: Any) -> None:
            partials["y", "x"] = 1 - 0.01 / inputs["x"]

    task.model.add_subsystem("cliff", Cliff(), promotes=["*"])
    task.model.add_design_var("x")
    task.model.add_objective("y")
    task.driver = FlexbodyDriver()
    task.driver.add_recorder(om.SqliteRecorder("cases.sql"))
    task.setup()
    assert task.run_driver().success
    task.cleanup()
    assert task["x"] == pytest.approx([0.01], rel=1e-4)
    reader = om.CaseReader(task.get_outputs_dir() / "cases.sql")
    cases = [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]
    failed = [case for case in cases if not case.success]
    assert len(failed) == task.driver.outcome.nfail > 0
    assert all("no value there" in case.msg for case in failed)


def test_driver_takes_equalities_arrays_and_scaling() -> None:
    task = om.Problem(reports=None)
    task.model.add_subsystem(
        "f",
        om.ExecComp(
            ["f = sum((x - 3) ** 2)", "g = 2 * x", "h = x[0] * x[1]"],
            x={"shape": (3,), "val": [1.0, 2.0, 0.5]},
            g={"shape": (3,)},
        ),
        promotes=["*"],
    )
    task.model.add_design_var("x", lower=[-1, -1, -1], upper=10, ref=5, ref0=1)
    task.model.add_objective("f", ref=3)
    task.model.add_constraint("g", lower=[-1e30, -4, -4], upper=[1e30, 4, 4], ref=7)
    task.model.add_constraint("h", equals=5, ref=0.5, linear=False)
    task.driver = FlexbodyDriver(method="trust_region")
    task.setup()
    assert task.run_driver().success
    assert task["x"] == pytest.approx([2.5, 2.0, 2.0], rel=1e-6)


@pytest.mark.parametrize("limits", [{"lower": 1.0, "upper": 4.5}, {"upper": 4.5}, {"upper": [4.5]}])
@pytest.mark.parametrize("scaling", [{"scaler": -3.0}, {"ref": -1.0, "ref0": 1.0}, {"ref": 5.0}])
def test_driver_takes_negative_scalers(limits: dict[str, Any], scaling: dict[str, float]) -> None:
    task = om.Problem(driver=FlexbodyDriver(), reports=None)
    task.model.add_subsystem("f", om.ExecComp(["f = (x - 3) ** 2 + (y - 3) ** 2", "g = x + y"]), promotes=["*"])
    task.model.add_design_var("x", lower=-1, upper=2, **scaling)
    task.model.add_design_var("y", lower=0.5)
    task.model.add_objective("f")
    task.model.add_constraint("g", **limits, **scaling)
    task.setup()
    assert task.run_driver().success
    assert [task["x"][0], task["y"][0]] == pytest.approx([2.0, 2.5], abs=1e-5)


def test_driver_does_not_hide_bounds_that_contradict_each_other() -> None:
    task = om.Problem(driver=FlexbodyDriver(), reports=None)
    task.model.add_subsystem("f", om.ExecComp(["f = x ** 2", "g = x"]), promotes=["*"])
    task.model.add_design_var("x")
    task.model.add_objective("f")
    task.model.add_constraint("g", lower=2, upper=1)
    task.setup()
    assert not task.run_driver().success


def test_driver_passes_exceptions_on() -> None:
    task = om.Problem(reports=None)

    class Broken(om.ExplicitComponent):  # type: ignore[misc]
        def setup(self) -> None:
            self.add_input("x", 1.0)
            self.add_output("y", 0.0)
            self.declare_partials("y", "x")

        def compute(self, inputs: Any, outputs: Any) -> None:
            raise KeyError("a bug")

    task.model.add_subsystem("broken", Broken(), promotes=["*"])
    task.model.add_design_var("x")
    task.model.add_objective("y")
    task.driver = FlexbodyDriver()
    task.setup()
    with pytest.raises(KeyError, match="a bug"):
        task.run_driver()


def test_failed_simulation_is_an_analysis_error(linkage: flexbody.Problem) -> None:
    task = om.Problem(reports=None)
    component = task.model.add_subsystem("linkage", FlexbodyComp(linkage), promotes=["*"])
    task.setup()
    (name,) = component.input_names.values()
    task[name] = 9.0
    with pytest.raises(om.AnalysisError, match="locking_linkage"):
        task.run_model()


@pytest.mark.parametrize("kind", ["DOEDriver", "AnalysisDriver"])
def test_design_of_experiments_of_200_points_with_failures(linkage: flexbody.Problem, kind: str) -> None:
    task = om.Problem(reports=None)
    component = task.model.add_subsystem("linkage", FlexbodyComp(linkage), promotes=["*"])
    component.pose(task.model)
    (name,), (output,) = component.input_names.values(), component.output_names.values()
    if kind == "DOEDriver":
        task.driver = om.DOEDriver(om.UniformGenerator(num_samples=200, seed=1))
    else:
        lengths = np.random.default_rng(1).uniform(-10, 10, 200)
        task.driver = om.AnalysisDriver([{name: {"val": length}} for length in lengths])
    task.driver.add_recorder(om.SqliteRecorder("cases.sql"))
    task.setup()
    task.run_driver()
    task.cleanup()
    reader = om.CaseReader(task.get_outputs_dir() / "cases.sql")
    cases = [reader.get_case(case) for case in reader.list_cases("driver", out_stream=None)]
    assert len(cases) == 200
    good = [case for case in cases if np.isfinite(case[output]).all()]
    bad = [case for case in cases if np.isnan(case[output]).all()]
    assert len(good) + len(bad) == 200
    assert len(good) >= 10 and len(bad) >= 10
    for case in good[:5]:
        assert case[output] == pytest.approx(linkage.values([float(case[name][0])]), rel=1e-5)
    if kind == "AnalysisDriver":
        assert all(case.success == 1 for case in good)
        assert all(case.success == 0 and "AnalysisError" in case.msg for case in bad)


def test_misuse(trebuchet: flexbody.Problem) -> None:
    with pytest.raises(ValueError, match="FlexbodyComp: no problem"):
        task = om.Problem(reports=None)
        task.model.add_subsystem("throw", FlexbodyComp())
        task.setup()
    with pytest.raises(ValueError, match='functions: the problem has no "rnage"; it has range, clearance'):
        throw(trebuchet, functions=["rnage"])
    with pytest.raises(ValueError, match='the objective or a constraint needs "range"'):
        throw(trebuchet, functions=["clearance"])
    with pytest.raises(ValueError, match="FlexbodyComp: no functions of trebuchet"):
        task = om.Problem(reports=None)
        task.model.add_subsystem("throw", FlexbodyComp(trebuchet, functions=[]))
        task.setup()
    still = {name: entry for name, entry in PENDULUM.items() if name != "variables"}
    with pytest.raises(ValueError, match="FlexbodyComp: the problem pendulum has no variables"):
        task = om.Problem(reports=None)
        task.model.add_subsystem("swing", FlexbodyComp(flexbody.Problem.from_dict(still)))
        task.setup()
    task = throw(trebuchet, FlexbodyDriver(max_iterations=-1))
    with pytest.raises(ValueError, match="options: expected max_iterations of at least 0, found -1"):
        task.run_driver()
    task = om.Problem(driver=FlexbodyDriver(), reports=None)
    task.model.add_subsystem("f", om.ExecComp(["y = x", "z = 2 * x"]), promotes=["*"])
    task.model.add_design_var("x")
    task.model.add_objective("y")
    task.model.add_objective("z")
    task.setup()
    with pytest.raises(RuntimeError, match="takes one objective, and 2 were added"):
        task.run_driver()
    with pytest.raises(TypeError, match="complex step does not enter"):
        task = throw(trebuchet)
        task.setup(force_alloc_complex=True)
        task.run_model()
        task.set_complex_step_mode(True)
        task.run_model()


def test_a_path_is_a_problem() -> None:
    task = om.Problem(reports=None)
    task.model.add_subsystem("throw", FlexbodyComp(str(PROBLEMS / "trebuchet.json"), functions=["clearance"]))
    task.setup()
    assert "throw.clearance" in task.model.list_outputs(out_stream=None, prom_name=False)[0][0]
