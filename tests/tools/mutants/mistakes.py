"""Mistakes that people make in mechanics, written by hand in `physics.toml`.

    [["Mechanism.bias"]]                      # the function's qualified name; "gate.change:NAME" where several have it
    mistake = "the bias term is left out"     # a sentence that stands once in the list
    noticed_by = "tests/x.py::test_y"         # a test that fails with the mistake
    old = "-np.imag(rates) / step"            # an expression or statements, in any layout
    new = "0 * rates"                         # the replacement; "" removes a statement

`[[""]]` stands for the code outside of functions. `old` has to stand once in all functions of that name.
`survives` is the reason for which no test can notice the mistake.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests import ROOT

LIST = Path(__file__).with_name("physics.toml")
PACKAGES = ("reference", "engines", "reports")


class BadList(ValueError):
    """An entry that does not fit the code; the message names the entry and the reason."""


@dataclass(frozen=True)
class Mistake:
    """One entry of the list."""

    function: str
    mistake: str
    old: str
    new: str
    noticed_by: str = ""
    survives: str = ""

    def locate(self) -> tuple[str, bytes]:
        """The file, relative to the root, and its text with the mistake; raises BadList."""
        module, _, function = self.function.rpartition(":")
        old = _normalise(self.old)
        hits = [
            (file, text, *_span(text, first, last))
            for file, text, node in _functions().get(function, ())
            if module in file.removesuffix(".py").replace("/", ".")
            for first, last in _matches(node, old, inside=bool(function))
        ]
        if len(hits) != 1:
            raise BadList(f"{self.mistake}: {self.old!r} stands {len(hits)} times in functions named {self.function!r}")
        file, text, start, end = hits[0]
        column = start - (text.rfind(b"\n", 0, start) + 1)
        new = (self.new or "pass") if isinstance(old, list) else f"({self.new or None})"
        wrong = text[:start] + new.replace("\n", "\n" + " " * column).encode() + text[end:]
        try:
            ast.parse(wrong)
        except SyntaxError as reason:
            raise BadList(f"{self.mistake}: the replacement is not valid Python: {reason}") from None
        return file, wrong


def read_mistakes(path: Path = LIST) -> tuple[Mistake, ...]:
    """Every entry; raises BadList for a missing or unknown field and for a sentence that stands twice."""
    entries: dict[str, Mistake] = {}
    for function, tables in tomllib.loads(path.read_text(encoding="utf-8")).items():
        for fields in tables:
            try:
                entry = Mistake(function, **fields)
            except TypeError as reason:
                raise BadList(f"{function}: {reason}") from None
            if entry.mistake in entries:
                raise BadList(f"{entry.mistake}: the sentence stands twice")
            entries[entry.mistake] = entry
    return tuple(entries.values())


@cache
def _functions() -> dict[str, list[tuple[str, bytes, ast.AST]]]:
    """(file, text, node) of all functions and classes by qualified name; modules by ""."""
    out: dict[str, list[tuple[str, bytes, ast.AST]]] = {}
    for path in sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py")):
        text = path.read_bytes()
        tree = ast.parse(text)
        for name, node in (("", tree), *_walk(tree, "")):
            out.setdefault(name, []).append((path.relative_to(ROOT).as_posix(), text, node))
    return out


def _walk(node: ast.AST, within: str) -> Iterator[tuple[str, ast.AST]]:
    for child in ast.iter_child_nodes(node):
        name = within
        if isinstance(child, ast.FunctionDef | ast.ClassDef):
            name = f"{within}.{child.name}" if within else child.name
            yield name, child
        yield from _walk(child, name)


def _span(text: bytes, first: ast.AST, last: ast.AST) -> tuple[int, int]:
    """The bytes from the start of one node to the end of another."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    start = starts[first.lineno - 1] + first.col_offset  # type: ignore[attr-defined]
    return start, starts[last.end_lineno - 1] + last.end_col_offset  # type: ignore[attr-defined]


def _normalise(old: str) -> str | list[str]:
    """The text of an expression as `ast.unparse` writes it, or that of each statement."""
    try:
        return ast.unparse(ast.parse(old, mode="eval"))
    except SyntaxError:
        return [ast.unparse(statement) for statement in ast.parse(old).body]


def _matches(node: ast.AST, old: str | list[str], inside: bool) -> Iterator[tuple[ast.AST, ast.AST]]:
    """The first and last nodes of every place where `old` stands; `inside`: functions below are looked into as well."""
    for child in ast.iter_child_nodes(node):
        if inside or not isinstance(child, ast.FunctionDef | ast.ClassDef):
            if isinstance(child, ast.expr) and isinstance(old, str) and ast.unparse(child) == old:
                yield child, child
            else:
                yield from _matches(child, old, inside)
    if isinstance(old, list):
        for name in ("body", "orelse", "finalbody"):
            block = getattr(node, name, [])
            for at in range(len(block) - len(old) + 1 if isinstance(block, list) else 0):
                part = block[at : at + len(old)]
                if all(isinstance(p, ast.stmt) and ast.unparse(p) == text for p, text in zip(part, old, strict=True)):
                    yield part[0], part[-1]
