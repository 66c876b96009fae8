"""What is under test: the one list of engines. A new engine is its own file and a line or two here."""

from __future__ import annotations

import difflib
import importlib
import os
import sys
from typing import Any

from engines import Engine, lagrange, mujoco, pymunk

# Every engine as shipped, tuned by documented settings, and extended around; and ideal constraints under ordinary
# integrators of order 1 and 4. Every scene is run in these.
VARIANTS: tuple[Engine, ...] = (
    *(pymunk.DEFAULT, pymunk.TUNED, pymunk.EXTENDED),
    *(mujoco.DEFAULT, mujoco.TUNED, mujoco.EXTENDED),
    *(lagrange.Lagrange("euler", "projection"), lagrange.Lagrange("rk4", "projection")),
)

# These and the methods between them, which show what each setting buys.
ENGINES: tuple[Engine, ...] = (*pymunk.METHODS, *mujoco.METHODS, *lagrange.METHODS)


def load(reference: str) -> tuple[Engine, ...]:
    """The engine, or the tuple of engines, that `package.module:NAME` names, installed or below the current folder.

    Raises ValueError, saying what can't be found or what it is instead.
    """
    module, colon, name = reference.partition(":")
    if not (colon and name.isidentifier() and all(part.isidentifier() for part in module.split("."))):
        raise ValueError(f"{reference!r} names no engine: it must be package.module:NAME")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        found: Any = importlib.import_module(module)
    except Exception as error:
        raise ValueError(f"{reference!r}: importing {module} raised {type(error).__name__}: {error}") from error
    if not hasattr(found, name):
        near = difflib.get_close_matches(name, dir(found), 1)
        raise ValueError(f"{reference!r}: {module} has no {name}" + (f"; did you mean {near[0]}?" if near else ""))
    value = getattr(found, name)
    engines = tuple(value) if isinstance(value, tuple | list) else (value,)
    for each in engines:
        if isinstance(each, type) or not callable(getattr(each, "build", None)):
            what = "the class" if isinstance(each, type) else "something of the type"
            of = each if isinstance(each, type) else type(each)
            raise ValueError(f"{reference!r} holds {what} {of.__name__}; it must be an engine, an object with `build`")
    if not engines:
        raise ValueError(f"{reference!r} is empty; it must hold at least one engine")
    return engines
