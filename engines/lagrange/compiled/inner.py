"""How functions are compiled that only compiled functions call, and arrays without places counted from the end.

Without the wrappers by which Python would call them, and with numpy's rule for a division by zero, which gives an
infinity or NaN and no exception: half of the time of compiling. No reordering of sums: the same numbers everywhere.

numba asks at each place of an array whether it is negative, since it would then count from the end. No place here is,
and the question takes half of the time of stepping: `Straight` is the same array without it.
"""

from __future__ import annotations

import operator
from typing import Any

from numba import njit, types
from numba.extending import intrinsic, lower_builtin, models, register_model

OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
inner = njit(**OPTIONS)


class Straight(types.Array):
    """A contiguous array of one dimension whose places are all counted from its beginning."""


register_model(Straight)(models.ArrayModel)


def _straight(_: Any, array: Any) -> Any:
    """The same array [float64 or int64, one dimension, contiguous] as a `Straight`; nothing is copied."""

    def same(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        context.nrt.incref(builder, signature.return_type, values[0])
        return values[0]

    return Straight(array.dtype, 1, "C")(array), same


straight: Any = intrinsic(_straight)


def _pointer(context: Any, builder: Any, kind: Any, array: Any, place: Any) -> Any:
    return builder.gep(context.make_array(kind)(context, builder, array).data, [place])


@lower_builtin(operator.getitem, Straight, types.Integer)
def _read(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    return builder.load(_pointer(context, builder, signature.args[0], *values))


@lower_builtin(operator.setitem, Straight, types.Integer, types.Any)
def _write(context: Any, builder: Any, signature: Any, values: Any) -> None:
    array, place, value = values
    kind = signature.args[0]
    builder.store(
        context.cast(builder, value, signature.args[2], kind.dtype), _pointer(context, builder, kind, array, place)
    )
