"""What every piece of a scene that is built in Python has in common: its keys and the call that made it."""

from __future__ import annotations

import copy
import difflib
import functools
import inspect
import json
import math
import numbers
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ParamSpec, TypeAlias, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

Real: TypeAlias = Union[float, "np.floating[Any]", "np.integer[Any]", str]
"""A finite number, or an expression of the machine's parameters such as `"= L/2"`."""
Integer: TypeAlias = Union[int, "np.integer[Any]", str]
"""A whole number, or an expression of parameters."""
Vector: TypeAlias = Union[Sequence[Real], NDArray[Any]]
"""Finite numbers in a list, a tuple or an array of one dimension."""
Matrix: TypeAlias = Union[Sequence[Vector], NDArray[Any]]
"""Rows of finite numbers."""

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T", bound="Part")
D = TypeVar("D", bound="Document")

PACKAGE = os.path.dirname(os.path.abspath(__file__)) + os.sep


@dataclass(frozen=True)
class Call:
    """A call in the user's code: what was called, in which file and line."""

    what: str
    file: str
    line: int

    @staticmethod
    def here(what: str) -> Call:
        """The call by which the user's code came into this package."""
        frame = sys._getframe(1)
        while frame.f_back is not None and frame.f_code.co_filename.startswith(PACKAGE):
            frame = frame.f_back
        return Call(what, frame.f_code.co_filename, frame.f_lineno)

    @property
    def place(self) -> str:
        """File and line, as in `chain.py:12`."""
        file = self.file
        if "IPython" in sys.modules:
            from IPython import get_ipython  # type: ignore[import-not-found, attr-defined, unused-ignore]

            shell = get_ipython()  # type: ignore[no-untyped-call, unused-ignore]
            cell = shell and getattr(shell.compile, "format_code_name", lambda _: None)(file)
            if cell:
                return f"{' '.join(cell)}, line {self.line}"
        here = os.getcwd() + os.sep
        return f"{file.removeprefix(here)}:{self.line}"

    def __str__(self) -> str:
        return f"{self.what} at {self.place}"


class Part(dict[str, Any]):
    """A piece of a problem file: a dictionary of its keys that remembers the call that made it.

    A piece of a file can be given as it is: `Joint({"spherical": {"between": ["arm", "ground"], "at": [0, 0, 0]}})`.
    """

    __slots__ = ("call",)
    call: Call

    def __init__(self, document: Mapping[str, Any], call: Call | None = None) -> None:
        self.call = call or Call.here(f"{type(self).__name__}(…)")
        super().__init__((key, plain(value, self.call, key)) for key, value in document.items())

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (dict(self), self.call))


class Name(str):
    """The name of what was added to a machine: a string, that also knows where it stands in the problem file."""

    __slots__ = ("_path",)
    _path: Callable[..., str]

    def __new__(cls, name: str, path: Callable[..., str]) -> Name:
        self = super().__new__(cls, name)
        self._path = path
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return (str, (str(self),))

    def path(self, *keys: str | int) -> str:
        """JSON Pointer to one of its numbers, for a design variable: `arm.path("shape", "box", "size", 0)`."""
        return self._path(*keys)


class BodyName(Name):
    """The name of a body of a machine."""

    __slots__ = ()

    def point(self, name: str) -> str:
        """The name of one of its points where a place in space is expected: `"arm.tip"`."""
        return f"{self}.{name}"


def wrong(kind: type[Exception], text: str, call: Call) -> Exception:
    """An exception that names the call."""
    error = kind(f"{text}\n  in {call}")
    error.__dict__["call"] = call
    return error


