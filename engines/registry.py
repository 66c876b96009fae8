"""The registered engines, and the engines that a reference names.

Entry points of the group `crosscheck.engines` are run in every scene. Those of the group `crosscheck.methods` are
further methods of an engine, which show the effect of each setting. The value of an entry point is an engine, or a
tuple or list of engines.

An entry point with an extra, such as `engines.exudyn:VARIANTS [exudyn]`, belongs to an engine that few users install.
These engines, OTHERS, are compared at a few steps, in tables of their own.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from engines import Engine, method_name
from engines.imported_release import other_release
from engines.loading import Kind, registered
from engines.loading import load as load_values


def trouble(value: Any) -> str:
    """Why a value is no engine, as a clause; empty if it is one. See `engines.contract`."""
    if isinstance(value, type):
        return f"it is a class; give an engine made of it, {value.__name__}()"
    if not isinstance(value, Engine):
        return "it does not inherit from engines.Engine"
    for name in ("name", "variant"):
        label = getattr(value, name, None)
        if not (isinstance(label, str) and label.strip() and label.isprintable()):
            return f"its {name} is {label!r}; it must be a string that is not empty and can be printed"
    return ""


ENGINE = Kind("engine", trouble)


def load(reference: str, folder: Path | None = None) -> tuple[Engine, ...]:
    """The engines of `package.module:NAME`, `path/to/file.py` or `path/to/file.py:NAME`, installed or not.

    `folder`: the base of relative paths, by default the current folder. Raises ValueError, in one line, for a value
    that can't be imported or is no engine.
    """
    return load_values(reference, ENGINE, folder)


_variants = registered("crosscheck.engines", ENGINE, method_name)
_methods = registered("crosscheck.methods", ENGINE, method_name, {method_name(e): e for e in _variants.values})

# The engines that are run in every scene: as shipped, tuned by documented settings, and extended by our code; ideal
# constraints with integrators of order 1 and 4; and the engines of other distributions.
VARIANTS: tuple[Engine, ...] = _variants.values

# These and the further methods, grouped by engine.
ENGINES: tuple[Engine, ...] = tuple(
    engine
    for name in dict.fromkeys(engine.name for engine in (*VARIANTS, *_methods.values))
    for engine in dict.fromkeys([*_methods.values, *VARIANTS])
    if engine.name == name
)

_optional = registered(
    "crosscheck.engines", ENGINE, method_name, {method_name(engine): engine for engine in ENGINES}, extras=True
)


# Engines that are extras, installed or not, since their rows may have been measured on another computer.
OTHERS: tuple[Engine, ...] = _optional.values
INSTALLED: tuple[Engine, ...] = tuple(engine for engine in OTHERS if not engine.missing)
# By the name of an engine that is not installed: the sentence on how to install it.
ABSENT: dict[str, str] = {engine.name: engine.missing for engine in OTHERS if engine.missing}
TROUBLES = (*_variants.troubles, *_methods.troubles, *_optional.troubles)


def mislabelled(elsewhere: bool = True) -> str:
    """The registered engine whose code belongs to another release than its metadata; see `other_release`."""
    return other_release((*ENGINES, *INSTALLED), elsewhere)
