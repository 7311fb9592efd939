"""Motions: states, energies, reactions, histories, and the exact derivatives of functions of histories."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _flexbody

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["Body", "Elastic", "Energy", "Histories", "Reaction", "Response"]

Array = NDArray[np.float64]

TIME = "time"
"""The key of the instants among cotangents."""


@dataclass(frozen=True)
class Body:
    """States of a body at n_t instants, in ground axes; of a flexible body those of its frame."""

    position: Array
    """Centre of mass in m, shape (n_t, 3)."""
    orientation: Array
    """Euler parameters of the rotation from body axes to ground axes, the real part first, shape (n_t, 4)."""
    velocity: Array
    """Velocity of the centre of mass in m/s, shape (n_t, 3)."""
    angular_velocity: Array
    """Angular velocity in rad/s, shape (n_t, 3)."""


@dataclass(frozen=True)
class Elastic:
    """Elastic coordinates of a flexible body with m shapes at n_t instants."""

    coordinates: Array
    """Shape (n_t, m)."""
    rates: Array
    """Their rates in 1/s, shape (n_t, m)."""


@dataclass(frozen=True)
class Reaction:
    """Force and torque of a joint on its first body that is not ground, at the joint's point, in ground axes."""

    force: Array
    """In N, shape (n_t, 3)."""
    torque: Array
    """About the joint's point in N m, shape (n_t, 3)."""


@dataclass(frozen=True)
class Energy:
    """Energies and momenta of all bodies at n_t instants."""

    kinetic: Array
    """In J, shape (n_t,)."""
    potential: Array
    """Of gravity, springs and strains in J, shape (n_t,)."""
    momentum: Array
    """In kg m/s, ground axes, shape (n_t, 3)."""
    angular_momentum: Array
    """About the origin in kg m²/s, ground axes, shape (n_t, 3)."""


class Histories(Mapping[str, Array]):
    """By function: the quantity behind it at every instant, shape (n_t,). Functions that reduce no quantity, such as a
    duration or a mass, have none."""

    def __init__(self, core: _flexbody.Motion, names: Sequence[str]) -> None:
        self._core = core
        self._names = names
        self._known: dict[str, tuple[Array, float] | None] = {}

    def _find(self, name: str) -> tuple[Array, float] | None:
        if name not in self._names:
            return None
        if name not in self._known:
            self._known[name] = self._core.history(self._names.index(name))
        return self._known[name]

    def __getitem__(self, name: str) -> Array:
        found = self._find(name)
        if found is None:
            there = ", ".join(self) or "none"
            raise KeyError(f"found no history of {name!r}, expected one of: {there}")
        return found[0]

    def error(self, name: str) -> float:
        """Largest estimated error of a history by the polynomials between samples; zero at samples."""
        self[name]
        found = self._find(name)
        return 0.0 if found is None else found[1]

    def __iter__(self) -> Iterator[str]:
        return (name for name in self._names if self._find(name) is not None)

    def __len__(self) -> int:
        return sum(1 for _ in self)