def plain(value: object, call: Call, where: str) -> Any:
    """The value as JSON holds it. NumPy's arrays and numbers become lists and numbers."""
    if isinstance(value, Part):
        return type(value)(value, value.call)
    if isinstance(value, str):
        try:
            value.encode()
        except UnicodeEncodeError:
            raise wrong(ValueError, f"{where} is {value!r}, which is not valid Unicode", call) from None
        return str(value)
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real):
        number = float(value)
        if not math.isfinite(number):
            raise wrong(ValueError, f"{where} is {number}, expected a finite number", call)
        return number
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise wrong(TypeError, f"{where} has the key {key!r}, expected a name (str)", call)
        return {str(key): plain(item, call, f"{where}[{quoted(key)}]") for key, item in value.items()}
    if hasattr(value, "__array__") and (array := np.asarray(value)).dtype.kind in "biufU":
        return plain(array.tolist(), call, where)
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray, memoryview)):
        return [plain(item, call, f"{where}[{index}]") for index, item in enumerate(value)]
    hint = "; leave it out" if value is None else ""
    found = "None" if value is None else f"of type {type(value).__name__}"
    raise wrong(
        TypeError, f"{where} is {found}, expected a number, text, list, mapping or another part of a scene{hint}", call
    )


def keys(values: Mapping[str, object], *without: str) -> dict[str, object]:
    """The arguments of a call by the keys of the file: without those left out, and `from_` as `from`."""
    return {
        name.removesuffix("_"): value
        for name, value in values.items()
        if value is not None and name != "self" and name not in without
    }


def made(cls: type[T], what: str, values: Mapping[str, object]) -> T:
    """The part that a call `what(**values)` makes. What stands behind a dot is the key of a kind."""
    call = Call.here(f"{what}(…)")
    document = Part(keys(values), call)
    _, dot, kind = what.partition(".")
    return cls({kind: dict(document)} if dot else document, call)


def made_of(cls: type[T], what: str, value: object) -> T:
    """The part that a call `namespace.kind(value)` makes."""
    call = Call.here(f"{what}(…)")
    kind = what.partition(".")[2]
    return cls({kind: plain(value, call, "the argument")}, call)


def quoted(value: object) -> str:
    """How a name or number is written in a call."""
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


def choice(name: str, names: Sequence[str]) -> str:
    """`; did you mean "…"?`, or all names."""
    found = difflib.get_close_matches(name, names, n=1)
    return f"; did you mean {quoted(found[0])}?" if found else f"; it has {listed(names)}"


