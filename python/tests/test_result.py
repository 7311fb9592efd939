"""Optimisations from Python: the optimum of the command, results that the command reads."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexbody
from scenes import OPTIMUM


def test_the_trebuchet_throws_as_far_as_by_the_command(
    trebuchet: flexbody.Problem, optimize: str, tmp_path: Path
) -> None:
    result = trebuchet.optimise()
    assert result.converged and result.objective == pytest.approx(OPTIMUM, abs=1e-4)
    assert result.certificate is not None and result.certificate["passed"]
    assert result.constraints["clear the barrier"]["value"] >= -1e-6
    assert set(result.multipliers) == {"constraints", "lower_bounds", "upper_bounds"}
    assert result.variables["counterweight mass"] == pytest.approx(500, abs=1e-6)
    assert result.errors["range"] is not None and result.errors["range"] < 1e-6
    history = result.history
    assert history.x.shape == (len(history), 6) and history.objective[0] == pytest.approx(546.5068, abs=1e-3)
    assert history.objective[-1] == result.objective
    assert result.save(tmp_path / "py") == []
    names = {path.name for path in (tmp_path / "py").iterdir()}
    assert {"optimum.json", "history.csv", "convergence.svg", "motion.svg", "report.html"} <= names
    assert json.loads((tmp_path / "py" / "optimum.json").read_text()) == result.record
    # The command gives the same record to the last bit, and reads that of Python.
    run = [optimize, str(Path(__file__).parents[2] / "problems" / "trebuchet.json"), "--quiet"]
    subprocess.run([*run, "--output", str(tmp_path / "command")], check=True, timeout=120)
    command = json.loads((tmp_path / "command" / "optimum.json").read_text())
    assert command == result.record
    compare = [optimize, "compare", str(tmp_path / "py"), str(tmp_path / "command")]
    assert subprocess.run(compare, capture_output=True).returncode == 0
    assert "the optimality conditions hold" in result._repr_html_() and "<!" in result.animate().html


def test_a_callback_sees_every_iteration_and_stops(trebuchet: flexbody.Problem) -> None:
    rows: list[dict[str, Any]] = []

    def callback(row: dict[str, Any]) -> bool:
        rows.append(row)
        return len(rows) == 5

    result = trebuchet.optimise(callback=callback, certificate=False)
    assert len(rows) == 5 and [row["iteration"] for row in rows] == [0, 1, 2, 3, 4]
    assert result.status == "interrupted" and rows[2]["x"].shape == (6,)
    assert result.certificate is None


def test_an_exception_of_a_callback_is_raised(trebuchet: flexbody.Problem) -> None:
    def callback(row: dict[str, Any]) -> None:
        raise ZeroDivisionError("on purpose")

    with pytest.raises(ZeroDivisionError, match="on purpose"):
        trebuchet.optimise(callback=callback)
    # The work of other threads on this problem goes on.
    assert np.isfinite(trebuchet.values()).all()
    assert trebuchet.optimise(certificate=False).converged


@pytest.mark.parametrize("threads", [1, 2])
def test_a_callback_may_use_the_library(trebuchet: flexbody.Problem, threads: int) -> None:
    """Even the same problem, and on one thread."""
    before = flexbody.threads()
    seen: list[float] = []

    def callback(row: dict[str, Any]) -> bool:
        seen.append(trebuchet.values(row["x"])[0])
        seen.append(trebuchet.simulate(row["x"], at=[0.5]).body("stone").position[0, 0])
        return len(seen) >= 8

    try:
        flexbody.threads(threads)
        assert trebuchet.optimise(callback=callback, certificate=False).status == "interrupted"
    finally:
        flexbody.threads(before)
    assert len(seen) == 8


def test_an_interrupted_run_is_resumed_without_repetition(trebuchet: flexbody.Problem, tmp_path: Path) -> None:
    whole = trebuchet.optimise(certificate=False)
    count = 0

    def callback(row: dict[str, Any]) -> bool:
        nonlocal count
        count += 1
        return count == 6

    trebuchet.optimise(callback=callback, directory=tmp_path, certificate=False)
    known = len((tmp_path / "evaluations.jsonl").read_text().splitlines())
    resumed = trebuchet.optimise(resume=tmp_path, directory=tmp_path, certificate=False)
    assert resumed.x.tolist() == whole.x.tolist()
    assert resumed.record["counts"] == whole.record["counts"]
    assert len((tmp_path / "evaluations.jsonl").read_text().splitlines()) > known
    with pytest.raises(ValueError, match="expected that of the run to resume"):
        trebuchet.optimise(resume=tmp_path / "none")


def test_several_starts_find_several_optima(trebuchet: flexbody.Problem, tmp_path: Path) -> None:
    result = trebuchet.optimise(starts=3, certificate=False)
    assert result.objective == pytest.approx(OPTIMUM, abs=1e-3)
    assert result.optima and result.optima[0].x.shape == (6,)
    assert sum(own.found_by for own in result.optima) <= 3
    result.save(tmp_path, report=False)
    assert (tmp_path / "optima.csv").exists() and not (tmp_path / "report.html").exists()
    with pytest.raises(ValueError, match="a callback and several starts"):
        trebuchet.optimise(starts=2, callback=print)
    for wrong in (0, -1, 1.5, True, 10**15):
        with pytest.raises(ValueError, match=f"found {wrong} starts"):
            trebuchet.optimise(starts=wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="expected a function"):
        trebuchet.optimise(callback=3)  # type: ignore[arg-type]


def test_what_cannot_be_optimised_is_said(pendulum: flexbody.Problem) -> None:
    with pytest.raises(ValueError, match="no objective"):
        pendulum.optimise()


def test_a_run_writes_nothing_unless_asked(
    trebuchet: flexbody.Problem, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    trebuchet.optimise()
    trebuchet.simulate()
    trebuchet.check()
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")


def test_progress_is_a_bar(trebuchet: flexbody.Problem, capfd: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("tqdm")
    trebuchet.optimise(progress=True, certificate=False)
    assert "iterations" in capfd.readouterr().err


def test_a_result_in_a_directory_that_cannot_be_written(trebuchet: flexbody.Problem, tmp_path: Path) -> None:
    result = trebuchet.optimise(certificate=False)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError):
        result.save(tmp_path / "file")
    assert np.isfinite(result.x).all()