class Response:
    """The motion of a design at n_t instants."""

    problem: Problem
    """The problem."""
    times: Array
    """Instants in s, shape (n_t,)."""
    histories: Histories
    """By function: the quantity behind it at every instant, shape (n_t,)."""

    def __init__(self, problem: Problem, core: _flexbody.Motion) -> None:
        self.problem = problem
        self._core = core
        self.times = core.times()
        self.histories = Histories(core, problem.functions.names)

    @property
    def duration(self) -> float:
        """End of the motion in s."""
        return self._core.duration

    @property
    def method(self) -> str:
        """Name of the integration method."""
        return self._core.method

    @property
    def work(self) -> dict[str, int]:
        """Counts of the simulation, which do not depend on the machine."""
        names = ("steps", "rejected", "evaluations", "newton_iterations", "factorisations")
        return dict(zip(names, self._core.work, strict=True))

    @cached_property
    def values(self) -> Array:
        """Values of the functions, shape (n_f,)."""
        return self._core.values()

    @cached_property
    def gradients(self) -> Array:
        """Exact derivatives of the functions on the steps of this motion, shape (n_f, n_x)."""
        return self._core.gradients()

    def history_error(self, name: str) -> float:
        """Largest estimated error of a history by the polynomials between samples; zero at samples."""
        return self.histories.error(name)

    @cached_property
    def body_names(self) -> list[str]:
        """Names of the bodies."""
        return self._core.bodies()

    @cached_property
    def joint_names(self) -> list[str]:
        """Names of the joints."""
        return self._core.joints()

    def body(self, name: str) -> Body:
        """States of a body."""
        found = self._core.states(name)
        if found is None:
            raise KeyError(f"found no body {name!r}, expected one of: {', '.join(self.body_names)}")
        return Body(*found)

    @cached_property
    def bodies(self) -> dict[str, Body]:
        """States of all bodies."""
        return {name: self.body(name) for name in self.body_names}

    def elastic(self, name: str) -> Elastic:
        """Elastic coordinates of a flexible body with shapes (a modal body or a beam in motion)."""
        found = self._core.elastic(name)
        if found is None:
            there = ", ".join(self._core.flexible_bodies()) or "none"
            raise KeyError(f"found no elastic coordinates of {name!r}, expected one of: {there}")
        return Elastic(*found)

    def reaction(self, joint: str) -> Reaction:
        """Force and torque of a joint."""
        found = self._core.reactions(joint)
        if found is None:
            raise KeyError(f"found no joint {joint!r}, expected one of: {', '.join(self.joint_names)}")
        return Reaction(*found)

    @cached_property
    def energy(self) -> Energy:
        """Energies and momenta."""
        (kinetic, potential), (momentum, angular) = self._core.energies()
        return Energy(kinetic, potential, momentum, angular)

    @cached_property
    def stresses(self) -> dict[str, Array]:
        """By body: the largest stress in Pa, shape (n_t,): von Mises stress of shells, largest stress along the fibres
        of beams. Bodies whose stresses are not known are left out."""
        return dict(self._core.stresses())

    @cached_property
    def drift(self) -> dict[str, float]:
        """Largest change of the energy in J (the error of the run where nothing does work), and largest violation of the
        constraints on positions and on velocities."""
        return dict(zip(("energy", "position", "velocity"), self._core.drift(), strict=True))

    def pull_back(self, cotangents: Mapping[str, ArrayLike]) -> Array:
        """The derivative of any function F of the histories by the design, from its derivatives by the histories.

        Parameters
        ----------
        cotangents
            By function of the file: ∂F/∂g(t_k) of the quantity g behind it, shape (n_t,). Instants of `at` are fixed.
            Others keep their fraction of the duration: where that depends on the design, the key `"time"` (unless a
            function has this name) has the derivatives by the instants themselves.

        Returns
        -------
        array of shape (n_x,)
            dF/dx, exact for the time steps, by one backward march of the discrete adjoint.
        """
        row: Array = self.pull_back_all([cotangents])[0]
        return row

    def pull_back_all(self, cotangents: Sequence[Mapping[str, ArrayLike]]) -> Array:
        """As `pull_back`, of several functions in one backward march, shape (number of functions, n_x)."""
        return self._core.pull_back([self._weights(own) for own in cotangents])

    def _weights(self, cotangents: Mapping[str, ArrayLike]) -> tuple[list[tuple[int, Array]], Array | None]:
        names = self.problem.functions.names
        functions, times = [], None
        for name, given in cotangents.items():
            array = np.asarray(given)
            if array.dtype.kind not in "iuf" or array.shape != self.times.shape:
                what = f"{array.dtype} of shape {array.shape}"
                raise ValueError(f"found the cotangent {what} of {name!r}, expected numbers of shape {self.times.shape}")
            weights = np.ascontiguousarray(array, dtype=np.float64)
            if not np.isfinite(weights).all():
                raise ValueError(f"found a cotangent of {name!r} that is not finite")
            if name in names:
                functions.append((names.index(name), weights))
            elif name == TIME:
                times = weights
            else:
                there = ", ".join(self.histories)
                raise KeyError(f"found no history of {name!r}, expected one of: {there}, {TIME}")
        return functions, times

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` with a row per instant: the histories, then positions, orientations and velocities of
        all bodies."""
        from .tables import frame

        columns: dict[str, Array] = dict(self.histories)
        for name, body in self.bodies.items():
            for what, values, axes in (
                ("position", body.position, "xyz"),
                ("p", body.orientation, "0123"),
                ("velocity", body.velocity, "xyz"),
                ("angular velocity", body.angular_velocity, "xyz"),
            ):
                for k, axis in enumerate(axes):
                    column = f"{name}: {what}{'' if what == 'p' else ' '}{axis}"
                    # A function may have this name.
                    columns[f"body {column}" if column in columns else column] = values[:, k]
        return frame(columns, ("time [s]", self.times))

    def __repr__(self) -> str:
        steps = self.work["steps"]
        return f"<Response of {self.problem.name!r}: {self.duration:g} s in {steps} steps by {self.method}>"
