"""What is under test: the engines that distributions register, ours among them, and those that a reference names.

A distribution registers under `crosscheck.engines` what shall be run in every scene, and under `crosscheck.methods`
what more there is of an engine: the methods between its variants, which show what each setting buys. The value of an
entry point is an engine, or a tuple or list of engines.

An entry point that names an extra, `engines.exudyn:VARIANTS [exudyn]`, is of an engine that few install. Such
engines are OTHERS: they are compared at a few steps, beside the tables and charts of the engines that everybody has.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from engines import Engine, method_name
from engines.imported_release import other_release
from engines.loading import Kind, registered
from engines.loading import load as load_values


def trouble(value: Any) -> str:
    """Why a value is no engine, as a clause; empty if it is one. See the contract in `engines`."""
    if isinstance(value, type):
        return f"it is a class; give an engine made of it, {value.__name__}()"
    if not isinstance(value, Engine):
        return "it does not inherit from engines.Engine"
    for name in ("name", "variant"):
        word = getattr(value, name, None)
        if not (isinstance(word, str) and word.strip() and word.isprintable()):
            return f"its {name} is {word!r}; it must be a string that is not empty and can be printed"
    return ""


ENGINE = Kind("engine", trouble)


def load(reference: str, folder: Path | None = None) -> tuple[Engine, ...]:
    """The engines of `package.module:NAME`, `path/to/file.py` or `path/to/file.py:NAME`, installed or not.

    `folder`: where the reference counts from, the current one unless it is given. Raises ValueError, in one line, for
    what can't be imported or is no engine.
    """
    return load_values(reference, ENGINE, folder)


_variants = registered("crosscheck.engines", ENGINE, method_name)
_methods = registered("crosscheck.methods", ENGINE, method_name, {method_name(e): e for e in _variants.values})

# Every engine as shipped, tuned by documented settings, and extended around; ideal constraints under ordinary
# integrators of order 1 and 4; and what other distributions register. Every scene is run in these.
VARIANTS: tuple[Engine, ...] = _variants.values

# These and the methods between them, an engine's together.
ENGINES: tuple[Engine, ...] = tuple(
    engine
    for name in dict.fromkeys(engine.name for engine in (*VARIANTS, *_methods.values))
    for engine in dict.fromkeys([*_methods.values, *VARIANTS])
    if engine.name == name
)

_optional = registered(
    "crosscheck.engines", ENGINE, method_name, {method_name(engine): engine for engine in ENGINES}, extras=True
)


# Engines that are extras, installed or not: a row of theirs may have been measured elsewhere.
OTHERS: tuple[Engine, ...] = _optional.values
INSTALLED: tuple[Engine, ...] = tuple(engine for engine in OTHERS if not engine.missing)
# By an engine's name the sentence that says which extra installs it.
ABSENT: dict[str, str] = {engine.name: engine.missing for engine in OTHERS if engine.missing}
TROUBLES = (*_variants.troubles, *_methods.troubles, *_optional.troubles)


def mislabelled(elsewhere: bool = True) -> str:
    """Which registered engine's code is of another release than its metadata say; see `other_release`."""
    return other_release((*ENGINES, *INSTALLED), elsewhere)
