"""Names of a problem file as identifiers of other programs, and lists of numbered names as arrays."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

_NUMBERED = re.compile(r"^(?P<base>.*)\[(?P<number>\d+)\]$")


@dataclass
class Group:
    """Entries of a list that one identifier stands for."""

    identifier: str
    """What the other program calls them."""
    name: str
    """What the problem file calls them, without a number."""
    positions: list[int] = field(default_factory=list)
    """Where they are in the list."""


def identifier(name: str, taken: Iterable[str] = ()) -> str:
    """A name of Latin letters, digits and underscores that begins with a letter and is none of those `taken`.

    Greek letters are spelt out, accents dropped, and all else becomes an underscore.
    """
    letters = []
    for letter in unicodedata.normalize("NFKD", name):
        if unicodedata.combining(letter):
            continue
        if letter.isascii():
            letters.append(letter)
        else:
            words = unicodedata.name(letter, "").split()
            letters.append(words[-1].lower() if "LETTER" in words else "_")
    plain = re.sub(r"[^0-9A-Za-z]+", "_", "".join(letters)).strip("_") or "value"
    if not plain[0].isalpha():
        plain = f"n{plain}"
    taken = set(taken)
    found, count = plain, 1
    while found in taken:
        count += 1
        found = f"{plain}_{count}"
    return found


def groups(names: Sequence[str], taken: Iterable[str] = (), together: bool = True) -> list[Group]:
    """Identifiers for `names`. With `together`, `name[0]`, `name[1]`, … in succession share one."""
    used = set(taken)
    found: list[Group] = []
    for position, name in enumerate(names):
        match = _NUMBERED.match(name) if together else None
        base = match["base"] if match else name
        last = found[-1] if found else None
        if match and last and last.name == base and int(match["number"]) == len(last.positions):
            last.positions.append(position)
            continue
        new = Group(identifier(base, used), base, [position])
        if match and int(match["number"]) != 0:
            new = Group(identifier(name, used), name, [position])
        used.add(new.identifier)
        found.append(new)
    return found
