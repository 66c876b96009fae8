"""The type of a pointer to a `records.block_of`: its attributes are the arrays of the block.

A function that receives this pointer loads only the arrays that it uses.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import typeof, types
from numba.core.imputils import lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, models, register_model
from numba.np.arrayobj import populate_array

WORD = ir.IntType(64)


class BlockType(types.Type):
    """The type of the block of a NamedTuple; `places` are the places of the arrays' addresses in the block."""

    def __init__(self, arrays: Any) -> None:
        self.members, self.places, place = dict[str, Any](), dict[str, int](), 0
        for name, array in arrays._asdict().items():
            self.members[name], self.places[name] = typeof(array), place
            place += 1 + array.ndim
        super().__init__(type(arrays).__name__)  # a short name, which is a part of the names of functions


register_model(BlockType)(models.OpaqueModel)


@infer_getattr
class _BlockMembers(AttributeTemplate):
    key = BlockType

    def generic_resolve(self, block: BlockType, name: str) -> Any:
        return block.members.get(name)


@lower_getattr_generic(BlockType)
def _load_member(context: Any, builder: Any, block: BlockType, pointer: Any, name: str) -> Any:
    """The array from its address and shape, which no function changes."""

    def load(place: int) -> Any:
        word = builder.load(builder.gep(words, [WORD(place)]))
        word.set_metadata("invariant.load", builder.module.add_metadata([]))
        return word

    words = builder.bitcast(pointer, WORD.as_pointer())
    member, place = block.members[name], block.places[name]
    if isinstance(member, types.Record):
        return builder.inttoptr(load(place), context.get_value_type(member))
    array = context.make_array(member)(context, builder)
    shape = [load(place + 1 + axis) for axis in range(member.ndim)]
    itemsize = context.get_abi_sizeof(context.get_data_type(member.dtype))
    strides = [WORD(itemsize)]
    for extent in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], extent))
    data = builder.inttoptr(load(place), context.get_data_type(member.dtype).as_pointer())
    populate_array(array, data=data, shape=shape, strides=strides, itemsize=itemsize, meminfo=None)
    return array._getvalue()
