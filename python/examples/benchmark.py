"""What the boundary between Python and Rust costs: `python python/examples/benchmark.py`, with the package installed."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import flexbody

PROBLEM = Path(__file__).parents[2] / "problems" / "trebuchet.json"
REPEATS = 5


def fastest(call: Callable[[int], object], count: int) -> float:
    """Seconds of one call, the least of several series."""
    series = []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        for k in range(count):
            call(k)
        series.append((time.perf_counter() - begun) / count)
    return min(series)


def main() -> None:
    """Prints the table."""
    ball = flexbody.Problem.from_dict(
        {
            "version": 1,
            "name": "ball",
            "bodies": {"ball": {"shape": {"sphere": {"radius": 1}}, "mass": 1}},
            "simulation": {"duration": 1, "steps": 1},
            "functions": {"mass": "mass"},
            "variables": {"mass": {"path": "/bodies/ball/mass", "lower": 0.5, "upper": 2}},
        }
    )
    known = fastest(lambda _: ball.values([1.0]), 5000)
    trebuchet = flexbody.Problem.from_file(PROBLEM)
    start = trebuchet.variables.start
    values = fastest(lambda k: trebuchet.values(start * (1 + 1e-12 * k)), 200)
    both = fastest(lambda k: trebuchet.evaluate(start * (1 + 1e-12 * k)), 100)
    print(f"a call whose design is known already   {1e6 * known:8.1f} µs")
    print(f"values of the trebuchet                {1e6 * values:8.1f} µs")
    print(f"values and gradients of the trebuchet  {1e6 * both:8.1f} µs")


if __name__ == "__main__":
    main()
