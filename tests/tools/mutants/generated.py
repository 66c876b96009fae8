"""Mistakes that are made by rule wherever the syntax tree has a place for one: small, typical, and in every file.

A mistake's name is its module, function, operator and ordinal among that operator's places in the function, such as
`reference.plane:rotate:sign:1`. A draw takes one place of every file before it takes a second of any.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterator, Sequence
from hashlib import sha256
from itertools import count
from typing import TypeVar

from tests.tools.mutants.sources import SOURCES, Mistake, Source, source

TWINS = (
    *(("sin", "cos"), ("min", "max"), ("minimum", "maximum"), ("fmin", "fmax"), ("nanmin", "nanmax")),
    *(("argmin", "argmax"), ("any", "all"), ("floor", "ceil"), ("first", "second"), ("hstack", "vstack")),
)
OTHER = {one: other for pair in TWINS for one, other in (pair, pair[::-1])}
TURNED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    **{ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq},
    **{ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is},
}
# Calls whose two arguments may be exchanged, or must not be.
SYMMETRIC = ("min", "max", "minimum", "maximum", "fmin", "fmax", "hypot", "suppress", "isinstance", "hasattr", "get")
LAYOUT = (
    "reports/plots/",
    "reports/site/",
    "reports/cli/",
)  # sizes and colours stand there, which no test should hold
Node = TypeVar("Node", bound=ast.AST)
Arithmetic = ast.Add | ast.Sub | ast.Mult | ast.Div | ast.Pow


def operators(node: ast.AST, parent: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Every mistake that can be made at this node: the operator's name, and what takes the node's place."""
    match node:
        case ast.BinOp(op=ast.Add() | ast.Sub() as sign) if not (_texts(node.left) or _texts(node.right)):
            yield "sign", _with(node, op=ast.Sub() if isinstance(sign, ast.Add) else ast.Add())
        case ast.UnaryOp(op=ast.USub(), operand=inner) if not isinstance(inner, ast.Constant):
            yield "sign", inner
        case ast.UnaryOp(op=ast.Not(), operand=inner):
            yield "not", inner
        case ast.BinOp(op=ast.Mult(), left=ast.Constant(value=2 | 0.5 | 3 | 4), right=kept):
            yield "factor", kept
        case ast.BinOp(op=ast.Mult() | ast.Div(), left=kept, right=ast.Constant(value=2 | 0.5 | 3 | 4 | 6)):
            yield "factor", kept
        case ast.BinOp(op=ast.Pow(), left=kept, right=ast.Constant(value=2 | 3)):
            yield "factor", kept
        case ast.Compare(ops=[turned]):
            yield "turned", _with(node, ops=[TURNED[type(turned)]()])
        case ast.BoolOp(op=both):
            yield "and-or", _with(node, op=ast.Or() if isinstance(both, ast.And) else ast.And())
        case ast.Call():
            yield from _of_a_call(node)
        case ast.Attribute(attr=name) | ast.Name(id=name) if name in OTHER and not isinstance(parent, ast.Call):
            if isinstance(node.ctx, ast.Load):  # type: ignore[attr-defined]
                yield "twin", _with(node, **{"attr" if isinstance(node, ast.Attribute) else "id": OTHER[name]})
        case ast.Subscript(slice=index, ctx=ast.Load()):
            yield from (("index", _with(node, slice=other)) for other in _beside(index))
        case ast.Constant(value=float() as value) if 0.01 <= abs(value) <= 100 and not isinstance(parent, ast.BinOp):
            yield "constant", ast.Constant(value * 1.001)
        case ast.Constant(value=int() | float() as value) if isinstance(parent, ast.BinOp) and value not in (0, True):
            if isinstance(parent.op, Arithmetic):
                yield "constant", ast.Constant(value * 1.001)
        case _:
            pass
    match parent:
        case ast.If(test=test) | ast.IfExp(test=test) if test is node:
            yield "never", ast.BoolOp(ast.And(), [ast.Constant(False), node])  # type: ignore[list-item]
        case ast.comprehension(ifs=tests) if node in tests:
            yield "unfiltered", ast.BoolOp(ast.Or(), [ast.Constant(True), node])  # type: ignore[list-item]


def _of_a_call(node: ast.Call) -> Iterator[tuple[str, ast.AST]]:
    name = getattr(node.func, "attr", getattr(node.func, "id", ""))
    if name in OTHER:
        yield "twin", _with(node, func=_with(node.func, **{"id" if hasattr(node.func, "id") else "attr": OTHER[name]}))
    if name in ("abs", "fabs") and node.args:
        yield "abs", node.args[0]
    for index, keyword in enumerate(node.keywords):
        if keyword.arg is not None:
            yield "argument", _with(node, keywords=[*node.keywords[:index], *node.keywords[index + 1 :]])
    match node.args:
        case [first, second] if name not in SYMMETRIC and ast.dump(first) != ast.dump(second):
            if not isinstance(first, ast.Starred) and not isinstance(second, ast.Starred | ast.Constant):
                yield "swapped", _with(node, args=[second, first])


