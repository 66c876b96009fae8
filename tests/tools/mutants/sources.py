"""The files in which mistakes are made, their functions, and one mistake as a piece of text that takes another's place.

Everything is found by the syntax tree and named by module, function and expression: moving a function, or laying its
lines out otherwise, changes nothing here.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests import ROOT

PACKAGES = ("reference", "engines", "reports")
SHOWN = {"snippets", "models", "results"}  # folders of what pages print and nothing imports
SOURCES = tuple(
    sorted(
        path.relative_to(ROOT).as_posix()
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        if not set(path.parts) & SHOWN
    )
)


@dataclass(frozen=True)
class Mistake:
    """In `file`, the bytes from `start` to `end` become `new`. `function`: where that is, "" outside of functions.

    `name`: the mistake in a sentence; of a generated one the function, the operator and its ordinal there.
    """

    name: str
    file: str
    function: str
    line: int
    start: int
    end: int
    new: str

    def text(self, root: Path) -> bytes:
        """The whole file with the mistake in it."""
        right = (root / self.file).read_bytes()
        return right[: self.start] + self.new.encode() + right[self.end :]

    def __str__(self) -> str:
        old = " ".join((ROOT / self.file).read_bytes()[self.start : self.end].decode().split())
        return f"{self.name}\n  {self.file}:{self.line}: {old} -> {' '.join(self.new.split())}"


@dataclass(frozen=True)
class Source:
    """A file's text and syntax tree."""

    file: str
    text: bytes
    tree: ast.Module

    @property
    def module(self) -> str:
        return self.file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")

    def span(self, first: ast.AST, last: ast.AST) -> tuple[int, int]:
        """The bytes from the beginning of one node to the end of another."""
        begins = [0]
        for row in self.text.splitlines(keepends=True):
            begins.append(begins[-1] + len(row))
        begin = begins[first.lineno - 1] + first.col_offset  # type: ignore[attr-defined]
        return begin, begins[last.end_lineno - 1] + last.end_col_offset  # type: ignore[attr-defined]

    def functions(self) -> Iterator[tuple[str, ast.AST]]:
        """Every function and class by its qualified name, outermost first; the module itself as ""."""
        yield "", self.tree
        yield from _functions(self.tree, "")


def _functions(node: ast.AST, within: str) -> Iterator[tuple[str, ast.AST]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            name = f"{within}.{child.name}" if within else child.name
            yield name, child
            yield from _functions(child, name)
        else:
            yield from _functions(child, within)


@cache
def source(file: str) -> Source:
    """A file of the sources, read once."""
    text = (ROOT / file).read_bytes()
    return Source(file, text, ast.parse(text))


@cache
def named(files: tuple[str, ...] = SOURCES) -> Mapping[str, Sequence[tuple[Source, ast.AST]]]:
    """All functions and classes by their qualified names; every module as ""."""
    out: dict[str, list[tuple[Source, ast.AST]]] = {}
    for text in map(source, files):
        for name, node in text.functions():
            out.setdefault(name, []).append((text, node))
    return out
