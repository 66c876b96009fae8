"""The function that Python calls, the type of its arguments, and its compilation."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import typeof, types
from numba.core.imputils import lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, models, register_model
from numba.np.arrayobj import populate_array

from engines.lagrange.compiled import inner
from engines.lagrange.compiled.adaptive import adaptive_steps
from engines.lagrange.compiled.steps import evaluate_samples, fixed_steps
from engines.lagrange.methods import NO_STAGES
from engines.lagrange.records import NO_RESULTS, CompiledTask, Samples, new_storage
from engines.lagrange.system import system_of
from reference.mechanism import Body, Mechanism

WORD = ir.IntType(64)


class BlockType(types.Type):
    """The type of a pointer to a `records.block_of` a NamedTuple. Its attributes are the arrays of the block.

    A function that receives this pointer loads only the arrays that it uses. `places` are the places of the arrays'
    addresses in the block.
    """

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


@inner
def run(task, system, storage, tableau, samples, begin, iterations, every, dt, tolerance):
    """Make steps after the sample `begin`, or evaluate states from it on; return the last completed sample."""
    if task == CompiledTask.FIXED_STEPS:
        return fixed_steps(system, storage, tableau, samples, begin, iterations, dt, every)
    if task == CompiledTask.ADAPTIVE_STEPS:
        return adaptive_steps(system, storage, tableau, samples, begin, iterations, dt, tolerance)
    return evaluate_samples(system, storage, samples, begin, dt)


def compile_run() -> tuple[str, tuple[str, ...], bytes]:
    """The fields of `loading.ObjectFile`. The arrays of a body without joints have the types of all mechanisms."""
    mechanism = Mechanism((Body("body", 1.0, 1.0, (0.0, 0.0, 0.0)),), ())
    arrays = system_of(mechanism)[0], new_storage(mechanism), NO_STAGES, Samples(*[NO_RESULTS] * 4)
    signature = (types.int64, *map(BlockType, arrays), *[types.int64] * 3, *[types.float64] * 2)
    run.compile(signature)
    function = run.overloads[signature]
    library, name = function.library, function.fndesc.llvm_func_name
    library.get_pointer_to_function(name)  # creates the object file
    code, _ = library.serialize_using_object_code()[2]
    declared = (declared.name for declared in library._final_module.functions if declared.is_declaration)
    return name, tuple(called for called in declared if not called.startswith("llvm.")), code
