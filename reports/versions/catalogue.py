"""Which releases are compared by `--all`, what is known of each by name, and where an engine's versions are found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from engines import Engine
from reports.model.ending import nearest
from reports.model.fingerprint import normalised
from reports.run.installed import numbers

CHANGELOG = "https://mujoco.readthedocs.io/en/stable/changelog.html"
SPARSE = "https://github.com/google-deepmind/mujoco/issues/3767"


@dataclass(frozen=True)
class Release:
    """`changed`: a clause about a change that is known by name, "loops got their velocity term", with its `source`, an
    address; `worse`: whether errors became larger by it. No page looks for a step here: rows show it."""

    engine: str
    version: str
    changed: str = ""
    source: str = ""
    worse: bool = False


# About one release of every minor series, and all about which something is known, oldest first.
RELEASES = (
    Release("mujoco", "3.3.0"),
    Release("mujoco", "3.3.7"),
    Release("mujoco", "3.4.0"),
    Release("mujoco", "3.5.0"),
    Release("mujoco", "3.6.0"),
    Release(
        "mujoco",
        "3.7.0",
        "`connect` and `weld` got the velocity term of their acceleration, -(dJ/dt) v, which they had lacked",
        CHANGELOG,
    ),
    Release("mujoco", "3.8.1"),
    Release("mujoco", "3.10.0"),
    Release("mujoco", "3.12.0"),
    Release("mujoco", "3.14.0"),
    Release("mujoco", "3.17.0"),
    Release(
        "mujoco",
        "4.0.0",
        "the sparse Cholesky factor of Newton's Hessian became wrong for some trees that branch and close across",
        SPARSE,
        worse=True,
    ),
    Release("mujoco", "4.0.1", "that factor was mended", SPARSE),
    Release("pymunk", "7.0.0"),
    Release("pymunk", "7.1.0"),
    Release("pymunk", "7.2.0"),
    Release("pymunk", "7.3.1"),
)

# The release of MuJoCo with which a step as shipped became dearer, measured once beside 3.3.0 (the page says how).
COST_ROSE_IN = "3.3.1"

# Names that a distribution had before; the first that has a version is taken.
FORMERLY: Mapping[str, tuple[str, ...]] = {"mujoco-core": ("mujoco",)}


def compared_versions() -> dict[str, tuple[str, ...]]:
    """Engine -> its versions that are compared."""
    return {
        engine: tuple(each.version for each in RELEASES if each.engine == engine)
        for engine in dict.fromkeys(each.engine for each in RELEASES)
    }


def changes_between(engine: str, before: str, after: str, worse: bool) -> tuple[Release, ...]:
    """Releases after the one up to the other with a change for the worse, or for the better, that is known by name."""
    return tuple(
        each
        for each in RELEASES
        if (each.engine, each.worse) == (engine, worse)
        and each.changed
        and numbers(before) < numbers(each.version) <= numbers(after)
    )


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
