"""The releases that `--all` compares, their known changes, and the distributions of engines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from engines import Engine
from engines.loading import is_reference
from engines.registry import OTHERS, VARIANTS, load
from reports.model.ending import BadInput, nearest
from reports.model.fingerprint import normalised
from reports.run.installed import numbers

CHANGELOG = "https://mujoco.readthedocs.io/en/stable/changelog.html"
SPARSE = "https://github.com/google-deepmind/mujoco/issues/3767"


@dataclass(frozen=True)
class NamedRelease:
    engine: str
    version: str
    changed: str = ""  # A clause about a known change.
    source: str = ""  # The address of a page about the change.


# About one release of each minor series, and all releases with a known change, in ascending order.
RELEASES = (
    NamedRelease("mujoco", "3.3.0"),
    NamedRelease("mujoco", "3.3.7"),
    NamedRelease("mujoco", "3.4.0"),
    NamedRelease("mujoco", "3.5.0"),
    NamedRelease("mujoco", "3.6.0"),
    NamedRelease(
        "mujoco",
        "3.7.0",
        "`connect` and `weld` got the velocity term of their acceleration, -(dJ/dt) v, which they had lacked",
        CHANGELOG,
    ),
    NamedRelease("mujoco", "3.8.1"),
    NamedRelease("mujoco", "3.10.0"),
    NamedRelease("mujoco", "3.12.0"),
    NamedRelease("mujoco", "3.14.0"),
    NamedRelease("mujoco", "3.17.0"),
    NamedRelease(
        "mujoco",
        "4.0.0",
        "the sparse Cholesky factor of Newton's Hessian became wrong for some trees that branch and close across",
        SPARSE,
    ),
    NamedRelease("mujoco", "4.0.1", "that factor was corrected", SPARSE),
    NamedRelease("pymunk", "7.0.0"),
    NamedRelease("pymunk", "7.1.0"),
    NamedRelease("pymunk", "7.2.0"),
    NamedRelease("pymunk", "7.3.1"),
)

# Since this release of MuJoCo a step with default settings needs more CPU time than in 3.3.0.
COST_ROSE_IN = "3.3.1"

# Distribution -> its former names, the newest name first.
FORMERLY: Mapping[str, tuple[str, ...]] = {"mujoco-core": ("mujoco",)}


def compared_versions() -> dict[str, tuple[str, ...]]:
    engines = dict.fromkeys(release.engine for release in RELEASES)
    return {name: tuple(release.version for release in RELEASES if release.engine == name) for name in engines}


def changes_between(engine: str, before: str, after: str) -> tuple[NamedRelease, ...]:
    """Releases with a known change after the version `before`, up to and including `after`."""
    changed = [release for release in RELEASES if release.engine == engine and release.changed]
    return tuple(release for release in changed if numbers(before) < numbers(release.version) <= numbers(after))


def engines_named(word: str) -> tuple[Engine, ...]:
    """The engines with this name, or the engines of a reference. Raises BadInput."""
    if is_reference(word):
        try:
            return load(word)
        except ValueError as error:
            raise BadInput(str(error)) from None
    engines = tuple(engine for engine in (*VARIANTS, *OTHERS) if engine.name == word)
    if not engines:
        raise nearest("engine", word, dict.fromkeys(engine.name for engine in (*VARIANTS, *OTHERS)))
    return engines


def distributions(engine: Engine) -> tuple[str, ...]:
    """The distributions of an engine. The newest name of a distribution comes first."""
    return tuple(name for package in engine.packages for name in (package, *FORMERLY.get(package, ())))


def engine_of(engines: Sequence[Engine], names: Sequence[str]) -> Engine | None:
    """The first engine that has one of these names, or needs a distribution or module with such a name."""
    wanted = {normalised(name) for name in names}
    for engine in engines:
        if wanted & {normalised(name) for name in (engine.name, *distributions(engine))}:
            return engine
    return None
