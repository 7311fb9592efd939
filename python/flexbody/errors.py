"""The exceptions of flexbody."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Fault", "FlexbodyError", "InternalError", "ProblemError", "SimulationError"]


class FlexbodyError(Exception):
    """What all exceptions of flexbody have in common."""


@dataclass
class Fault:
    """A fault of a problem file."""

    path: str
    """JSON Pointer to the faulty entry; empty for the whole document."""
    line: int
    """Line in the file from 1; 0 if the fault has no place in a file."""
    column: int
    """Column in characters from 1; 0 if the fault has no place in a file."""
    found: str
    """What was found."""
    expected: str
    """What was expected."""
    hint: str | None
    """Advice, such as the nearest valid name."""
    message: str
    """The whole as text."""


_Row = tuple[tuple[str, int, int], tuple[str, str], "str | None", str]


class ProblemError(FlexbodyError, ValueError):
    """A problem file, or a document, with faults: all of them are in `faults`."""

    faults: list[Fault]

    def __init__(self, faults: Sequence[_Row] | str) -> None:
        if isinstance(faults, str):
            self.faults = []
            super().__init__(faults)
            return
        # A change of one run has the name of its argument here.
        self.faults = [
            Fault(*place, *what, hint, message.replace("--set ", "set ", 1)) for place, what, hint, message in faults
        ]
        super().__init__("\n".join(fault.message for fault in self.faults))

    def without_lines(self) -> ProblemError:
        """The same faults of a document that has no lines."""
        for fault in self.faults:
            hint = f"; {fault.hint}" if fault.hint else ""
            place = f"{fault.path}: " if fault.path else ""
            fault.message = f"{place}found {fault.found}, expected {fault.expected}{hint}"
            fault.line = fault.column = 0
        self.args = ("\n".join(fault.message for fault in self.faults),)
        return self


class SimulationError(FlexbodyError, RuntimeError):
    """A design without values or without gradients: its joints cannot be closed, its motion cannot be integrated, or a
    value is not finite. An optimisation backs off from such a design."""


class InternalError(FlexbodyError):
    """A bug of flexbody: please report it with the problem."""
