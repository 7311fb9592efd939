"""Problems for pyOptSparse: with it where it is installed, and with a stand-in that has its interface."""

from __future__ import annotations

import importlib
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexbody
from scenes import OPTIMUM, PROBLEMS


@pytest.fixture(scope="module")
def trebuchet() -> flexbody.Problem:
    return flexbody.Problem.from_file(PROBLEMS / "trebuchet.json")


@pytest.mark.parametrize("optimiser", ["SLSQP", "IPOPT"])
def test_pyoptsparse_finds_the_optimum(trebuchet: flexbody.Problem, optimiser: str, tmp_path: Path) -> None:
    pyoptsparse = pytest.importorskip("pyoptsparse")
    from flexbody.pyoptsparse import optimization

    options: dict[str, Any] = {
        "SLSQP": {"ACC": 1e-9, "IFILE": str(tmp_path / "slsqp.out")},
        "IPOPT": {"tol": 1e-6, "print_level": 0, "output_file": str(tmp_path / "ipopt.out")},
    }
    try:
        solver = pyoptsparse.OPT(optimiser, options=options[optimiser])
    except Exception as error:
        pytest.skip(f"this pyOptSparse has no {optimiser}: {error}")
    task, sens = optimization(trebuchet)
    found = solver(task, sens=sens)
    assert -float(np.ravel(found.fStar)[0]) == pytest.approx(OPTIMUM, abs=1e-2)


class Optimization:
    """What pyOptSparse's class of this name is told."""

    def __init__(self, name: str, functions: Any) -> None:
        self.name, self.functions = name, functions
        self.variables: dict[str, Any] = {}
        self.constraints: dict[str, Any] = {}
        self.objectives: list[str] = []

    def addVarGroup(self, name: str, nVars: int, varType: str = "c", **told: Any) -> None:  # noqa: N802, N803
        assert varType == "c"
        for value in told.values():
            assert np.broadcast_to(value, nVars).shape == (nVars,)
        self.variables[name] = told

    def addConGroup(self, name: str, nCon: int, **told: Any) -> None:  # noqa: N802, N803
        assert nCon == 1 and name not in self.constraints
        self.constraints[name] = told

    def addObj(self, name: str) -> None:  # noqa: N802
        self.objectives.append(name)


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> Any:
    module: Any = types.ModuleType("pyoptsparse")
    module.Optimization = Optimization
    monkeypatch.setitem(sys.modules, "pyoptsparse", module)
    monkeypatch.delitem(sys.modules, "flexbody.pyoptsparse", raising=False)
    yield importlib.import_module("flexbody.pyoptsparse")
    sys.modules.pop("flexbody.pyoptsparse", None)


def test_what_pyoptsparse_is_told(trebuchet: flexbody.Problem, stand_in: Any) -> None:
    task, sens = stand_in.optimization(trebuchet)
    assert task.objectives == ["range"]
    assert task.constraints == {"clear the barrier": {"lower": 0.0, "upper": None}}
    told = task.variables["x"]
    assert told["lower"] == list(trebuchet.variables.lower)
    x = np.array(told["value"])
    exact = trebuchet.evaluate(x)
    values, failed = task.functions({"x": x})
    assert not failed
    assert values == {"range": -exact.values[0], "clear the barrier": exact.values[1]}
    slopes, failed = sens({"x": x}, values)
    assert not failed
    assert slopes["range"]["x"] == pytest.approx(-exact.gradients[:1])
    assert slopes["clear the barrier"]["x"] == pytest.approx(exact.gradients[1:])


def test_failed_simulations_set_the_flag(stand_in: Any) -> None:
    linkage = flexbody.Problem.from_file(PROBLEMS / "extreme" / "locking_linkage.json")
    task, sens = stand_in.optimization(linkage)
    design = {"x": np.array([9.0])}
    values, failed = task.functions(design)
    assert failed and np.isnan(values["end of the coupler"])
    slopes, failed = sens(design, values)
    assert failed and np.isnan(slopes["end of the coupler"]["x"]).all()


@pytest.mark.parametrize(
    ("name", "needed"),
    [("pyoptsparse", "pyoptsparse"), ("openmdao", "openmdao.api"), ("jax", "jax"), ("torch", "torch")],
)
def test_a_missing_package_is_named_with_its_installation(
    name: str, needed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, needed, None)
    monkeypatch.delitem(sys.modules, f"flexbody.{name}", raising=False)
    with pytest.raises(ImportError, match=f"flexbody.{name} needs .*: pip install"):
        importlib.import_module(f"flexbody.{name}")
