"""The function that Python calls, and its compilation."""

from __future__ import annotations

from numba import types

from engines.lagrange.compiled import inner
from engines.lagrange.compiled.adaptive import adaptive_steps
from engines.lagrange.compiled.blocks import BlockType
from engines.lagrange.compiled.steps import evaluate_samples, fixed_steps
from engines.lagrange.methods import NO_STAGES
from engines.lagrange.records import NO_RESULTS, CompiledTask, Samples, new_storage
from engines.lagrange.system import system_of
from reference.mechanism import Body, Mechanism


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
