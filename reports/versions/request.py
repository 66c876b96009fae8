"""What a column is asked for, and what its process says of it: both go through a pipe, pickled."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from reference.scene import Scene
from reports.run.running import TIME_LIMIT


@dataclass(frozen=True)
class Request:
    """Which scenes, in which engine at how many steps a sample; what is stored already is not run again.

    engine: a registered name, or a reference (`engines.loading`) that counts from `folder`; its variants of all scenes
    are run, or those named. modules: top-level packages that have to come from `place`, the version's own folder.
    most: a cell is left out whose run would take longer by its engine's formula [s].
    store: where rows are kept, as in every run.
    """

    scenes: tuple[Scene, ...]
    engine: str
    modules: tuple[str, ...]
    place: Path
    store: Path
    variants: tuple[str, ...] = ()
    every: tuple[int, ...] = (10,)
    most: float = float("inf")
    trees: bool = False
    fresh: bool = False
    folder: Path = Path(".")
    limit: float = TIME_LIMIT


@dataclass(frozen=True)
class Running:
    """Still alive; what it is at."""

    labels: tuple[str, ...] = ()


@dataclass(frozen=True)
class Trouble:
    """The version can't be used at all: one sentence. `lacks`: it is the version, that has not what is called."""

    sentence: str
    lacks: bool = True


@dataclass(frozen=True)
class TreesRow:
    """What an engine made of random trees (`reports.versions.trees`)."""

    engine: str
    variant: str
    bodies: int
    loops: int
    outcome: str
    sentence: str
    miss: tuple[float, ...] = ()


@dataclass(frozen=True)
class Finished:
    """All that was asked for was said."""
