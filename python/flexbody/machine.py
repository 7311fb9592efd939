"""Scenes built in Python: the same problem files, by calls."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .parts import MachineKeys

if TYPE_CHECKING:
    from .errors import ProblemError
    from .problem import Problem

__all__ = ["Machine"]

WIDTH = 110


class Machine(MachineKeys):
    """A scene, or structures, built by calls. It writes the same document as a problem file.

    ```python
    from flexbody import Machine
    from flexbody.parts import functions, joints, place, quantities, shapes

    machine = Machine("pendulum")
    arm = machine.add_body("arm", shape=shapes.rod(length=1), mass=2, points={"pin": [-0.5, 0, 0]},
                           place=place(put="pin"))
    machine.add_joint("pin", joints.revolute(between=[arm, "ground"], at=arm.point("pin"), axis=[0, 0, 1]))
    machine.set_simulation(duration=1)
    machine.add_function("speed", functions.final(quantities.speed(body=arm)))
    machine.add_variable("mass", path=arm.path("mass"), lower=1, upper=4)
    problem = machine.problem()
    ```

    What is added has a name, which the call returns. Faults of the scene name the calls that made them.
    Faults that need no scene, such as names that exist already or numbers that are not finite, are refused at the call.
    """

    def to_dict(self) -> dict[str, Any]:
        """The document as JSON has it, in the order of the schema."""
        document = {key: self._document[key] for key in self._order if key in self._document}
        return {key: bare(value) for key, value in document.items()}

    def to_json(self) -> str:
        """Text of the problem file."""
        return text(self.to_dict()) + "\n"

    def to_file(self, path: str | os.PathLike[str]) -> None:
        """Writes the problem file, whole or not at all."""
        write(path, self.to_json())

    def problem(
        self, *, directory: str | os.PathLike[str] | None = None, set: Mapping[str, object] | None = None
    ) -> Problem:
        """The problem, ready to be simulated and optimised.

        Parameters
        ----------
        directory : path, optional
            Where files that the scene names are, default the working directory.
        set : values by JSON Pointer, optional
            One-off changes, such as `{"/gravity/1": -1.62}`.

        Raises
        ------
        ProblemError
            All faults of the scene, each with the call that made it.
        """
        from .errors import ProblemError
        from .problem import Problem

        try:
            return Problem.from_dict(self.to_dict(), directory=directory, set=set)
        except ProblemError as error:
            self._name_calls(error)
            raise

    def _name_calls(self, error: ProblemError) -> None:
        """Adds to each fault the calls that made what is faulty."""
        whole, end = str(error), 0
        for fault in error.faults:
            call = self.made_by(fault.path)
            message = f"{fault.message}\n  made by {call}"
            found = whole.find(fault.message, end)
            if found >= 0:
                whole = whole[:found] + message + whole[found + len(fault.message) :]
                end = found + len(message)
            fault.message = message
        error.args = (whole, *error.args[1:])

    def __repr__(self) -> str:
        maps = dict.fromkeys(call[0] for call in self._calls if len(call) == 2)
        counts = [f"{len(self._document[key])} {key.replace('_', ' ')}" for key in self._order if key in maps]
        return f"<Machine {self._document['name']!r}: {', '.join(counts) or 'empty'}>"


def write(path: str | os.PathLike[str], content: str) -> None:
    """Writes a text file, whole or not at all."""
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        temporary.write_text(content, encoding="utf-8")
        os.replace(temporary, target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def bare(value: Any) -> Any:
    """A copy without the calls."""
    if isinstance(value, dict):
        return {key: bare(item) for key, item in value.items()}
    return [bare(item) for item in value] if isinstance(value, list) else value


def text(value: Any, depth: int = 0, taken: int = 0) -> str:
    """JSON with short values on one line."""
    line = json.dumps(value, ensure_ascii=False, allow_nan=False)
    inner = isinstance(value, (dict, list)) and value
    if depth > 0 and len(line) + 2 * depth + taken <= WIDTH or not inner:
        return line
    space = "  " * (depth + 1)
    if isinstance(value, dict):
        keys = [json.dumps(key, ensure_ascii=False) + ": " for key in value]
        items = [key + text(item, depth + 1, len(key)) for key, item in zip(keys, value.values(), strict=True)]
    else:
        items = [text(item, depth + 1) for item in value]
    left, right = "{}" if isinstance(value, dict) else "[]"
    return f"{left}\n{space}" + f",\n{space}".join(items) + f"\n{space[2:]}{right}"
