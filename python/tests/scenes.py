"""Scenes that several tests use."""

from __future__ import annotations

from pathlib import Path
from typing import Any

PROBLEMS = Path(__file__).parents[2] / "problems"

# The range of the best trebuchet [m], and how far SLSQP is to be from a stationary value [m]. Rounding is 1e-12 of 850 m, at which
# its line search fails.
OPTIMUM = 849.8985
FTOL = 1e-7

PENDULUM: dict[str, Any] = {
    "version": 1,
    "name": "pendulum",
    "bodies": {
        "bar": {
            "shape": {"box": {"size": [1, 0.1, 0.1]}},
            "mass": 1,
            "points": {"pin": [-0.5, 0, 0], "tip": [0.5, 0, 0]},
            "place": {"put": "pin", "at": [0, 0, 0]},
        }
    },
    "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0], "axis": [0, 0, 1]}}},
    "gravity": [0, -9.81, 0],
    "simulation": {"duration": 1},
    "functions": {
        "height": {"final": {"position": {"body": "bar", "point": "tip", "direction": [0, 1, 0]}}},
        "speed": {"final": {"velocity": {"body": "bar", "point": "tip", "direction": [0, 1, 0]}}},
        "mass": "mass",
    },
    "variables": {
        "gravity": {"path": "/gravity/1", "lower": -20, "upper": -1},
        "mass": {"path": "/bodies/bar/mass", "lower": 0.1, "upper": 10},
    },
}
