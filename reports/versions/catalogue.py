"""Which versions are compared by `--all`, and where an engine's versions are found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from engines import Engine
from reports.model.ending import nearest
from reports.model.fingerprint import normalised

# Names that a distribution had before; the first that has a version is taken.
FORMERLY: Mapping[str, tuple[str, ...]] = {"mujoco-core": ("mujoco",)}

# About one release of every minor series, and all about which something is known.
VERSIONS: Mapping[str, tuple[str, ...]] = {
    "mujoco": (
        *("3.1.0", "3.1.6", "3.2.0", "3.2.7", "3.3.0", "3.3.7", "3.4.0", "3.5.0", "3.6.0"),
        *("3.7.0", "3.8.1", "3.10.0", "3.12.0", "3.14.0", "3.17.0", "4.0.0", "4.0.1"),
    ),
    "pymunk": ("6.6.0", "6.9.0", "6.11.1", "7.0.0", "7.1.0", "7.2.0", "7.3.1"),
}


def distributions(engines: Sequence[Engine], name: str) -> tuple[str, ...]:
    """The distributions in which versions of an engine come, newest name first. Raises BadInput for another engine."""
    own = [engine for engine in engines if engine.name == name]
    if not own:
        raise nearest("engine", name, dict.fromkeys(engine.name for engine in engines))
    return tuple(each for package in own[0].packages for each in (package, *FORMERLY.get(package, ())))


def engine_of(engines: Sequence[Engine], names: Sequence[str]) -> str | None:
    """The engine whose numbers depend on one of these distributions or modules; None if none of the engines does."""
    asked = {normalised(name) for name in names}
    for engine in engines:
        known = {engine.name, *engine.packages, *(old for each in engine.packages for old in FORMERLY.get(each, ()))}
        if asked & {normalised(each) for each in known}:
            return engine.name
    return None
