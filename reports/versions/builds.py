"""Functions that install, run and compare releases and builds of an engine, for commands and notebooks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
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
from reports.model.fingerprint import normalised
from reports.model.measure import Measurement
from reports.run.files import temporary_folder
from reports.run.installed import built, distributions_in, installed
from reports.versions.column import VersionColumn, VersionRequest, cells_of, column, modules_in
from reports.versions.comparison import RowComparison, compared

STORE = "cells.sqlite"
# Short scenes that together contain all kinds of joints.
SCENES = ("driven_four_bar", "free_four_bar", "free_slider_crank", "rolling_ellipse", "sleigh", "pendulum_2")
# Distribution -> its former names, the newest name first.
FORMERLY: Mapping[str, tuple[str, ...]] = {"mujoco-core": ("mujoco",)}
LONGEST_CELL = 1.0  # A comparison leaves out cells with a longer estimated time [s].

Done = Callable[[Measurement], None]
Watch = Callable[[Sequence[str]], None]
# (label, number of cells) -> a context that yields two functions, one for rows and one for labels of running cells.
Progress = Callable[[str, int], AbstractContextManager[tuple[Done, Watch]]]


@contextmanager
def no_progress(label: str, count: int) -> Iterator[tuple[Done, Watch]]:
    yield (lambda row: None), (lambda labels: None)


@dataclass(frozen=True)
class Build:
    label: str  # in tables
    engine: str
    location: Path
    stored: bool  # Whether rows are stored, as for released versions, which do not change.


@dataclass(frozen=True)
class BuildComparison:
    sides: tuple[Build, Build]
    columns: tuple[VersionColumn, VersionColumn]
    comparison: RowComparison

    @property
    def complaint(self) -> str:
        """A sentence if the second build is worse, else empty."""
        worse, grown = self.comparison.worse, self.comparison.grown
        if not (worse or grown):
            return ""
        also = f", and {len(grown)} errors over all scenes" if grown else ""
        earlier, later = (side.label for side in self.sides)
        return f"{later} is worse than {earlier} in {len(worse)} numbers or outcomes{also}"


def scenes_named(names: Sequence[str] = SCENES) -> tuple[Scene, ...]:
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
    """Run scenes in two builds and compare the rows. A build is NAME==VERSION, a wheel, or a folder. engine: a name or
    a reference, by default the engine that needs the packages of the builds. scenes: by default SCENES. results: folder
    of the store for rows of released versions. `announce` is called with the name of each build before pip runs. Raises
    BadInput."""
    engines = (*VARIANTS, *OTHERS) if engine is None else engines_named(engine)
    a, b = (side_of(word, engine, engines, announce) for word in (first, second))
    if a.engine != b.engine:
        raise BadInput(f"{first} is of {a.engine}, and {second} of {b.engine}; give two of one engine")
    if a.label == b.label:
        a, b = replace(a, label=f"A: {a.label}"), replace(b, label=f"B: {b.label}")
    methods = [method for method in engines if engine is not None or method.name == a.engine]
    known_variants = dict.fromkeys(method.variant for method in methods)
    for word in variants:
        if word not in known_variants:
            raise nearest("variant", word, known_variants)
    methods = [method for method in methods if not variants or method.variant in variants]
    options: dict[str, Any] = {
        "every": QUICK,
        "most": LONGEST_CELL,
        "variants": tuple(dict.fromkeys(method.variant for method in methods)),
    }
    with temporary_folder() as folder:

        def run(side: Build, number: str) -> VersionColumn:
            store = (results if side.stored else folder / number) / STORE
            name = engine or side.engine
            return _run(side.label, side.label, name, methods, side.location, scenes, store, progress, **options)

        columns = run(a, "1"), run(b, "2")
    if columns[0].trouble:
        raise BadInput(f"nothing can be compared with {a.label}: {columns[0].trouble}")
    return BuildComparison((a, b), columns, compared(columns[0].rows, columns[1].rows))


def run_release(
    name: str,
    version: str,
    scenes: Sequence[Scene] | None = None,
    store: Path = Path("crosscheck-results") / STORE,
    progress: Progress = no_progress,
    announce: Callable[[str], None] = lambda word: None,
    **terms: Any,
) -> VersionColumn:
    """Run scenes in a release of an engine, which is installed if necessary. terms: fields of VersionRequest. Raises
    BadInput if the release does not exist."""
    engines = engines_named(name)
    announce(f"{name} {version}")
    location = installed(distributions(engines[0]), version)
    return _run(f"{name} {version}", version, name, engines, location, scenes, store, progress, **terms)


def _run(
    label: str,
    version: str,
    name: str,
    engines: Sequence[Engine],
    location: Path,
    scenes: Sequence[Scene] | None,
    store: Path,
    progress: Progress,
    **terms: Any,
) -> VersionColumn:
    chosen, modules = scenes_named() if scenes is None else tuple(scenes), modules_in(location)
    request = VersionRequest(chosen, name, modules, location, store.absolute(), folder=Path.cwd(), **terms)
    with progress(label, len(cells_of(request, engines))) as (done, watch):
        return column(version, request, engines, watch, done)


def side_of(word: str, engine: str | None, engines: Sequence[Engine], announce: Callable[[str], None]) -> Build:
    """The build that an argument of the command line names. Raises BadInput."""
    name, equals, version = word.partition("==")
    if equals:
        method = engine_of(engines, [name])
        if method is None and engine is None:
            names = ", ".join(dict.fromkeys(method.name for method in engines))
            raise BadInput(f"{word}: no engine needs {name!r}; there are {names}")
        announce(word)
        names = distributions(method) if method is not None else (name,)
        return Build(word, engine or (method.name if method else name), installed(names, version), True)
    if Path(word).exists():
        announce(word)
    location = built(Path(word))
    versions = distributions_in(location)
    contents = [*versions, *modules_in(location)]
    method = engine_of(engines, contents)
    if method is None and engine is None:
        if not contents:
            raise BadInput(f"{word} holds no package; give NAME==VERSION, a wheel or a folder with one")
        raise BadInput(f"{word} holds {', '.join(contents[:5])}, which no engine needs; name the engine with --engine")
    # The name of a wheel would be too long for a label.
    label = "wheel" if Path(word).suffix == ".whl" else Path(word).absolute().name
    if versions:
        label = f"{', '.join(f'{package} {number}' for package, number in versions.items())} ({label})"
    return Build(label, engine or (method.name if method else ""), location, False)


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
