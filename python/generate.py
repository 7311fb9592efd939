"""Writes `flexbody/parts.py` from the JSON Schema of problem files.

    python generate.py ../target/release/optimize      # runs `optimize schema`
    optimize schema | python generate.py -             # reads the schema
    python generate.py --print …                       # to standard output instead
"""

from __future__ import annotations

import json
import keyword
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

Schema = dict[str, Any]

TARGET = Path(__file__).parent / "flexbody" / "parts.py"
WIDTH = 118

# Names in Python where those of the schema do not read well.
CLASSES = {
    "Instant": "Quantity",
    "Section2": "StructureSection",
    "GivenSection2": "GivenStructureSection",
    "Held": "HeldMotion",
    "Held2": "HeldPlace",
    "Start": "StartOfMotion",
    "Start2": "FirstSteps",
    "Part": "PartOfMachine",
    "Mass": "NodeMass",
    "Energy": "EnergyKind",
    "Functions": "BendingFunctions",
    "Modes": "BeamModes",
    "Frame": "BeamFrame",
    "Strain": "BeamStrain",
}
COLLECTIONS = {"Turning": "turning", "Sliding": "sliding", "ElementBasis": "element_bases"}
HANDLES = {"bodies": "BodyName"}

HEAD = '''\
"""The parts of a scene, with their keys, units and descriptions.

Made by `optimize schema | python generate.py -` from the schema of problem files: do not edit.

Functions make parts: `place(put="pin", at=[0, 0, 0])`. Where there is a choice of kinds, a collection has a function for
each: `joints.revolute(…)`, `shapes.box(…)`. Units are SI, angles are in radians. Lists of numbers may be arrays of NumPy.
A part is a dictionary of its keys, as in the problem file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Literal, TypeAlias, Union

from ._part import (
    BodyName,
    Document,
    Integer,
    Kinds,
    Matrix,
    Name,
    Part,
    Real,
    Vector,
    checked,
    keys,
    made,
    made_of,
)
'''


def snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def plural(name: str) -> str:
    if name.endswith("y"):
        return name[:-1] + "ies"
    return name + ("es" if name.endswith(("s", "sh", "x")) else "s")


def singular(name: str) -> str:
    return name[:-3] + "y" if name.endswith("ies") else name.removesuffix("s")


def argument(key: str) -> str:
    key = key.lstrip("$")
    return key + "_" if keyword.iskeyword(key) else key


