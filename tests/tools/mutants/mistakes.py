"""The list `physics.toml` of mistakes that people make in mechanics.

    [["Mechanism.bias"]]                      # the function's qualified name, "gate.change:NAME" if it is ambiguous
    mistake = "the bias term is left out"     # a sentence, unique in the list
    noticed_by = "tests/x.py::test_y"         # a test that fails with the mistake
    old = "-np.imag(rates) / step"            # an expression or statements, in any layout
    new = "0 * rates"                         # the replacement; "" removes a statement

`[[""]]` is the code outside of functions. `old` must occur exactly once in all functions of that name. `survives` is
the reason why no test can notice the mistake.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from tests import ROOT

LIST = Path(__file__).with_name("physics.toml")
MUTATED_PACKAGES = ("reference", "engines", "reports")


class BadList(ValueError):
    """An entry that does not fit the code; the message names the entry and the reason."""


@dataclass(frozen=True)
class Mutation:
    """One entry of the list."""

    function: str
    mistake: str
    old: str
    new: str
    noticed_by: str = ""
    survives: str = ""

    def locate(self) -> tuple[str, bytes]:
        """The file, relative to the root, and its code with the mistake. Raises BadList."""
        module, _, function = self.function.rpartition(":")
        old = _parse(self.old)
        try:
            new = _parse(self.new or ("pass" if isinstance(old[0], ast.stmt) else "None"))
        except SyntaxError as reason:
            raise BadList(f"{self.mistake}: the replacement is not valid Python: {reason}") from None
        if isinstance(old[0], ast.stmt) and isinstance(new[0], ast.expr):
            new = [ast.Expr(new[0])]
        hits = []
        for file, names in _functions().items():
            if function in names and module in file.removesuffix(".py").replace("/", "."):
                tree = ast.parse((ROOT / file).read_bytes())
                nodes = [node for name, node in _walk(tree, "") if name == function] if function else [tree]
                hits += sum(_replace(node, old, new, inside=bool(function)) for node in nodes) * [(file, tree)]
        if len(hits) != 1:
            raise BadList(f"{self.mistake}: {self.old!r} occurs {len(hits)} times in functions named {self.function!r}")
        file, tree = hits[0]
        return file, ast.unparse(tree).encode()


def read_mistakes(path: Path = LIST) -> tuple[Mutation, ...]:
    """All entries of the list. Raises BadList for a missing or unknown field and for a repeated sentence."""
    entries: dict[str, Mutation] = {}
    for function, tables in tomllib.loads(path.read_text(encoding="utf-8")).items():
        for fields in tables:
            try:
                entry = Mutation(function, **fields)
            except TypeError as reason:
                raise BadList(f"{function}: {reason}") from None
            if entry.mistake in entries:
                raise BadList(f"{entry.mistake}: the sentence is repeated")
            entries[entry.mistake] = entry
    return tuple(entries.values())


@cache
def _functions() -> dict[str, set[str]]:
    """A mapping from files to the qualified names of all functions and classes, with "" for the module."""
    paths = sorted(path for package in MUTATED_PACKAGES for path in (ROOT / package).rglob("*.py"))
    trees = {path.relative_to(ROOT).as_posix(): ast.parse(path.read_bytes()) for path in paths}
    return {file: {"", *(name for name, _ in _walk(tree, ""))} for file, tree in trees.items()}


def _walk(node: ast.AST, within: str) -> Iterator[tuple[str, ast.AST]]:
    for child in ast.iter_child_nodes(node):
        name = within
        if isinstance(child, ast.FunctionDef | ast.ClassDef):
            name = f"{within}.{child.name}" if within else child.name
            yield name, child
        yield from _walk(child, name)


def _parse(code: str) -> list[Any]:
    """The syntax tree of an expression or of statements."""
    try:
        return [ast.parse(code, mode="eval").body]
    except SyntaxError:
        return list(ast.parse(code).body)


def _replace(node: ast.AST, old: list[Any], new: list[Any], inside: bool) -> int:
    """Replace `old` below a node, and in nested functions if `inside`; return the number of occurrences."""
    kind = ast.expr if isinstance(old[0], ast.expr) else ast.stmt
    wanted, count = [ast.unparse(part) for part in old], 0
    for name, value in list(ast.iter_fields(node)):
        items, at = value if isinstance(value, list) else [value], 0
        while at < len(items):
            item, part = items[at], items[at : at + len(old)]
            if all(isinstance(each, kind) for each in part) and [ast.unparse(each) for each in part] == wanted:
                items[at : at + len(old)] = new
                count, at = count + 1, at + len(new)
                continue
            if isinstance(item, ast.AST) and (inside or not isinstance(item, ast.FunctionDef | ast.ClassDef)):
                count += _replace(item, old, new, inside)
            at += 1
        if not isinstance(value, list):
            setattr(node, name, items[0])
    return count
