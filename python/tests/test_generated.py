"""The generated parts are those of the schema, and complete."""

from __future__ import annotations

import importlib.util
import inspect
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from flexbody import Machine, parts

PYTHON = Path(__file__).parents[1]
PROBLEMS = PYTHON.parent / "problems"


def load_generator() -> Any:
    spec = importlib.util.spec_from_file_location("generate", PYTHON / "generate.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    for path in (os.environ.get("FLEXBODY_OPTIMIZE"), PYTHON.parent / "target" / "release" / "optimize"):
        if path and shutil.which(path):
            run = subprocess.run([path, "schema"], check=True, capture_output=True, encoding="utf-8")
            return json.loads(run.stdout)  # type: ignore[no-any-return]
    pytest.skip("no command `optimize`: build it, or set FLEXBODY_OPTIMIZE to its path")


def test_the_file_is_what_the_schema_gives(schema: dict[str, Any]) -> None:
    written = (PYTHON / "flexbody" / "parts.py").read_text(encoding="utf-8")
    assert load_generator().generate(schema) == written, "run: optimize schema | python generate.py -"


def test_every_key_is_an_argument(schema: dict[str, Any]) -> None:
    """Every set of keys of an object of the schema is the set of arguments of a function."""
    signatures = set()
    for owner in [parts, Machine, *(item for item in vars(parts).values() if inspect.isclass(item))]:
        for item in vars(owner).values():
            item = getattr(item, "__func__", item)
            if inspect.isfunction(item):
                signatures.add(frozenset(name.removesuffix("_") for name in inspect.signature(item).parameters))
    for item in vars(parts.MachineKeys).values():
        if inspect.isfunction(item):
            names = {name.removesuffix("_") for name in inspect.signature(item).parameters}
            signatures |= {frozenset(names - {"self"}), frozenset(names - {"self", "name"})}
    for name, content in schema["$defs"].items():
        for variant in [content, *content.get("oneOf", [])]:
            if "properties" in variant and "oneOf" not in content:
                assert frozenset(variant["properties"]) in signatures, name
            for payload in variant.get("properties", {}).values():
                if "oneOf" in content and "properties" in payload:
                    assert frozenset(payload["properties"]) in signatures, name


def test_docstrings_have_units() -> None:
    for item, text in [
        (Machine.add_body, "mass : number at least 0 [kg], optional"),
        (parts.loads.spring, "rest_length : number at least 0 [m]"),
        (parts.varying_torques.table, "values : numbers, shape (n,) [N m]"),
    ]:
        assert text in (inspect.getdoc(item) or "")
    for name in parts.__all__:
        thing = getattr(parts, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert inspect.getdoc(thing), name


def test_names_complete() -> None:
    assert {"revolute", "weld", "rod"} <= set(dir(parts.joints))
    assert {"add_body", "add_joint", "set_simulation", "minimise", "problem"} <= set(dir(Machine))
    assert list(inspect.signature(parts.joints.revolute).parameters) == ["between", "at", "axis", "start"]


def build(document: dict[str, Any]) -> Machine:
    """The document by calls alone, kind by kind."""
    keys = ("description", "gravity", "input_tolerance", "analysis", "start")
    top = {key: document[key] for key in keys if key in document}
    machine = Machine(document["name"], **top)
    collections = {"joints": parts.joints, "loads": parts.loads, "couplings": parts.couplings}
    for key, value in document.items():
        if key in ("version", "name", "$schema", *top):
            continue
        single = {"bodies": "body", "load_cases": "load_case"}.get(key, key.removesuffix("s"))
        for name, entry in value.items() if hasattr(machine, f"add_{single}") else ():
            if key in collections:
                ((kind, arguments),) = entry.items()
                getattr(machine, f"add_{single}")(name, getattr(collections[key], kind)(**arguments))
            elif key in ("functions", "load_cases", "parameters"):
                getattr(machine, f"add_{single}")(name, entry)
            else:
                getattr(machine, f"add_{single}")(name, **entry)
        if key == "objective":
            ((sense, function),) = value.items()
            getattr(machine, sense)(function)
        elif hasattr(machine, f"set_{key}"):
            getattr(machine, f"set_{key}")(**value)
    return machine


@pytest.mark.parametrize("path", sorted(PROBLEMS.glob("**/*.json")), ids=lambda path: path.stem)
def test_every_problem_file_can_be_built(path: Path) -> None:
    if path.stat().st_size > 1_000_000:
        pytest.skip("large")
    document = json.loads(path.read_text(encoding="utf-8"))
    if document.get("version") != 1 or "name" not in document:
        pytest.skip("not a problem file")
    document.pop("$schema", None)
    assert build(document).to_dict() == document
