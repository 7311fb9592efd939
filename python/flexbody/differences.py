"""Derivatives by differences of a function, within bounds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

SCHEMES = ("2-point", "3-point", "cs")
"""Names of the schemes, as in SciPy: forward, central and complex differences."""

_PRECISION = float(np.finfo(np.float64).eps)
_STEPS = {"2-point": _PRECISION ** (1 / 2), "3-point": _PRECISION ** (1 / 3), "cs": 1e-20}


def jacobian(
    function: Callable[[NDArray[Any]], NDArray[Any]],
    x: Vector,
    value: Vector | None,
    scheme: str,
    lower: Vector,
    upper: Vector,
    relative_step: float | None = None,
) -> Matrix:
    """Derivatives of a function of n variables with m values, as a matrix (m, n).

    `function` takes an array (n,) and returns an array (m,). `value` is the function at `x`, if it is known. Steps are
    `relative_step` (default: 1.5e-8 forward, 6e-6 central, 1e-20 complex) times max(1, |x|). Real steps never leave
    the bounds `lower` and `upper`, each (n,): they turn round, become one-sided or shrink there.
    """
    steps = (_STEPS[scheme] if relative_step is None else relative_step) * np.maximum(1.0, np.abs(x))
    if scheme == "cs":
        return _complex(function, x, steps)
    if value is None:
        value = function(x.copy())
    columns = np.empty((value.size, x.size))
    for i in range(x.size):
        columns[:, i] = _column(function, x, value, i, float(steps[i]), scheme, float(lower[i]), float(upper[i]))
    return columns


def _complex(function: Callable[[NDArray[Any]], NDArray[Any]], x: Vector, steps: Vector) -> Matrix:
    columns = []
    for i in range(x.size):
        z = x.astype(np.complex128)
        z[i] += 1j * steps[i]
        columns.append(np.imag(function(z)) / steps[i])
    return np.ascontiguousarray(np.stack(columns, axis=1))


def _column(
    function: Callable[[NDArray[Any]], NDArray[Any]],
    x: Vector,
    value: Vector,
    i: int,
    step: float,
    scheme: str,
    lower: float,
    upper: float,
) -> Vector:
    """The derivative in variable `i`."""

    def at(move: float) -> tuple[Vector, float]:
        """The function after a move, and the move as it was rounded."""
        moved = x.copy()
        moved[i] += move
        done = float(moved[i] - x[i])
        return function(moved), done

    below, above = x[i] - lower, upper - x[i]
    if below <= 0.0 and above <= 0.0:
        return np.zeros(value.size)
    if scheme == "3-point" and min(below, above) >= step:
        (right, a), (left, b) = at(step), at(-step)
        return (right - left) / (a - b)
    forwards = above >= step if x[i] >= 0.0 else not below >= step
    if (above if forwards else below) < step:
        forwards = above >= below
    room = above if forwards else below
    if scheme == "2-point":
        moved, a = at(min(step, room) if forwards else -min(step, room))
        return (moved - value) / a
    half = min(step, room / 2) if forwards else -min(step, room / 2)
    (near, a), (far, b) = at(half), at(2 * half)
    # The parabola through three points that need not be equally far apart.
    return ((near - value) * b / a - (far - value) * a / b) / (b - a)
