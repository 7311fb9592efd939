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
    "openmdao": "flexbody.openmdao",
    "scipy": "flexbody.scipy",
    "pyoptsparse": "flexbody.pyoptsparse",
    "jax": "flexbody.jax",
    "torch": "flexbody.torch",
}
"""Files in their order, and where users import their names from."""

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


def indented(text: str) -> str:
    """A docstring as Markdown: its sections of parameters become lists."""
    lines: list[str] = []
    in_section = False
    for line in text.splitlines():
        if line.strip() and set(line.strip()) == {"-"}:
            in_section = True
            lines[-1] = f"*{lines[-1].removeprefix('- ').removesuffix(':').strip()}*\n"
        elif in_section and line.strip() and not line.startswith(" "):
            lines.append(f"- {line.strip()}:")
        elif in_section and line.startswith("    "):
            lines[-1] += f" {line.strip()}"
        else:
            lines.append(line)
    return "\n".join(lines)


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


def of_class(node: ast.ClassDef, module: str) -> list[str]:
    """A class with its attributes and methods."""
    text = [f"### {module}.{node.name}\n", indented(ast.get_docstring(node) or ""), ""]
    members = []
    body = list(node.body)
    init = next((n for n in body if isinstance(n, ast.FunctionDef) and n.name == "__init__"), None)
    all: list[ast.stmt] = [*body, *(init.body if init else [])]
    for own, following in zip(all, [*all[1:], None], strict=True):
        documented = isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant)
        if isinstance(own, ast.AnnAssign):
            target = ast.unparse(own.target).removeprefix("self.")
            if target.startswith("_"):
                continue
            about = ""
            if documented and isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant):
                about = f": {' '.join(str(following.value.value).split())}"
            members.append(f"- `{target}`{about}")
        elif isinstance(own, ast.FunctionDef) and not own.name.startswith("_"):
            about = ast.get_docstring(own) or ""
            decorators = [ast.unparse(d) for d in own.decorator_list]
            call = own.name if any("property" in d for d in decorators) else signature(own, own.name)
            first, *rest = about.split("\n\n", 1)
            members.append(f"- `{call}`: {' '.join(first.split())}")
            if rest:
                members.append("")
                members.extend(f"  {line}".rstrip() for line in indented(rest[0]).splitlines())
                members.append("")
    return [*text, *members, ""]


def page() -> str:
    """The whole page."""
    lines = [HEAD]
    before = ""
    for file, module in MODULES.items():
        tree = ast.parse((HERE / "flexbody" / f"{file}.py").read_text(encoding="utf-8"))
        names = exported(tree)
        if module != before:
            lines.append(f"## {module}\n")
            if module != "flexbody":
                lines.extend([indented(ast.get_docstring(tree) or ""), ""])
            before = module
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and node.name in names:
                lines.extend(of_class(node, module))
            elif isinstance(node, ast.FunctionDef) and node.name in names:
                lines.extend([f"### {signature(node, f'{module}.{node.name}')}\n", indented(ast.get_docstring(node) or ""), ""])
    text = "\n".join(lines)
    while "\n\n\n" in text:
        text = text.replace("\n\n\n", "\n\n")
    return text.rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
