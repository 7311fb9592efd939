"""Threads, signals, panics and memory."""

from __future__ import annotations

import copy
import multiprocessing
import os
import signal
import threading
import time
from typing import Any

import numpy as np
import pytest

import flexbody
from flexbody import _flexbody

from scenes import PENDULUM, PROBLEMS


def long_motion() -> flexbody.Problem:
    """A pendulum that swings for an hour."""
    document: dict[str, Any] = copy.deepcopy(PENDULUM)
    document["simulation"] = {"duration": 3600, "tolerance": 1e-12}
    return flexbody.Problem.from_dict(document)


@pytest.mark.parametrize("what", ["values", "optimise", "check"])
def test_an_interrupt_is_heeded_within_a_second(what: str) -> None:
    problem = long_motion()
    if what == "optimise":
        document = problem.to_dict()
        document["objective"] = {"minimise": "height"}
        problem = flexbody.Problem.from_dict(document)
    sent: list[float] = []

    def interrupt() -> None:
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.3, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        getattr(problem, what)()
    assert time.monotonic() - sent[0] < 1.0
    timer.join()


def test_a_problem_is_whole_after_an_interrupt() -> None:
    problem = flexbody.Problem.from_file(PROBLEMS / "trebuchet.json")
    expected = problem.values()

    def callback(row: dict[str, Any]) -> None:
        if row["iteration"] == 2:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        problem.optimise(callback=callback)
    assert problem.values().tolist() == expected.tolist()
    assert problem.optimise(certificate=False).converged


def test_a_panic_is_an_ordinary_exception(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(flexbody.InternalError, match="on purpose"):
        _flexbody._panic()
    assert issubclass(flexbody.InternalError, Exception)
    assert capfd.readouterr() == ("", "")


def test_two_problems_in_two_threads_are_right() -> None:
    names = ["trebuchet.json", "triple_pendulum.json"]
    alone = []
    for name in names:
        problem = flexbody.Problem.from_file(PROBLEMS / name)
        alone.append([problem.values(problem.variables.start * (1 + 1e-6 * k)).tolist() for k in range(30)])
    found: dict[int, list[Any]] = {}

    def work(i: int) -> None:
        problem = flexbody.Problem.from_file(PROBLEMS / names[i])
        start = problem.variables.start
        found[i] = [problem.values(start * (1 + 1e-6 * k)).tolist() for k in range(30)]

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[0], found[1]] == alone


def test_one_problem_in_two_threads_is_right(trebuchet: flexbody.Problem) -> None:
    designs = [trebuchet.variables.start * (1 + 1e-6 * k) for k in range(20)]
    expected = [trebuchet.values(x).tolist() for x in designs]
    found: dict[int, list[float]] = {}

    def work(first: int) -> None:
        for k in range(first, 20, 2):
            found[k] = trebuchet.values(designs[k]).tolist()

    threads = [threading.Thread(target=work, args=(first,)) for first in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[k] for k in range(20)] == expected


def test_one_structure_in_four_threads_is_right() -> None:
    """Its work is parallel inside, and its designs come one after the other."""
    problem = flexbody.Problem.from_file(PROBLEMS / "thickness_sheet.json")
    start = problem.variables.start
    expected = problem.values(start)
    found: list[Any] = []

    def work(k: int) -> None:
        for i in range(5):
            problem.values(start * (1 + 1e-6 * (5 * k + i)))
        found.append(problem.values(start))

    threads = [threading.Thread(target=work, args=(k,), daemon=True) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=120)
    assert len(found) == 4
    assert all(values == pytest.approx(expected, rel=1e-12) for values in found)


def test_a_long_run_does_not_hold_up_another_problem(trebuchet: flexbody.Problem) -> None:
    pendulum = flexbody.Problem.from_dict(PENDULUM)
    pendulum.values()
    thread = threading.Thread(target=lambda: trebuchet.optimise(starts=20, certificate=False), daemon=True)
    thread.start()
    time.sleep(0.2)
    begun = time.monotonic()
    pendulum.values([-9.0, 1.0])
    waited = time.monotonic() - begun
    was_running = thread.is_alive()
    thread.join(timeout=120)
    assert was_running and waited < 1.0


def test_other_threads_run_meanwhile() -> None:
    """The interpreter is free while a motion is computed."""
    problem = long_motion()
    count, done = 0, threading.Event()

    def tick() -> None:
        nonlocal count
        while not done.is_set():
            count += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        problem.values()
    done.set()
    thread.join()
    timer.join()
    assert count > 50


def test_the_number_of_threads() -> None:
    before = flexbody.threads()
    try:
        assert flexbody.threads(1) == 1 == flexbody.threads()
        assert flexbody.Problem.from_dict(PENDULUM).values().shape == (3,)
        assert flexbody.threads(3) == 3
        assert flexbody.threads(0) == (os.cpu_count() or 1)
    finally:
        flexbody.threads(before)
    with pytest.raises(ValueError, match="expected 0 or more"):
        flexbody.threads(-1)


def _values(x: list[float]) -> list[float]:
    found: list[float] = flexbody.Problem.from_dict(PENDULUM).values(x).tolist()
    return found


def test_a_signal_in_a_minimisation_is_heeded() -> None:
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        flexbody.minimise(lambda x: (time.sleep(0.01), float(x @ x))[1], np.ones(40))
    timer.join()


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="no fork here")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_forked_processes_have_threads_of_their_own() -> None:
    expected = _values([-9.81, 1.0])
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(_values, [[-9.81, 1.0]] * 4).get(timeout=60) == [expected] * 4


def test_ten_thousand_evaluations_do_not_grow_the_process() -> None:
    resource = pytest.importorskip("resource")
    document: dict[str, Any] = copy.deepcopy(PENDULUM)
    document["simulation"] = {"duration": 0.2, "steps": 20}
    problem = flexbody.Problem.from_dict(document)

    def peak() -> int:
        size: int = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return size

    sizes = []
    for k in range(10_000):
        x = np.array([-9.81 - 1e-5 * k, 1.0])
        if k % 10 == 0:
            problem.gradients(x)
        else:
            problem.values(x)
        if k in (2000, 9999):
            sizes.append(peak())
    assert sizes[1] - sizes[0] < 2000, f"grew by {sizes[1] - sizes[0]} kB"