class Generator:
    def __init__(self, schema: Schema) -> None:
        self.schema = schema
        self.definitions: dict[str, Schema] = schema["$defs"]
        self.used: list[str] = []  # definitions that are values, in the order of the schema

    # What a schema is.

    def of(self, schema: Schema) -> tuple[str | None, Schema]:
        """Name and content of the definition that is referred to."""
        reference = schema.get("$ref")
        if reference is None:
            return None, schema
        name = reference.removeprefix("#/$defs/")
        return name, self.definitions[name]

    @staticmethod
    def is_object(schema: Schema) -> bool:
        return "properties" in schema and "oneOf" not in schema

    @staticmethod
    def constants(schema: Schema) -> dict[str, str]:
        return {kind["const"]: kind.get("description", "") for kind in schema.get("oneOf", []) if "const" in kind}

    @staticmethod
    def kinds(schema: Schema) -> dict[str, tuple[Schema, str]]:
        """Content and description of the kinds with keys."""
        return {
            key: (content, kind.get("description", ""))
            for kind in schema.get("oneOf", [])
            if "properties" in kind
            for key, content in kind["properties"].items()
        }

    def is_enumeration(self, schema: Schema) -> bool:
        return bool(self.constants(schema)) and not self.kinds(schema)

    @staticmethod
    def cls(name: str) -> str:
        return CLASSES.get(name, name)

    def collection(self, name: str) -> str:
        return COLLECTIONS.get(name) or plural(snake(self.cls(name)))

    # Which definitions are values of arguments.

    def visit(self, schema: Schema, flat: bool = False) -> None:
        name, content = self.of(schema)
        if name is not None and not flat:
            if name in self.used:
                return
            self.used.append(name)
        for item in content.get("properties", {}).values():
            self.visit(item)
        for option in content.get("anyOf", []):
            self.visit(option)
        for payload, _ in self.kinds(content).values():
            self.visit(payload, flat=self.is_object(self.of(payload)[1]))
        for key in ("items", "additionalProperties"):
            if isinstance(content.get(key), dict):
                self.visit(content[key])

    # How Python writes it.

    def type(self, schema: Schema) -> str:
        name, content = self.of(schema)
        if name is not None:
            constants = self.constants(content)
            if constants and self.kinds(content):
                return f"{self.cls(name)} | Literal[{', '.join(map(quoted, constants))}]"
            return self.cls(name)
        match content.get("type"):
            case "number":
                return "Real"
            case "integer":
                return "Integer"
            case "string":
                return "str"
            case "boolean":
                return "bool"
            case "array":
                match (inner := self.type(content["items"])):
                    case "Real" | "Integer":
                        return "Vector"
                    case "Vector":
                        return "Matrix"
                return f"Sequence[{inner}]"
            case "object":
                inner = content["additionalProperties"]
                return f"Mapping[str, {'object' if inner is True else self.type(inner)}]"
        if "anyOf" in content:
            return " | ".join(self.type(option) for option in content["anyOf"])
        raise SystemExit(f"cannot write the type of {schema}")

    def words(self, schema: Schema) -> str:
        """What the value is, in words: kind, shape, limits, unit."""
        name, content = self.of(schema)
        if self.is_enumeration(content):
            return " or ".join(map(quoted, self.constants(content)))
        if "oneOf" in content:
            assert name is not None
            return " or ".join([f"one of `{self.collection(name)}`", *map(quoted, self.constants(content))])
        if "anyOf" in content:
            return " or ".join(self.words(option) for option in content["anyOf"])
        if name is not None:
            return f"`{snake(self.cls(name))}(…)`"
        match content.get("type"):
            case "number":
                return "number" + limits(content) + unit(content)
            case "integer":
                return "integer" + limits(content)
            case "string":
                return "text"
            case "boolean":
                return "bool"
            case "array":
                size = str(content.get("minItems")) if content.get("minItems") == content.get("maxItems") else "n"
                size = "n" if size == "None" else size
                items = self.of(content["items"])[1]
                shape = f"({size},)"
                if items.get("type") == "array" and "minItems" in items:
                    shape, items = f"({size}, {items['minItems']})", items["items"]
                if items.get("type") in ("number", "integer"):
                    whole = "integers" if items["type"] == "integer" else "numbers"
                    return f"{whole}, shape {shape}{limits(items)}{unit(items)}"
                words = self.words(content["items"])
                words = "texts" if words == "text" else words
                return f"list of {size + ' ' if size != 'n' else ''}{words}"
            case "object":
                inner = content["additionalProperties"]
                return f"{'any values' if inner is True else self.words(inner)} by name"
        raise SystemExit(f"cannot describe {schema}")

    def documentation(self, text: str, properties: dict[str, Schema], required: list[str], extra: str = "") -> str:
        """Text of a docstring."""
        lines = [*fill(clean(text), 0)]
        if extra:
            lines += ["", *fill(extra, 0)]
        if properties:
            lines += ["", "Parameters", "----------"]
        for key in ordered(properties, required):
            item = properties[key]
            content = self.of(item)[1]
            optional = "" if key in required else ", optional"
            lines += fill(f"{argument(key)} : {self.words(item)}{optional}", 0, 8)
            lines += fill(clean(item.get("description") or content.get("description", "")), 4)
            if self.is_enumeration(content):
                for value, meaning in self.constants(content).items():
                    lines += fill(f"{quoted(value)}: {clean(meaning)}", 4, 8)
            for option in content.get("anyOf", []):
                if "description" in option:
                    lines += fill(f"{self.words(option)}: {clean(option['description'])}", 4, 8)
        return "\n".join(lines)

    def signature(self, properties: dict[str, Schema], required: list[str]) -> list[str]:
        lines = []
        for key in ordered(properties, required):
            kind = self.type(properties[key])
            lines.append(f"{argument(key)}: {kind}" if key in required else f"{argument(key)}: {kind} | None = None")
        return lines

    def function(
        self, name: str, first: list[str], arguments: list[str], result: str, text: str, body: str, depth: int
    ) -> str:
        arguments = first + (["*"] if arguments else []) + arguments
        method = "" if not first or first[0] != "self" else "self"
        line = f"def {name}({', '.join(arguments)}) -> {result}:"
        if len(line) + depth > WIDTH:
            inside = "".join(f"    {item},\n" for item in arguments)
            line = f"def {name}(\n{inside}) -> {result}:"
        decorators = ["@checked"] if depth == 0 or method else ["@staticmethod", "@checked"]
        return indent("\n".join([*decorators, line, indent(docstring(text), 4), indent(body, 4)]), depth)

    # The parts of the file.

    def write(self) -> str:
        top: dict[str, Schema] = self.schema["properties"]
        for key, item in top.items():
            if key == "objective":
                continue
            entry = item.get("additionalProperties")
            if isinstance(entry, dict):
                name, content = self.of(entry)
                self.visit(entry, flat=name is None or self.is_object(content))
            else:
                self.visit(item, flat=self.is_object(self.of(item)[1]))
        names = [name for name in self.definitions if name in self.used]
        classes: list[str] = []
        aliases: list[str] = []
        functions: list[str] = []
        collections: list[str] = []
        for name in names:
            content = self.definitions[name]
            if "anyOf" in content or self.is_enumeration(content):
                continue
            if self.kinds(content):
                classes.append(self.part(name, f"Made by `{self.collection(name)}`."))
                collections.append(self.kinds_of(name))
            else:
                classes.append(self.part(name, f"Made by `{snake(self.cls(name))}`."))
                functions.append(self.object(name))
        done: set[str] = set()
        for name in names:
            self.alias(name, aliases, done)
        exported = [self.cls(name) for name in names]
        for name in names:
            if self.kinds(self.definitions[name]):
                exported.append(self.collection(name))
            elif "anyOf" not in (content := self.definitions[name]) and not self.is_enumeration(content):
                exported.append(snake(self.cls(name)))
        listing = "__all__ = [\n" + "".join(f"    {quoted(name)},\n" for name in [*exported, "MachineKeys"]) + "]"
        return "\n\n\n".join(
            [HEAD + "\n" + listing, *classes, "\n\n".join(aliases), *functions, *collections, self.machine()]
        ) + "\n"

    def part(self, name: str, extra: str) -> str:
        text = clean(self.definitions[name].get("description", ""))
        body = indent(docstring("\n".join(fill(f"{text} {extra}", 0))), 4)
        return f"class {self.cls(name)}(Part):\n{body}\n\n    __slots__ = ()"

    def alias(self, name: str, aliases: list[str], done: set[str]) -> None:
        content = self.definitions[name]
        if name in done or not ("anyOf" in content or self.is_enumeration(content)):
            return
        done.add(name)
        text = clean(content.get("description", ""))
        if "anyOf" in content:
            for option in content["anyOf"]:
                for item in (option, option.get("items", {})):
                    if (inner := self.of(item)[0]) is not None:
                        self.alias(inner, aliases, done)
            kinds = ", ".join(self.type(option) for option in content["anyOf"])
            value = f"Union[{kinds}]"
        else:
            constants = self.constants(content)
            value = f"Literal[{', '.join(map(quoted, constants))}]"
        aliases.append(f"{self.cls(name)}: TypeAlias = {value}\n{docstring(text)}")

    def object(self, name: str) -> str:
        content = self.definitions[name]
        properties, required = content["properties"], content.get("required", [])
        word = snake(self.cls(name))
        return self.function(
            word,
            [],
            self.signature(properties, required),
            self.cls(name),
            self.documentation(content.get("description", ""), properties, required),
            f"return made({self.cls(name)}, {quoted(word)}, locals())",
            0,
        )

    def kinds_of(self, name: str) -> str:
        content = self.definitions[name]
        cls, collection = self.cls(name), self.collection(name)
        blocks = [indent(docstring("\n".join(fill(clean(content.get("description", "")), 0))), 4)]
        for constant, text in self.constants(content).items():
            blocks.append(
                f"    {constant}: Final[Literal[{quoted(constant)}]] = {quoted(constant)}\n"
                + indent(docstring("\n".join(fill(clean(text), 0))), 4)
            )
        for kind, (payload, text) in self.kinds(content).items():
            what = quoted(f"{collection}.{kind}")
            inner = self.of(payload)[1]
            if self.is_object(inner):
                properties, required = inner["properties"], inner.get("required", [])
                arguments, first = self.signature(properties, required), []
                documentation = self.documentation(text, properties, required)
                body = f"return made({cls}, {what}, locals())"
            else:
                arguments, first = [], [f"value: {self.type(payload)}", "/"]
                documentation = self.documentation(text, {"value": payload}, ["value"])
                body = f"return made_of({cls}, {what}, value)"
            blocks.append(self.function(kind, first, arguments, cls, documentation, body, 4))
        return f"class {collection}(Kinds):\n" + "\n\n".join(blocks)

    def machine(self) -> str:
        top: dict[str, Schema] = self.schema["properties"]
        blocks = [indent(docstring("\n".join(fill(clean(self.schema["description"]), 0))), 4)]
        order = "".join(f"        {quoted(key)},\n" for key in top)
        blocks.append(f"    _order = (\n{order}    )")
        simple = {
            key: item
            for key, item in top.items()
            if key not in ("version", "name")
            and "additionalProperties" not in item
            and not self.is_object(self.of(item)[1])
            and not self.kinds(self.of(item)[1])
        }
        text = self.documentation("A problem file with this name.", {"name": top["name"], **simple}, ["name"])
        blocks.append(
            self.function(
                "__init__",
                ["self", "name: str"],
                self.signature(simple, []),
                "None",
                text,
                "self._begin(locals())",
                4,
            )
        )
        for key, item in top.items():
            entry = item.get("additionalProperties")
            if isinstance(entry, dict):
                blocks.append(self.adder(key, item, entry))
            elif key not in simple and key not in ("version", "name"):
                blocks += self.setters(key, item)
        return "class MachineKeys(Document):\n" + "\n\n".join(blocks)

    def adder(self, key: str, item: Schema, entry: Schema) -> str:
        """The method that adds an entry to a map of the file."""
        what = singular(key)
        handle = HANDLES.get(key, "Name")
        name, content = self.of(entry)
        text = content.get("description") or item["description"]
        if name is not None and self.is_object(content):
            properties, required = content["properties"], content.get("required", [])
            first, value = ["self", "name: str"], 'keys(locals(), "name")'
            arguments = self.signature(properties, required)
        else:
            kind = "kind" if name is not None else "loads"
            properties, required, value = {kind: entry}, [kind], kind
            first, arguments = ["self", "name: str", f"{kind}: {self.type(entry)}"], []
        named = {"name": {"type": "string", "description": f"Its name among the `{key}`."}, **properties}
        return self.function(
            f"add_{what}",
            first,
            arguments,
            handle,
            self.documentation(f"Adds a {what.replace('_', ' ')}.", named, ["name", *required], clean(text)),
            f"return {handle}(name, self._add({quoted(key)}, {quoted(what)}, name, {value}))",
            4,
        )

    def setters(self, key: str, item: Schema) -> list[str]:
        content = self.of(item)[1]
        again = "A second call replaces what the first has set."
        if self.is_object(content):
            properties, required = content["properties"], content.get("required", [])
            text = self.documentation(item.get("description", ""), properties, required, again)
            body = f'self._set({quoted(key)}, "set_{key}", locals())'
            return [self.function(f"set_{key}", ["self"], self.signature(properties, required), "None", text, body, 4)]
        return [
            self.function(
                kind,
                ["self", f"value: {self.type(payload)}", "/"],
                [],
                "None",
                self.documentation(text, {"value": payload}, ["value"], again),
                f"self._set({quoted(key)}, {quoted(kind)}, {{{quoted(kind)}: value}})",
                4,
            )
            for kind, (payload, text) in self.kinds(content).items()
        ]


