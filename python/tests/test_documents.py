"""The tutorial runs as it stands, and the page of the interface is that of the code."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
OPTIONAL = {"scipy": "scipy", "openmdao": "openmdao", "jax": "jax"}


def blocks(text: str) -> list[tuple[str, str, str]]:
    """Every Python block with its heading and what it prints."""
    found = []
    heading, parts = "", re.split(r"^(## .*)$", text, flags=re.MULTILINE)
    for part in parts:
        if part.startswith("## "):
            heading = part.removeprefix("## ")
            continue
        for match in re.finditer(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", part, flags=re.DOTALL):
            found.append((heading, match[1], match[2] or ""))
    return found


def matches(line: str, expected: str) -> bool:
    """Whether a line is as expected; `...` stands for anything."""
    return re.fullmatch(".*".join(map(re.escape, expected.split("..."))), line) is not None


def test_the_tutorial_prints_what_it_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(ROOT / "problems", tmp_path / "problems", ignore=lambda _, names: [n for n in names if n == "extreme"])
    monkeypatch.chdir(tmp_path)
    everything = blocks((DOCS / "python.md").read_text(encoding="utf-8"))
    assert len(everything) > 10
    names: dict[str, Any] = {}
    for heading, code, expected in everything:
        missing = [p for word, p in OPTIONAL.items() if f"import {word}" in code and importlib.util.find_spec(p) is None]
        if missing:
            continue
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(code, f"python.md, {heading}", "exec"), names)
        printed, wanted = out.getvalue().splitlines(), expected.splitlines()
        same = len(printed) == len(wanted) and all(map(matches, printed, wanted))
        assert same, f"{heading}:\n{code}\nprints\n{out.getvalue()}\nand not\n{expected}"


def test_the_page_of_the_interface_is_that_of_the_code() -> None:
    path = Path(__file__).parents[1] / "api_page.py"
    spec = importlib.util.spec_from_file_location("api_page", path)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    written = (DOCS / "python-api.md").read_text(encoding="utf-8")
    assert made.page() == written, "run: python python/api_page.py"
