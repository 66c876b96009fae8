"""Mistakes that people make in mechanics, written by hand in `physics.toml`.

    [["Mechanism.bias"]]                      # the function's qualified name; with part of its module if that is needed
    mistake = "the bias term is left out"     # once in the list
    old = "-np.imag(rates) / step"            # an expression or statements, however they are laid out in the file
    new = "0 * rates"                         # what stands there instead; "" leaves a statement out

`[[""]]` stands for what is outside of functions. `old` has to be found once in all functions of the name.
`survives` is the reason for which no test can notice it.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.tools.mutants.sources import Mistake, named

LIST = Path(__file__).with_name("physics.toml")


class BadList(ValueError):
    """A mistake that can't be made: which one, and why."""


@dataclass(frozen=True)
class Written:
    """One entry of the list."""

    function: str
    mistake: str
    old: str
    new: str
    survives: str = ""


def read(path: Path = LIST) -> tuple[Written, ...]:
    """Every entry; raises BadList for fields that are missing or unknown, or a sentence given twice."""
    out: dict[str, Written] = {}
    for function, entries in tomllib.loads(path.read_text(encoding="utf-8")).items():
        for fields in entries:
            try:
                entry = Written(function, **fields)
            except TypeError as reason:
                raise BadList(f"{function}: {reason}") from None
            if entry.mistake in out:
                raise BadList(f"{entry.mistake}: it is written twice")
            out[entry.mistake] = entry
    return tuple(out.values())


@cache
def found(entry: Written) -> Mistake:
    """The entry as a mistake in its file; raises BadList where its text is not found exactly once, or is no Python."""
    module, _, function = entry.function.rpartition(":")
    old = _parsed(entry.old)
    hits = [
        (text, *text.span(first, last))
        for text, node in named().get(function, ())
        if module in text.module
        for first, last in _matches(node, old, inside=bool(function))
    ]
    if len(hits) != 1:
        raise BadList(f"{entry.mistake}: {entry.old!r} stands {len(hits)} times in functions named {entry.function!r}")
    text, start, end = hits[0]
    new = entry.new if isinstance(old, list) else f"({entry.new or None})"
    line = text.text.count(b"\n", 0, start) + 1
    column = start - (text.text.rfind(b"\n", 0, start) + 1)
    new = (new or "pass").replace("\n", "\n" + " " * column)
    out = Mistake(entry.mistake, text.file, function, line, start, end, new)
    try:
        ast.parse(text.text[:start] + new.encode() + text.text[end:])
    except SyntaxError as reason:
        raise BadList(f"{entry.mistake}: what stands there then is no Python: {reason}") from None
    return out


def _parsed(old: str) -> str | list[str]:
    """An expression's text in the form that ast gives it, or that of every statement."""
    try:
        return ast.unparse(ast.parse(old, mode="eval"))
    except SyntaxError:
        return [ast.unparse(statement) for statement in ast.parse(old).body]


def _same(node: ast.AST, text: str) -> bool:
    return ast.unparse(node) == text


def _matches(node: ast.AST, old: str | list[str], inside: bool) -> Iterator[tuple[ast.AST, ast.AST]]:
    """The first and last nodes of every place where `old` stands; at the module's top if not inside of a function."""
    for child in ast.iter_child_nodes(node):
        if inside or not isinstance(child, ast.FunctionDef | ast.ClassDef):
            if isinstance(child, ast.expr) and isinstance(old, str) and _same(child, old):
                yield child, child
            else:
                yield from _matches(child, old, inside)
    if isinstance(old, list):
        for name in ("body", "orelse", "finalbody"):
            block = getattr(node, name, [])
            for at in range(len(block) - len(old) + 1 if isinstance(block, list) else 0):
                part = block[at : at + len(old)]
                if all(type(part[0]) is not ast.expr and ast.unparse(p) == o for p, o in zip(part, old, strict=True)):
                    yield part[0], part[-1]
