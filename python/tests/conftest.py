"""What the tests share."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

import flexbody
from scenes import PENDULUM, PROBLEMS


@pytest.fixture
def optimize() -> str:
    """The command."""
    for path in (os.environ.get("FLEXBODY_OPTIMIZE"), Path(__file__).parents[2] / "target" / "release" / "optimize"):
        if path and shutil.which(path):
            return str(path)
    pytest.skip("no command `optimize`: build it, or set FLEXBODY_OPTIMIZE to its path")


@pytest.fixture(scope="session")
def trebuchet_file() -> Path:
    return PROBLEMS / "trebuchet.json"


@pytest.fixture
def trebuchet(trebuchet_file: Path) -> flexbody.Problem:
    return flexbody.Problem.from_file(trebuchet_file)


@pytest.fixture
def pendulum() -> flexbody.Problem:
    return flexbody.Problem.from_dict(PENDULUM)