def ordered(properties: dict[str, Schema], required: list[str]) -> list[str]:
    """Arguments that are needed come first."""
    return [key for key in properties if key in required] + [key for key in properties if key not in required]


def limits(schema: Schema) -> str:
    low, high = schema.get("minimum"), schema.get("maximum")
    words = []
    if "exclusiveMinimum" in schema:
        words.append(f"above {schema['exclusiveMinimum']}")
    if "exclusiveMaximum" in schema:
        words.append(f"below {schema['exclusiveMaximum']}")
    if low is not None and high is not None:
        return f" from {low} to {high}"
    if low is not None:
        words.append(f"at least {low}")
    if high is not None:
        words.append(f"at most {high}")
    return " " + " and ".join(words) if words else ""


def unit(schema: Schema) -> str:
    return f" [{schema['unit']}]" if schema.get("unit", "1") != "1" else ""


def clean(text: str) -> str:
    return text.replace("\\[", "[").replace("\\]", "]").strip()


def fill(text: str, depth: int, more: int | None = None) -> list[str]:
    width = WIDTH - 8
    return textwrap.wrap(
        text,
        width,
        initial_indent=" " * depth,
        subsequent_indent=" " * (depth if more is None else more),
        break_long_words=False,
        break_on_hyphens=False,
    )


