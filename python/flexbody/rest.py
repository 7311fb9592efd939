"""What is at rest: structures under load cases, modes, and states of equilibrium."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["Case", "Modes", "Rest", "State"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """A solved load case of n nodes."""

    displacement: Array
    """In m, shape (n, 3)."""
    rotation: Array
    """In rad, shape (n, 3); on a smooth surface without its part about the normal."""
    shell_stress: Array
    """The largest von Mises stress of each shell in Pa."""
    beam_stress: Array
    """The largest stress along the outer fibres of each beam in Pa; NaN for sections without size."""


class Rest:
    """Structures at rest under load cases."""

    x: Array
    """The design, shape (n_x,)."""
    nodes: Array
    """Places of the nodes in m, shape (n, 3)."""
    cases: dict[str, Case]
    """The load cases by name."""

    def __init__(
        self, problem: Problem, x: Array, nodes: Array, cases: Sequence[tuple[str, Array, Array, Array, Array]]
    ) -> None:
        self.problem = problem
        self.x = x
        self.nodes = nodes
        self.cases = {name: Case(*arrays) for name, *arrays in cases}

    @property
    def values(self) -> Array:
        """Values of the functions, shape (n_f,)."""
        return self.problem.values(self.x)

    def __repr__(self) -> str:
        return f"<Rest of {self.problem.name!r}: {len(self.nodes)} nodes, load cases {', '.join(self.cases)}>"


class Modes:
    """The lowest modes of structures of n nodes."""

    frequencies: Array
    """Natural frequencies in Hz, ascending, without those of rigid motions."""
    shapes: Array
    """Displacements of the nodes in each mode for a modal mass of one, shape (number of modes, n, 3)."""
    rigid: int
    """Number of rigid motions, whose frequencies are zero."""

    def __init__(self, frequencies: Array, shapes: list[Array], rigid: int) -> None:
        self.frequencies = frequencies
        self.shapes = np.array(shapes)
        self.rigid = rigid

    def __len__(self) -> int:
        return len(self.frequencies)

    def __repr__(self) -> str:
        return f"<Modes: {', '.join(f'{f:.6g}' for f in self.frequencies)} Hz, {self.rigid} rigid motions>"


@dataclass(frozen=True)
class State:
    """State of a body at an instant, in ground axes."""

    position: Array
    """Centre of mass in m, shape (3,)."""
    orientation: Array
    """Euler parameters from body axes to ground axes, the real part first, shape (4,)."""
    velocity: Array
    """In m/s, shape (3,)."""
    angular_velocity: Array
    """In rad/s, shape (3,)."""
    elastic: Array
    """Elastic coordinates of a flexible body, empty of a rigid one."""