def listed(names: Sequence[str]) -> str:
    return ", ".join(map(quoted, names))


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Says in words which arguments of a call are unknown, missing or too many."""
    every = inspect.signature(function).parameters
    parameters = [item for item in every.values() if item.name != "self"]
    unnamed = len(every) - len(parameters)
    by_name = [item.name for item in parameters if item.kind is not item.POSITIONAL_ONLY]
    by_place = [item.name for item in parameters if item.kind is not item.KEYWORD_ONLY]
    needed = [item.name for item in parameters if item.default is item.empty]
    name = function.__qualname__.removeprefix("MachineKeys.").replace("__init__", "Machine")

    def fault(args: tuple[object, ...], kwargs: Mapping[str, object]) -> str | None:
        if len(args) > len(by_place) and len(by_name) > len(by_place):
            rest = f"all arguments but {listed(by_place)}" if by_place else "its arguments"
            return f"takes {rest} by name, as in {name}({by_name[len(by_place)]}=…)"
        if len(args) > len(by_place):
            return f"takes {listed(by_place)} alone" if by_name else "takes one value"
        for key in kwargs:
            if key not in by_name:
                return f"has no argument {quoted(key)}{choice(key, by_name)}" if by_name else "takes one value without name"
        missing = [item for item in needed if item not in by_place[: len(args)] and item not in kwargs]
        if missing:
            return f"needs {listed(missing)}" if by_name else "needs a value"
        return None

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        if text := fault(args[unnamed:], kwargs):
            raise wrong(TypeError, f"{name}(…) {text}", Call.here(f"{name}(…)"))
        try:
            return function(*args, **kwargs)
        except Exception as error:
            if "call" in error.__dict__:  # the user's fault: no need to show the way here
                error.__traceback__ = None
            raise

    return wrapper


class KindsType(type):
    """The type of collections of kinds: a misspelt kind gets a hint."""

    if not TYPE_CHECKING:

        def __getattr__(cls, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            kinds = [kind for kind in vars(cls) if not kind.startswith("_")]
            text = f"{cls.__name__} has no kind {quoted(name)}{choice(name, kinds)}"
            raise wrong(AttributeError, text, Call.here(f"{cls.__name__}.{name}"))


class Kinds(metaclass=KindsType):
    """The kinds of something, one function for each."""

    __slots__ = ()


class Document:
    """A problem file that grows by calls."""

    _order: tuple[str, ...] = ()

    def _begin(self, values: Mapping[str, object]) -> None:
        call = Call.here(f"Machine({quoted(values['name'])}, …)")
        given = {"version": 1, **keys(values)}
        if "schema" in given:
            given["$schema"] = given.pop("schema")
        self._document = Part(given, call)
        self._calls: dict[tuple[str, ...], Call] = {}
        check_name(values["name"], "the name of the machine", call)

    def __copy__(self: D) -> D:
        """A document of its own: what is added to one is not in the other."""
        return copy.deepcopy(self)

    def _add(self, key: str, what: str, name: object, value: object) -> Callable[..., str]:
        """Puts the value under a new name of the map at the key."""
        call = Call.here(f"add_{what}({quoted(name)}, …)")
        thing = what.replace("_", " ")
        check_name(name, f"the name of a {thing}", call)
        name = str(name)
        entries = self._document.setdefault(key, {})
        if name in entries:
            raise wrong(ValueError, f"there is a {thing} {quoted(name)} already, made by {self._calls[key, name]}", call)
        if isinstance(value, Part):
            entries[name] = plain(value, call, name)
        elif isinstance(value, Mapping):
            entries[name] = Part(value, call)
        else:
            entries[name] = plain(value, call, f"the {thing}")
        self._calls[key, name] = call
        return functools.partial(self.path, key, name)

    def _set(self, key: str, what: str, values: Mapping[str, object]) -> None:
        """Puts the value at the key of the file. What was there is replaced."""
        call = Call.here(f"{what}(…)")
        self._document[key] = Part(keys(values), call)
        self._calls[key,] = call

    def path(self, *keys: str | int) -> str:
        """JSON Pointer to a place in the problem file, for a design variable: `machine.path("gravity", 1)`.

        What it points to has to exist: a variable starts at the number in the file.
        """
        node: Any = self._document
        done = ""
        for key in keys:
            entries = list(map(str, range(len(node)) if isinstance(node, list) else node)) if isinstance(
                node, (dict, list)
            ) else []
            if str(key) not in entries:
                call = Call.here(f"path({', '.join(map(quoted, keys))})")
                name = f"{done} has" if done else "the machine has"
                if isinstance(node, list):
                    text = f"{name} {len(node)} entries, counted from 0, no entry {key!r}"
                elif entries:
                    text = f"{name} no {quoted(key)} yet{choice(str(key), entries)}"
                else:
                    text = f"{done or 'the machine'} is {json.dumps(node, ensure_ascii=False)} and has no {quoted(key)}"
                raise wrong(ValueError, text, call)
            node = node[int(key)] if isinstance(node, list) else node[str(key)]
            done += "/" + str(key).replace("~", "~0").replace("/", "~1")
        return done

    def made_by(self, path: str) -> str | None:
        """The calls that made what is at a JSON Pointer, in words: `add_joint("hinge", …) at chain.py:12`."""
        steps = [step.replace("~1", "/").replace("~0", "~") for step in path.split("/")[1:]]
        node: Any = self._document
        part = self._document.call
        added: Call | None = None
        for depth, step in enumerate(steps):
            try:
                node = node[int(step)] if isinstance(node, list) else node[step]
            except (KeyError, IndexError, TypeError, ValueError):
                break
            added = self._calls.get(tuple(steps[: depth + 1]), added)
            if isinstance(node, Part):
                part = node.call
        if added is None:
            return str(part)
        if (part.file, part.line) == (added.file, added.line) or part is self._document.call:
            return str(added)
        return f"{part}, in {added}"


def check_name(name: object, what: str, call: Call) -> None:
    if not isinstance(name, str):
        raise wrong(TypeError, f"{what} is of type {type(name).__name__}, expected text (str)", call)