def docstring(text: str) -> str:
    assert "\\" not in text and '"""' not in text, text
    if "\n" in text:
        return f'"""{text}\n"""'
    return f'"""{text}"""' if not text.endswith('"') else f'"""{text} """'


def quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def indent(text: str, depth: int) -> str:
    return textwrap.indent(text, " " * depth)


def without_expressions(schema: Any) -> Any:
    """The schema whose numbers are numbers; that each may be an expression is said once, of the type `Real`."""
    if isinstance(schema, list):
        return [without_expressions(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    plain = {key: without_expressions(item) for key, item in schema.items()}
    if isinstance(plain.get("type"), list):
        plain["type"] = next(kind for kind in plain["type"] if kind != "string")
        plain.pop("pattern", None)
    return plain


def generate(schema: Schema) -> str:
    """Text of `parts.py`."""
    return Generator(without_expressions(schema)).write()


def main() -> None:
    arguments = [argument for argument in sys.argv[1:] if argument != "--print"]
    if len(arguments) != 1:
        raise SystemExit(__doc__)
    source = arguments[0]
    if source == "-":
        text = sys.stdin.read()
    else:
        text = subprocess.run([source, "schema"], check=True, capture_output=True, encoding="utf-8").stdout
    written = generate(json.loads(text))
    if "--print" in sys.argv:
        sys.stdout.write(written)
    else:
        TARGET.write_text(written, encoding="utf-8")


if __name__ == "__main__":
    main()
