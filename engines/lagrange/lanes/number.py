"""Numbers of several mechanisms, with which the equations in the folder `compiled` emit instructions.

Numbers that are equal in all mechanisms are ordinary numbers. A comparison of `Number`s is true, so the equations emit
no branches.
"""

from __future__ import annotations

import math
from functools import cache
from importlib import import_module
from types import FunctionType, SimpleNamespace
from typing import Any

from llvmlite import ir

LANES = 8  # mechanisms in a vector register of 512 bits, or in two registers of 256 bits
REAL = ir.DoubleType()
VECTOR = ir.VectorType(REAL, LANES)
CONTRACT = ("contract",)  # a product and a sum may be rounded once
# Minimax polynomials of the sine and cosine up to pi/4, and pi/2 in three parts (fdlibm, Sun Microsystems 1993).
SINE = (1.58969099521155010221e-10, -2.50507602534068634195e-08, 2.75573137070700676789e-06)
SINE += (-1.98412698298579493134e-04, 8.33333333332248946124e-03, -1.66666666666666324348e-01)
COSINE = (-1.13596475577881948265e-11, 2.08757232129817482790e-09, -2.75573143513906633035e-07)
COSINE += (2.48015872894767294178e-05, -1.38888888888741095749e-03, 4.16666666666666019037e-02)
HALF_PI = (1.5707963267948966, 6.123233995736766e-17, -1.4973849048591833e-33)


class Number:
    """A number of each of LANES mechanisms; `code` is its instruction."""

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, builder: Any, code: ir.Value) -> None:
        self.builder, self.code = builder, code

    def with_instruction(self, name: str, left: Any, right: Any) -> Number:
        operands = (vector_of(value) for value in (left, right))
        return Number(self.builder, getattr(self.builder, name)(*operands, flags=CONTRACT))

    def intrinsic(self, name: str, *further: Any) -> Number:
        operands = [self.code, *(vector_of(value) for value in further)]
        module, full_name = self.builder.module, f"llvm.{name}.v{LANES}f64"
        function = module.globals.get(full_name)
        if function is None:
            function = ir.Function(module, ir.FunctionType(VECTOR, [VECTOR] * len(operands)), full_name)
        return Number(self.builder, self.builder.call(function, operands))

    def chosen(self, comparison: str, limit: Any, then: Any, otherwise: Any) -> Number:
        """`then` in mechanisms in which the comparison with the limit holds, and `otherwise` in the other ones."""
        mask = self.builder.fcmp_unordered(comparison, self.code, vector_of(limit))
        return Number(self.builder, self.builder.select(mask, vector_of(then), vector_of(otherwise)))

    def __add__(self, other: Any) -> Number:
        return self if is_constant(other, 0.0) else self.with_instruction("fadd", self, other)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Number:
        return self if is_constant(other, 0.0) else self.with_instruction("fsub", self, other)

    def __rsub__(self, other: Any) -> Number:
        return -self if is_constant(other, 0.0) else self.with_instruction("fsub", other, self)

    def __mul__(self, other: Any) -> Any:
        if is_constant(other, 0.0):
            return 0.0
        if is_constant(other, 1.0) or is_constant(other, -1.0):
            return self if other > 0 else -self
        return self.with_instruction("fmul", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Number:
        return self.with_instruction("fdiv", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return 0.0 if is_constant(other, 0.0) else self.with_instruction("fdiv", other, self)

    def __neg__(self) -> Number:
        return Number(self.builder, self.builder.fneg(self.code))

    def __abs__(self) -> Number:
        return self.intrinsic("fabs")

    def __ne__(self, other: object) -> bool:
        return True

    def __lt__(self, other: Any) -> bool:
        return True

    __gt__ = __le__ = __lt__


def is_constant(value: Any, constant: float) -> bool:
    return not isinstance(value, Number) and value == constant


def vector_of(value: Any) -> ir.Value:
    return value.code if isinstance(value, Number) else ir.Constant(VECTOR, [ir.Constant(REAL, float(value))] * LANES)


def least(left: Any, right: Any) -> Any:
    """The smaller value, or NaN if one is NaN."""
    if isinstance(left, Number):
        return left.intrinsic("minimum", right)
    return right.intrinsic("minimum", left) if isinstance(right, Number) else min(left, right)


def largest(left: Any, right: Any) -> Any:
    return -least(-left, -right)


def sine_and_cosine(angle: Number) -> tuple[Number, Number]:
    """The sine and the cosine with errors of about one rounding, for angles of less than a million turns."""
    turns = (angle * (1 / HALF_PI[0])).intrinsic("rint")
    rest = angle
    for part in HALF_PI:
        rest = (-turns).intrinsic("fma", part, rest)
    square = rest * rest
    sine, cosine = (polynomial(square, factors) for factors in (SINE, COSINE))
    sine, cosine = rest + rest * square * sine, 1.0 - (0.5 * square - square * square * cosine)
    quarter = turns - 4.0 * (turns * 0.25).intrinsic("floor")
    is_odd = (quarter - 1.0) * (quarter - 3.0)  # zero in the quarters 1 and 3
    values = is_odd.chosen("==", 0.0, cosine, sine), is_odd.chosen("==", 0.0, sine, cosine)
    return (
        quarter.chosen(">", 1.5, -values[0], values[0]),
        abs(quarter - 1.5).chosen("<", 1.0, -values[1], values[1]),
    )


def polynomial(value: Number, factors: tuple[float, ...]) -> Any:
    result: Any = 0.0
    for factor in factors:
        result = result * value + factor
    return result


VECTOR_MATH = SimpleNamespace(
    sin=lambda angle: sine_and_cosine(angle)[0] if isinstance(angle, Number) else math.sin(angle),
    cos=lambda angle: sine_and_cosine(angle)[1] if isinstance(angle, Number) else math.cos(angle),
    sqrt=lambda value: value.intrinsic("sqrt") if isinstance(value, Number) else math.sqrt(value),
    inf=math.inf,
    nan=math.nan,
)


@cache
def equations(corrections: int) -> dict[str, Any]:
    """The functions of the folder `compiled` by name, for calls with `Number`s, with at least so many corrections."""
    out: dict[str, Any] = {}
    for name in ("couplings", "forces", "joints", "solve", "steps"):
        for key, value in vars(import_module(f"engines.lagrange.compiled.{name}")).items():
            source = getattr(value, "py_func", None)
            out[key] = value if source is None else FunctionType(source.__code__, out)
    solve = out["solve"]
    out |= {"math": VECTOR_MATH, "min": least, "max": largest, "unsigned": int}
    out["solve"] = lambda system, count: solve(system, max(int(count), corrections))
    return out
