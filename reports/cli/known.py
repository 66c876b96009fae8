"""Scenes, engines and pages that a command can use: registered ones, and those from references or from the store."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from engines import Engine, method_name, registry
from engines.loading import is_reference, load
from reference.scene import Scene, with_distinct_names, with_settings
from reports.cli.selection import choose_engines, choose_scenes, known_engines
from reports.cli.streams import said
from reports.model import catalogue
from reports.model.cells import Cell, estimated_cost
from reports.model.ending import BadInput, nearest
from reports.model.outcomes import Loss
from reports.model.page import Page
from reports.run import supervisor
from reports.run.running import TIME_LIMIT

SLEEPING = 120.0  # Wall time [s] after which code of a third party is ended even if it uses no CPU time.


@dataclass(frozen=True)
class Reference:
    """A reference to a scene or engine that is not registered. References can be stored as text."""

    kind: str  # "scene" or "engine".
    word: str  # A reference (`engines.loading`), or the name of a registered scene.
    folder: str  # Folder to which a path in the reference is relative.
    settings: tuple[tuple[str, str], ...] = ()  # (name, value) of changed parameters of the scene, as the user typed.

    def text(self) -> str:
        return json.dumps([self.kind, self.word, self.folder, self.settings])

    @classmethod
    def of_text(cls, text: str) -> Reference:
        """Parse the output of `text`. Raises ValueError and TypeError for any other text."""
        kind, word, folder, settings = json.loads(text)
        return cls(str(kind), str(word), str(folder), tuple((str(name), str(value)) for name, value in settings))

    def values(self) -> tuple[Any, ...]:
        """The scenes or engines of the reference. Raises ValueError."""
        if self.kind == "engine":
            return registry.load(self.word, Path(self.folder))
        if is_reference(self.word):
            scenes = load(self.word, catalogue.SCENE, Path(self.folder))
        else:
            scenes = tuple(scene for scene in catalogue.SCENES if scene.name == self.word)
        if not scenes:
            raise ValueError(f"no scene is called {self.word!r}")
        return with_distinct_names(tuple(with_settings(scene, dict(self.settings)) for scene in scenes))


@dataclass(frozen=True)
class Registry:
    """The scenes and engines that a command can use, and their pages."""

    scenes: tuple[Scene, ...]
    engines: tuple[Engine, ...]
    pages: tuple[Page, ...]
    references: tuple[Reference, ...] = ()  # References that have added scenes or engines.

    def add(self, reference: Reference) -> tuple[Registry, tuple[Any, ...]]:
        """(registry with the added scenes or engines, the added scenes or engines). Raises ValueError."""
        values = reference.values()
        if reference.kind == "engine":
            new = _new(values, self.engines, method_name, reference)
            pages = catalogue.with_engines(self.pages, new)
            out = replace(self, engines=(*self.engines, *new), pages=pages)
        else:
            new = _new(values, self.scenes, lambda scene: scene.name, reference)
            registered_engines = set(known_engines(catalogue.PAGES))
            more = (engine for engine in self.engines if engine not in registered_engines)
            pages = catalogue.with_scenes(self.pages, new, tuple(dict.fromkeys([*registry.VARIANTS, *more])))
            out = replace(self, scenes=(*self.scenes, *new), pages=pages)
        return replace(out, references=(*out.references, reference)) if new else out, values


def _new(
    values: Iterable[Any], known: Iterable[Any], name: Callable[[Any], str], reference: Reference
) -> tuple[Any, ...]:
    by_name = {name(value): value for value in known}
    new = []
    for value in values:
        if name(value) not in by_name:
            new.append(value)
        if by_name.setdefault(name(value), value) != value:
            raise ValueError(
                f"{reference.word}: another {reference.kind} is called {name(value)!r}; give this one another name"
            )
    return tuple(new)


def registered() -> Registry:
    for line in catalogue.TROUBLES:
        said(line)
    return Registry(catalogue.SCENES, known_engines(catalogue.PAGES), catalogue.PAGES)


def with_stored(known: Registry, texts: Iterable[str], motion: bool = False) -> Registry:
    """The registry with the references of a store. References that can't be loaded are reported on stderr. motion:
    whether the command computes the motion of scenes."""
    references = []
    for text in texts:
        with suppress(ValueError, TypeError):  # Another version of this suite wrote the text.
            references.append(Reference.of_text(text))
    bad = refused(references, motion)
    for reference in references:
        try:
            if reference in bad:
                raise ValueError(bad[reference])
            known, _ = known.add(reference)
        except ValueError as reason:
            said(f"left out, since it is not as it was when it was run: {reason}")
    return known


@dataclass(frozen=True)
class Choice:
    """The scenes and engines that a command line selects, and the registry with the references it contains."""

    known: Registry
    scenes: tuple[Scene, ...]
    engines: tuple[Engine, ...]


def choose(
    words: Sequence[str] = (),
    engine: str | None = None,
    variant: str | None = None,
    settings: Sequence[str] = (),
    known: Registry | None = None,
    motion: bool = False,
) -> Choice:
    """Select scenes and engines, all of them by default. Raises BadInput. words: names of scenes or pages, or
    references. settings: NAME=VALUE for parameters of these scenes. known: a registry, by default the registered scenes
    and engines. motion: whether the command computes the motion of scenes."""
    known = known or registered()
    folder, values = str(Path.cwd()), _settings(settings)
    if values and not words:
        raise BadInput("--set changes the numbers of scenes: name a scene before it")
    words = [name for word in words for name in (_scene_names(known, word) if values else [word])]
    references = {
        word: Reference("scene", word, folder, tuple(values.items())) for word in words if values or is_reference(word)
    }
    of_engine = Reference("engine", engine, folder) if engine is not None and is_reference(engine) else None
    names: list[str] = []
    try:
        for reason in refused([*filter(None, [of_engine]), *references.values()], motion).values():
            raise BadInput(reason)
        engines: tuple[Engine, ...] = ()
        if of_engine is not None:
            known, engines = known.add(of_engine)
        for word in words:
            loaded: tuple[Any, ...] = ()
            if word in references:
                known, loaded = known.add(references[word])
            names += [scene.name for scene in loaded] or [word]
    except ValueError as reason:
        raise BadInput(str(reason)) from None
    scenes = choose_scenes(names, known.scenes, known.pages)
    return Choice(known, scenes, choose_engines(None if engines else engine, variant, engines or known.engines))


def one_scene(word: str, settings: Sequence[str] = ()) -> tuple[Registry, Scene]:
    """(registry, scene) of a command that computes the motion of one scene. Raises BadInput."""
    choice = choose([word], settings=settings, motion=True)
    if len(choice.scenes) != 1:
        names = ", ".join(scene.name for scene in choice.scenes)
        raise BadInput(f"{word!r} names {len(choice.scenes)} scenes; give one of {names}")
    return choice.known, choice.scenes[0]


def engines_named(
    word: str | None, variant: str | None, known: Sequence[Engine], folder: Path | None = None
) -> tuple[Engine, ...]:
    """The engines with this variant and this name or reference. Raises BadInput."""
    if word is None or not is_reference(word):
        return choose_engines(word, variant, known)
    try:
        return choose_engines(None, variant, registry.load(word, folder))
    except ValueError as reason:
        raise BadInput(str(reason)) from None


def _scene_names(known: Registry, word: str) -> list[str]:
    if is_reference(word) or any(word == scene.name for scene in catalogue.SCENES):
        return [word]
    for page in known.pages:
        if page.name == word and page.scenes:
            return [scene.name for scene in page.scenes]
    raise nearest("scene", word, (scene.name for scene in catalogue.SCENES))


def _settings(words: Sequence[str]) -> dict[str, str]:
    out: dict[str, str] = {}
    for word in words:
        name, _, value = (part.strip() for part in word.partition("="))
        if not (name and value):
            raise BadInput(f"--set is {word!r}; give NAME=VALUE")
        if name in out:
            raise BadInput(f"--set gives {name} twice")
        out[name] = value
    return out


def trial(motion: bool, reference: Reference) -> str:
    """The reason why a reference can't be used, or an empty text. A worker makes the same calls as a command. motion:
    whether the motion of a scene is computed too."""
    try:
        for value in reference.values():
            # A command needs a hashable and printable value that is equal to itself.
            if not (isinstance(hash(value), int) and value == value and isinstance(repr(value), str)):
                raise ValueError("it is not equal to itself")
            is_scene = isinstance(value, Scene)
            if is_scene:
                value.mechanism()
            for scene in (value,) if is_scene else catalogue.SCENES:
                for engine in registry.VARIANTS if is_scene else (value,):
                    with suppress(BadInput):  # An error of the cost is reported when the cost is needed.
                        estimated_cost(Cell(scene, engine, 1))
            if is_scene and motion:
                with suppress(ValueError):  # A page reports that the exact motion is refused.
                    value.motion(np.linspace(0.0, value.duration, value.samples + 1))
    except ValueError as reason:
        return str(reason)
    return ""


def refused(references: Sequence[Reference], motion: bool = False) -> dict[Reference, str]:
    """Reference that can't be used -> the reason why. Raises WorkersLost. A worker loads the references first, since
    code of a third party may end the process."""
    if not references or multiprocessing.parent_process() is not None:  # This process is a worker.
        return {}
    sentences = {}
    for reference, result, _ in supervisor.supervise(
        partial(trial, motion), references, TIME_LIMIT, workers=1, wall=SLEEPING
    ):
        if isinstance(result, Loss):
            result = f"{reference.word}: its own code can't be used: {result.sentence}"
        if result:
            sentences[reference] = result
    return sentences
