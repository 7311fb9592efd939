"""Writes docs/python-api.md from the docstrings: `python python/api_page.py`."""

from __future__ import annotations

import ast
from pathlib import Path

HERE = Path(__file__).parent
PAGE = HERE.parent / "docs" / "python-api.md"

MODULES = {
    "problem": "flexbody",
    "response": "flexbody",
    "rest": "flexbody",
    "result": "flexbody",
    "page": "flexbody",
    "errors": "flexbody",
    "machine": "flexbody",
    "minimise": "flexbody",
    "__init__": "flexbody",
    "openmdao": "flexbody.openmdao",
    "scipy": "flexbody.scipy",
    "pyoptsparse": "flexbody.pyoptsparse",
    "jax": "flexbody.jax",
    "torch": "flexbody.torch",
}
"""Files in their order, and where users import their names from. Of a file of `flexbody`, those that are not in
`flexbody` itself are in the module of the file."""

HEAD = """# Classes and functions of the Python package

Made from the docstrings by `python python/api_page.py`. [The tutorial](python.md) shows them at work. All numbers are in
the units of the problem file; n_x is the number of design variables, n_f that of functions, n_t that of instants.
`flexbody.parts` has a function for each part of a scene, with the keys of [problem files](problem-file.md) as
arguments: `help(flexbody.parts.joints)`.
"""


def exported(tree: ast.Module) -> list[str]:
    """The names in `__all__`, in the order of the file."""
    for node in tree.body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            names: list[str] = ast.literal_eval(node.value)
            return names
    return []


def markdown(text: str) -> str:
    """A docstring as Markdown: its sections of parameters become lists, and indented code gets fences."""
    lines: list[str] = []
    in_section = in_list = fenced = in_code = False
    for line in text.splitlines():
        if in_code and line.strip() and not line.startswith("    "):
            close(lines)
            in_code = False
        if line.strip().startswith("```"):
            fenced = not fenced
            lines.append(line)
        elif fenced:
            lines.append(line)
        elif line.strip() and set(line.strip()) == {"-"}:
            in_section = True
            lines[-1] = f"*{lines[-1].removeprefix('- ').removesuffix(':').strip()}*\n"
        elif in_section and line.strip() and not line.startswith(" "):
            lines.append(f"- {line.strip()}:")
        elif in_section and line.startswith("    "):
            lines[-1] += f" {line.strip()}"
        elif line.startswith("    ") and not in_list:
            if not in_code:
                lines.append("```python")
            in_code = True
            lines.append(line[4:])
        else:
            lines.append(line)
            if line.strip() and not line.startswith(" "):
                in_list = line.startswith("- ")
    if in_code:
        close(lines)
    return "\n".join(lines)


def close(lines: list[str]) -> None:
    """Ends code before the empty lines that follow it."""
    end = len(lines)
    while not lines[end - 1].strip():
        end -= 1
    lines.insert(end, "```")


def comment(node: ast.stmt | None) -> str | None:
    """The text of a statement that is only text."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
        return " ".join(node.value.value.split())
    return None


def attributes(body: list[ast.stmt], of_self: bool) -> dict[str, str | None]:
    """Public attributes that statements set, with the text behind them: names in a class, or those of `self`."""
    found: dict[str, str | None] = {}
    for own, following in zip(body, [*body, None][1:], strict=True):
        targets: list[ast.expr] = []
        if isinstance(own, ast.AnnAssign):
            targets = [own.target]
        elif isinstance(own, ast.Assign) and of_self:
            for target in own.targets:
                targets.extend(target.elts if isinstance(target, ast.Tuple) else [target])
        elif isinstance(own, ast.If) and of_self:
            for name, about in {**attributes(own.orelse, True), **attributes(own.body, True)}.items():
                found.setdefault(name, about)
        for target in targets:
            name = ast.unparse(target)
            if of_self != name.startswith("self.") or name.count(".") > of_self:
                continue
            name = name.removeprefix("self.")
            if not name.startswith("_"):
                found[name] = found.get(name) or comment(following)
    return found


def signature(function: ast.FunctionDef, name: str) -> str:
    """A call, without `self` and types."""
    own = ast.parse(ast.unparse(function)).body[0]
    assert isinstance(own, ast.FunctionDef)
    for argument in [*own.args.posonlyargs, *own.args.args, *own.args.kwonlyargs, own.args.vararg, own.args.kwarg]:
        if argument is not None:
            argument.annotation = None
    all = [argument for argument in own.args.args if argument.arg not in ("self", "cls")]
    own.args.args = all
    return f"{name}({ast.unparse(own.args)})"


def of_class(node: ast.ClassDef, place: str) -> list[str]:
    """A class with its attributes and methods."""
    text = [f"### {place}\n", markdown(ast.get_docstring(node) or ""), ""]
    init = next((n for n in node.body if isinstance(n, ast.FunctionDef) and n.name == "__init__"), None)
    known = attributes(node.body, of_self=False)
    for name, about in attributes(init.body if init else [], of_self=True).items():
        known[name] = known.get(name) or about
    members = [f"- `{name}`: {about}" if about else f"- `{name}`" for name, about in known.items()]
    for own in node.body:
        if not isinstance(own, ast.FunctionDef) or own.name.startswith("_"):
            continue
        decorators = [ast.unparse(d) for d in own.decorator_list]
        call = own.name if any("property" in d for d in decorators) else signature(own, own.name)
        first, *rest = (ast.get_docstring(own) or "").split("\n\n", 1)
        members.append(f"- `{call}`: {' '.join(first.split())}")
        if rest:
            members.append("")
            members.extend(f"  {line}".rstrip() for line in markdown(rest[0]).splitlines())
            members.append("")
    return [*text, *members, ""]


def page() -> str:
    """The whole page."""
    trees = {file: ast.parse((HERE / "flexbody" / f"{file}.py").read_text(encoding="utf-8")) for file in MODULES}
    of_package = exported(trees["__init__"])
    lines = [HEAD]
    before = ""
    for file, module in MODULES.items():
        tree = trees[file]
        names = exported(tree)
        if module != before:
            lines.append(f"## {module}\n")
            if module != "flexbody":
                lines.extend([markdown(ast.get_docstring(tree) or ""), ""])
            before = module
        for node, following in zip(tree.body, [*tree.body[1:], None], strict=True):
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                name = node.name
            elif isinstance(node, ast.Assign) and comment(following):
                name = ast.unparse(node.targets[0])
            else:
                continue
            # Classes that results have are of interest though nobody imports them.
            if name not in names and (name.startswith("_") or not isinstance(node, ast.ClassDef)):
                continue
            place = f"{module}.{name}" if module != "flexbody" or name in of_package else f"flexbody.{file}.{name}"
            if isinstance(node, ast.ClassDef):
                lines.extend(of_class(node, place))
            elif isinstance(node, ast.FunctionDef):
                lines.extend([f"### {signature(node, place)}\n", markdown(ast.get_docstring(node) or ""), ""])
            else:
                lines.extend([f"### {place}\n", comment(following) or "", ""])
    text = "\n".join(lines)
    while "\n\n\n" in text:
        text = text.replace("\n\n\n", "\n\n")
    return text.rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
