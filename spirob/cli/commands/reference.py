"""Print the reference of a module, or write that of all of them, from the docstrings.

Made from the source that is installed, so it is never out of date.
"""

import argparse
import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from spirob.errors import ConfigError
from spirob.files import write_text

HELP = "what a module of the library does, from its docstrings"
ORDER = 90


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("module", nargs="?", help="such as spirob.ports; without it, the list")
    parser.add_argument("--out", metavar="DIR", help="write all modules there, as Markdown")


def run(arguments: argparse.Namespace) -> int:
    """List, print or write."""
    found = {module.name: module for module in modules()}
    if arguments.out:
        return _write(found, Path(arguments.out))
    if arguments.module is None:
        width = max(len(name) for name in found)
        for name, module in found.items():
            print(f"{name:{width}}  {module.text.partition(chr(10))[0]}")
        return 0
    if arguments.module not in found:
        raise ConfigError(f"no module '{arguments.module}'; `spirob reference` lists them")
    print(page(found[arguments.module]), end="")
    return 0


def _write(found: Mapping[str, "Module"], folder: Path) -> int:
    for name, module in found.items():
        write_text(folder / f"{name}.md", page(module))
    lines = [f"- [{name}]({name}.md): {m.text.partition(chr(10))[0]}" for name, m in found.items()]
    write_text(folder / "index.md", "# Reference\n\n" + "\n".join(lines) + "\n")
    print(f"{len(found)} modules in {folder}, from index.md on")
    return 0


PACKAGE = Path(__file__).parents[2]  # spirob
Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Member:
    """A class or function: how it is written, what it says of itself, and what it holds.

    kind  "class", "function" or "property"
    """

    name: str
    kind: str
    signature: str
    text: str
    members: tuple["Member", ...] = ()


@dataclass(frozen=True)
class Module:
    """A module by its dotted name, with its docstring and its public classes and functions."""

    name: str
    text: str
    members: tuple[Member, ...] = field(default=())


@cache  # a second to parse
def modules(root: Path = PACKAGE) -> tuple[Module, ...]:
    """All public modules under the package's folder `root`, by name."""
    return tuple(sorted(_read(root), key=lambda module: module.name))


def _read(root: Path) -> Iterator[Module]:
    for path in root.rglob("*.py"):
        parts = path.relative_to(root.parent).with_suffix("").parts
        if parts[-1] == "__init__":
            parts = parts[:-1]
        if any(part.startswith("_") for part in parts):
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
        yield Module(".".join(parts), ast.get_docstring(tree) or "", _members(tree))


def _members(node: ast.Module | ast.ClassDef) -> tuple[Member, ...]:
    found = []
    for child in node.body:
        if isinstance(child, ast.ClassDef | Function) and not child.name.startswith("_"):
            found.append(_member(child))
    return tuple(found)


def _member(node: ast.ClassDef | Function) -> Member:
    text = ast.get_docstring(node) or ""
    if isinstance(node, ast.ClassDef):
        return Member(node.name, "class", _class_line(node), text, _members(node))
    decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
    kind = "property" if "property" in decorators else "function"
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    arguments = "" if kind == "property" else f"({ast.unparse(node.args)})"
    return Member(node.name, kind, f"{node.name}{arguments}{returns}", text)


def _class_line(node: ast.ClassDef) -> str:
    """The class with its bases and, as for a dataclass, its fields."""
    bases = ", ".join(ast.unparse(base) for base in node.bases)
    lines = [f"class {node.name}({bases})" if bases else f"class {node.name}"]
    for child in node.body:
        if isinstance(child, ast.AnnAssign) and not ast.unparse(child.target).startswith("_"):
            lines.append(f"    {ast.unparse(child)}")
    return "\n".join(lines)


def page(module: Module) -> str:
    """One module; members that say nothing of themselves are what their base class says."""
    parts = [f"# {module.name}", module.text]
    for member in module.members:
        parts += _member_lines(member, depth=2)
    return "\n\n".join(part for part in parts if part) + "\n"


def _member_lines(member: Member, depth: int) -> list[str]:
    parts = [f"{'#' * depth} {member.name}", f"```python\n{member.signature}\n```", member.text]
    for inner in member.members:
        if inner.text:
            parts += _member_lines(inner, depth + 1)
    return parts
