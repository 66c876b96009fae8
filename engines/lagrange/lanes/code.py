"""Functions of a program for several mechanisms, in the intermediate language of LLVM."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from llvmlite import ir

from engines.lagrange.lanes.number import LANES, VECTOR, Number, vector_of

Slot = int | ir.Value
COUNT, POINTER = ir.IntType(64), ir.PointerType()


class Places:
    """The places of named arrays in the work array, whose elements are vectors."""

    def __init__(self) -> None:
        self.size = 0
        self._places = dict[str, tuple[int, int]]()

    def reserve(self, name: str, count: int) -> None:
        self._places[name] = self.size, count
        self.size += count

    def __getitem__(self, name: str) -> tuple[int, int]:
        """The first place and the number of elements."""
        return self._places[name]


class Code:
    """A function of the program: its work array, the parameters of LANES mechanisms, and further arguments."""

    def __init__(
        self, module: ir.Module, places: Places, name: str, *further: ir.Type, result: ir.Type | None = None
    ) -> None:
        kind = ir.FunctionType(result or ir.VoidType(), [POINTER, POINTER, *further])
        self.function = ir.Function(module, kind, name)
        self.function.attributes.add("noinline")
        self.builder: Any = ir.IRBuilder(self.function.append_basic_block())
        self.places, (self.work, self.parameters, *self.arguments) = places, self.function.args

    def load(self, array: ir.Value, slot: Slot) -> Number:
        return Number(self.builder, self.builder.load(self._place(array, slot), align=8, typ=VECTOR))

    def store(self, value: Any, array: ir.Value, slot: Slot) -> None:
        self.builder.store(vector_of(value), self._place(array, slot), align=8)

    def _place(self, array: ir.Value, slot: Slot) -> ir.Value:
        index = COUNT(slot) if isinstance(slot, int) else slot
        return self.builder.gep(array, [index], source_etype=VECTOR)

    def vectors(self, name: str) -> list[Any]:
        """A named array of the work array."""
        begin, count = self.places[name]
        return [self.load(self.work, begin + k) for k in range(count)]

    def put(self, values: list[Any], name: str) -> None:
        begin, count = self.places[name]
        for k, value in zip(range(count), values, strict=False):
            self.store(value, self.work, begin + k)

    def moved(self, name: str, index: Slot) -> Slot:
        """The slot of an element of a named array."""
        begin = self.places[name][0]
        return begin + index if isinstance(index, int) else self.builder.add(index, COUNT(begin))

    def call(self, other: Code, *further: ir.Value, parameters: ir.Value | None = None) -> ir.Value:
        return self.builder.call(other.function, [self.work, parameters or self.parameters, *further])

    def splat(self, scalar: ir.Value) -> Number:
        first = self.builder.insert_element(ir.Constant(VECTOR, ir.Undefined), scalar, COUNT(0))
        zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [ir.Constant(ir.IntType(32), 0)] * LANES)
        return Number(self.builder, self.builder.shuffle_vector(first, first, zeros))

    def is_any(self, number: Number, limit: float) -> ir.Value:
        """Whether the number is below the limit, or NaN, in a mechanism."""
        mask = self.builder.fcmp_unordered("<", number.code, vector_of(limit))
        return self.builder.icmp_signed("!=", self.builder.bitcast(mask, ir.IntType(LANES)), ir.IntType(LANES)(0))

    @contextmanager
    def loop(self, count: ir.Value | int) -> Iterator[ir.Value]:
        """A loop over an index from 0 to the count."""
        builder, count = self.builder, COUNT(count) if isinstance(count, int) else count
        before, body, after = builder.block, builder.append_basic_block(), builder.append_basic_block()
        builder.cbranch(builder.icmp_signed("<", COUNT(0), count), body, after)
        builder.position_at_end(body)
        index = builder.phi(COUNT)
        index.add_incoming(COUNT(0), before)
        yield index
        following = builder.add(index, COUNT(1))
        index.add_incoming(following, builder.block)
        builder.cbranch(builder.icmp_signed("<", following, count), body, after)
        builder.position_at_end(after)