def _beside(index: ast.expr) -> Iterator[ast.expr]:
    """An index or slice that is off by one."""
    match index:
        case ast.Constant(value=int() as value):
            yield ast.Constant(value + 1)
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() as value)):
            yield ast.UnaryOp(ast.USub(), ast.Constant(value + 1))
        case ast.Slice(lower=ast.Constant(value=int() as value), upper=None) if value:
            yield _with(index, lower=ast.Constant(value - 1))
        case ast.Slice(upper=ast.UnaryOp(op=ast.USub())):
            yield _with(index, upper=None)
        case ast.Tuple(elts=elements):
            for place, element in enumerate(elements):
                for other in _beside(element):
                    yield _with(index, elts=[*elements[:place], other, *elements[place + 1 :]])


def _with(node: Node, **changes: object) -> Node:
    out = copy.copy(node)
    for name, value in changes.items():
        setattr(out, name, value)
    return out


def _texts(node: ast.AST) -> bool:
    """Whether a node is evidently a text or a list, of which there is no difference."""
    return isinstance(node, ast.JoinedStr | ast.List | ast.Tuple | ast.ListComp) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def _places(node: ast.AST, within: str, anchor: ast.AST | None) -> Iterator[tuple[str, ast.AST, ast.AST, ast.AST]]:
    """All nodes that may be mistaken, as function, node, parent, and the node whose text can be replaced."""
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "type_params", "bases"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or isinstance(
                child, ast.Raise | ast.Assert | ast.Import | ast.ImportFrom
            ):
                continue
            if isinstance(child, ast.If) and ast.unparse(child.test) in ("TYPE_CHECKING", "__name__ == '__main__'"):
                continue
            # What stands inside an f-string has no place of its own before Python 3.12.
            own = anchor or (child if isinstance(child, ast.JoinedStr) else None)
            if isinstance(child, ast.expr):
                yield within, child, node, own or child
            inner = getattr(child, "name", "") if isinstance(child, ast.FunctionDef | ast.ClassDef) else ""
            yield from _places(child, ".".join(filter(None, (within, inner))), own)


def generated(text: Source) -> Iterator[Mistake]:
    """Every mistake that the operators make in a file."""
    ordinals: dict[tuple[str, str], Callable[[], int]] = {}
    for function, node, parent, anchor in _places(text.tree, "", None):
        for operator, other in operators(node, parent):
            if text.file.startswith(LAYOUT) and operator in ("constant", "argument", "factor"):
                continue
            number = ordinals.setdefault((function, operator), count(1).__next__)()
            new = other if anchor is node else _Replaced(node, other).visit(copy.deepcopy(_marked(anchor, node)))
            name = f"{text.module}:{function}:{operator}:{number}"
            start, end = text.span(anchor, anchor)
            written = ast.unparse(ast.fix_missing_locations(new))
            if not isinstance(anchor, ast.JoinedStr | ast.Slice):
                written = f"({written})"
            yield Mistake(name, text.file, function, node.lineno, start, end, written)  # type: ignore[attr-defined]


def _marked(anchor: ast.AST, node: ast.AST) -> ast.AST:
    node.marked = True  # type: ignore[attr-defined]
    return anchor


class _Replaced(ast.NodeTransformer):
    """A copy of a tree in which the node that is marked is another."""

    def __init__(self, node: ast.AST, other: ast.AST) -> None:
        self.other = other
        self.node = node

    def visit(self, node: ast.AST) -> ast.AST:
        if getattr(node, "marked", False):
            del self.node.marked  # type: ignore[attr-defined]
            return self.other
        return self.generic_visit(node)


def _rank(seed: str, name: str) -> str:
    return sha256(f"{seed} {name}".encode()).hexdigest()


def drawn(seed: str, files: Sequence[str] = SOURCES) -> Iterator[Mistake]:
    """All mistakes of these files in an order that the seed decides: one of each file, then a second of each."""
    order = sorted(files, key=lambda file: _rank(seed, file))
    left = {file: sorted(generated(source(file)), key=lambda mistake: _rank(seed, mistake.name)) for file in order}
    for place in range(max(map(len, left.values()), default=0)):
        yield from (left[file][place] for file in order if place < len(left[file]))
