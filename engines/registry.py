"""The registered engines, and the engines that a reference names.

The engines in the group of entry points `crosscheck.engines` are run in every scene. The group `crosscheck.methods` has
further methods, which show the effect of single settings. The value of an entry point is an engine, or a tuple or list
of engines.

An entry point with an extra, such as `engines.exudyn:VARIANTS [exudyn]`, belongs to an engine that few users install.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from engines import Engine, method_name
from engines.imported_release import other_release
from engines.loading import Kind, registered
from engines.loading import load as load_values


def trouble(value: Any) -> str:
    """A clause on why a value is no engine; empty if the value is an engine. See `engines.contract`."""
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
    """The engines that a reference names; their packages may be missing.

    `folder` is the base of relative paths, by default the current folder. Raises ValueError for a value that can't be
    imported or is no engine.
    """
    return load_values(reference, ENGINE, folder)


_variants = registered("crosscheck.engines", ENGINE, method_name)
_methods = registered("crosscheck.methods", ENGINE, method_name, {method_name(e): e for e in _variants.values})

# The engines that are run in every scene. The list has engines as shipped, tuned by documented settings, and extended
# by our code.
VARIANTS: tuple[Engine, ...] = _variants.values

# VARIANTS and further methods, grouped by engine.
ENGINES: tuple[Engine, ...] = tuple(
    engine
    for name in dict.fromkeys(engine.name for engine in (*VARIANTS, *_methods.values))
    for engine in dict.fromkeys([*_methods.values, *VARIANTS])
    if engine.name == name
)

_optional = registered(
    "crosscheck.engines", ENGINE, method_name, {method_name(engine): engine for engine in ENGINES}, extras=True
)


# Engines that are extras. Such engines need not be installed, since their rows may come from another computer.
OTHERS: tuple[Engine, ...] = _optional.values
INSTALLED: tuple[Engine, ...] = tuple(engine for engine in OTHERS if not engine.missing)
# How to install an engine that is not installed, by its name.
ABSENT: dict[str, str] = {engine.name: engine.missing for engine in OTHERS if engine.missing}
TROUBLES = (*_variants.troubles, *_methods.troubles, *_optional.troubles)


def mislabelled(elsewhere: bool = True) -> str:
    """A message about a registered engine whose code and metadata belong to different releases; see `other_release`."""
    return other_release((*ENGINES, *INSTALLED), elsewhere)
