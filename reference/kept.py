"""What is worked out once and handed to everybody who asks: nobody can write into it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

Value = TypeVar("Value")


def fixed(value: Value) -> Value:
    """The same value, no array of which can be written any more: numpy refuses it as "read-only".

    An engine that changed a mechanism's arrays would falsify the rows of the engines after it.
    """
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, tuple):
        for each in value:
            fixed(each)
    elif is_dataclass(value):
        for field in fields(value):
            fixed(getattr(value, field.name))
    return value


class kept(cached_property[Value]):
    """A cached property whose arrays are `fixed`."""

    def __init__(self, function: Callable[[Any], Value]) -> None:
        super().__init__(lambda owner: fixed(function(owner)))
        self.__doc__ = function.__doc__
