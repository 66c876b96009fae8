"""Releases and builds of an engine found, installed apart, run, and compared: what the commands and notebooks call."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from engines import Engine
from engines.loading import is_reference
from engines.registry import OTHERS, VARIANTS, load
from reference.scene import Scene
from reports.model.catalogue import SCENES as ALL_SCENES
from reports.model.cells import QUICK
from reports.model.ending import BadInput, nearest
from reports.model.measure import Measurement
from reports.run.files import temporary_folder
from reports.run.installed import built, distributions_in, installed
from reports.versions.catalogue import distributions, engine_of
from reports.versions.column import VersionColumn, VersionRequest, cells_of, column, modules_in
from reports.versions.comparison import Comparison, compared

STORE = "cells.sqlite"
# A loop, rolling, a skate, a slide, a chain: one short scene of each kind of joint, with others that are driven.
SCENES = ("driven_four_bar", "free_four_bar", "free_slider_crank", "rolling_ellipse", "sleigh", "pendulum_2")
LONGEST_CELL = 1.0  # s by the engine's formula: longer ones are left out of a comparison

Done = Callable[[Measurement], None]
Watch = Callable[[Sequence[str]], None]
# (label, how many cells) -> a context with a function for each row, and one for the labels of what is running.
Progress = Callable[[str, int], AbstractContextManager[tuple[Done, Watch]]]


@contextmanager
def no_progress(label: str, count: int) -> Iterator[tuple[Done, Watch]]:
    """Progress that nobody sees."""
    yield (lambda row: None), (lambda labels: None)


@dataclass(frozen=True)
class Side:
    """A version or build: its label in tables, and whether its rows are stored: those of a build may change."""

    label: str
    engine: str
    place: Path
    stored: bool


@dataclass(frozen=True)
class BuildComparison:
    """Two builds, their rows, and the differences."""

    sides: tuple[Side, Side]
    columns: tuple[VersionColumn, VersionColumn]
    comparison: Comparison

    @property
    def complaint(self) -> str:
        """One sentence if the second is worse; empty otherwise."""
        found = self.comparison
        if not (found.worse or found.grown):
            return ""
        grown = f", and {len(found.grown)} errors over all scenes" if found.grown else ""
        labels = self.sides[1].label, self.sides[0].label
        return f"{labels[0]} is worse than {labels[1]} in {len(found.worse)} numbers or outcomes{grown}"


def scenes_named(names: Sequence[str] = SCENES) -> tuple[Scene, ...]:
    """The registered scenes of these names."""
    return tuple(scene for scene in ALL_SCENES if scene.name in names)


def compare_builds(
    first: str,
    second: str,
    engine: str | None = None,
    variants: Sequence[str] = (),
    scenes: Sequence[Scene] | None = None,
    results: Path = Path("crosscheck-results"),
    progress: Progress = no_progress,
    announce: Callable[[str], None] = lambda word: None,
) -> BuildComparison:
    """Run the scenes (six short ones if None) in two builds: NAME==VERSION, a wheel, or a folder that holds a build.

    engine: its name, or a reference to one; found by the packages of the builds if None. results: the folder of the
    store for rows of releases. `announce` is called with what pip is about to install. Raises BadInput.
    """
    engines = (*VARIANTS, *OTHERS) if engine is None else engines_named(engine)
    sides = [side_of(word, engine, engines, announce) for word in (first, second)]
    if sides[0].engine != sides[1].engine:
        raise BadInput(f"{first} is of {sides[0].engine}, and {second} of {sides[1].engine}; give two of one engine")
    if sides[0].label == sides[1].label:
        sides = [replace(side, label=f"{letter}: {side.label}") for letter, side in zip("AB", sides, strict=True)]
    known = [each for each in engines if engine is not None or each.name == sides[0].engine]
    for word in variants:
        if word not in {each.variant for each in known}:
            raise nearest("variant", word, dict.fromkeys(each.variant for each in known))
    known = [each for each in known if not variants or each.variant in variants]
    chosen = scenes_named() if scenes is None else tuple(scenes)
    terms: dict[str, Any] = {"every": QUICK, "variants": tuple(dict.fromkeys(each.variant for each in known))}
    columns = []
    with temporary_folder() as folder:
        for index, side in enumerate(sides):
            store = (results if side.stored else folder / str(index)) / STORE
            request = request_of(engine or side.engine, side.place, chosen, store, most=LONGEST_CELL, **terms)
            columns.append(run_column(side.label, side.label, request, known, progress))
    if columns[0].trouble:
        raise BadInput(f"nothing can be compared with {sides[0].label}: {columns[0].trouble}")
    return BuildComparison((sides[0], sides[1]), (columns[0], columns[1]), compared(columns[0].rows, columns[1].rows))


def run_release(
    name: str,
    version: str,
    scenes: Sequence[Scene] | None = None,
    store: Path = Path("crosscheck-results") / STORE,
    progress: Progress = no_progress,
    announce: Callable[[str], None] = lambda word: None,
    **terms: Any,
) -> VersionColumn:
    """Run scenes in a release of an engine, which is installed once. `terms`: fields of VersionRequest.

    Raises BadInput where there is no such release.
    """
    engines = engines_named(name)
    announce(f"{name} {version}")
    place = installed(distributions(engines, name), version)
    request = request_of(name, place, scenes_named() if scenes is None else tuple(scenes), store, **terms)
    return run_column(f"{name} {version}", version, request, engines, progress)


def request_of(engine: str, place: Path, scenes: tuple[Scene, ...], store: Path, **terms: Any) -> VersionRequest:
    """The request for the version or build that lies in `place`; `terms`: further fields."""
    return VersionRequest(scenes, engine, modules_in(place), place, store.absolute(), folder=Path.cwd(), **terms)


def run_column(
    label: str, version: str, request: VersionRequest, engines: Sequence[Engine], progress: Progress
) -> VersionColumn:
    """A column, with its progress."""
    with progress(label, len(cells_of(request, engines))) as (done, watch):
        return column(version, request, engines, watch, done)


def engines_named(word: str) -> tuple[Engine, ...]:
    """The engines of a name or of a reference. Raises BadInput."""
    if is_reference(word):
        try:
            return load(word)
        except ValueError as error:
            raise BadInput(str(error)) from None
    every = (*VARIANTS, *OTHERS)
    found = tuple(engine for engine in every if engine.name == word)
    if not found:
        raise nearest("engine", word, dict.fromkeys(engine.name for engine in every))
    return found


def side_of(word: str, engine: str | None, engines: Sequence[Engine], announce: Callable[[str], None]) -> Side:
    """The build that a word means. Raises BadInput."""
    name, equals, version = word.partition("==")
    if equals:
        known = engine_of(engines, [name])
        if known is None and engine is None:
            names = ", ".join(dict.fromkeys(each.name for each in engines))
            raise BadInput(f"{word}: no engine needs {name!r}; there are {names}")
        announce(word)
        places = distributions(engines, known) if known is not None else (name,)
        return Side(word, engine or known or name, installed(places, version), True)
    if Path(word).exists():
        announce(word)
    place = built(Path(word))
    versions = distributions_in(place)
    held = [*versions, *modules_in(place)]
    known = engine_of(engines, held)
    if known is None and engine is None:
        if not held:
            raise BadInput(f"{word} holds no package; give NAME==VERSION, a wheel or a folder with one")
        raise BadInput(f"{word} holds {', '.join(held[:5])}, which no engine needs; name the engine with --engine")
    packages = ", ".join(f"{each} {number}" for each, number in versions.items())
    # A wheel's name repeats what is in it, with forty letters of platforms.
    name = "wheel" if Path(word).suffix == ".whl" else Path(word).absolute().name
    return Side(f"{packages} ({name})" if packages else name, engine or known or "", place, False)
