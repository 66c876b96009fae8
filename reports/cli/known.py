"""Scenes, engines and pages that a command knows: registered ones, and those that its words or its store name."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from engines import Engine, method_name, registry
from engines.loading import is_reference, load
from reference.scene import Scene, told_apart, with_settings
from reports.cli.selection import choose_scenes, known_engines
from reports.cli.streams import said
from reports.model import catalogue
from reports.model.cells import Cell, estimated_cost
from reports.model.ending import BadInput, nearest
from reports.model.outcomes import Loss
from reports.model.page import Page

SLEEPING = 120.0  # s of wall time for code of somebody else that does not use its CPU time


@dataclass(frozen=True)
class Given:
    """A scene or an engine that is not registered, in words that find it again: a store keeps these, no objects.

    word: a reference (`engines.loading`), or a registered scene's name; folder: where it counts from; settings: the
    numbers of the scene that are set, as they were typed.
    """

    kind: str  # "scene" or "engine"
    word: str
    folder: str
    settings: tuple[tuple[str, str], ...] = ()

    def text(self) -> str:
        return json.dumps([self.kind, self.word, self.folder, self.settings])

    @classmethod
    def of_text(cls, text: str) -> Given:
        """Raises ValueError for a text that is none of these."""
        try:
            kind, word, folder, settings = json.loads(text)
            return cls(str(kind), str(word), str(folder), tuple((str(name), str(value)) for name, value in settings))
        except (TypeError, ValueError):
            raise ValueError(f"{text!r} names no scene or engine") from None


@dataclass(frozen=True)
class Known:
    """Scenes and engines that can be named, and pages that tell of all of them; `given`: those that words brought."""

    scenes: tuple[Scene, ...]
    engines: tuple[Engine, ...]
    pages: tuple[Page, ...]
    given: tuple[Given, ...] = ()

    def with_(self, given: Given) -> tuple[Known, tuple[Any, ...]]:
        """(this and what is given, the scenes or engines that it stands for). Raises ValueError, a sentence."""
        found = values_of(given)
        if given.kind == "engine":
            new = _new(found, self.engines, method_name, given)
            pages = catalogue.with_engines(self.pages, new)
            out = replace(self, engines=(*self.engines, *new), pages=pages)
        else:
            new = _new(found, self.scenes, lambda scene: scene.name, given)
            compared = tuple(dict.fromkeys([*registry.VARIANTS, *self._given_engines()]))
            pages = catalogue.with_scenes(self.pages, new, compared)
            out = replace(self, scenes=(*self.scenes, *new), pages=pages)
        return replace(out, given=(*out.given, given)) if new else out, found

    def _given_engines(self) -> tuple[Engine, ...]:
        registered = set(known_engines(catalogue.PAGES))
        return tuple(engine for engine in self.engines if engine not in registered)


def values_of(given: Given) -> tuple[Any, ...]:
    """The scenes or engines that are given. Raises ValueError, a sentence."""
    if given.kind == "engine":
        return registry.load(given.word, Path(given.folder))
    if is_reference(given.word):
        scenes = load(given.word, catalogue.SCENE, Path(given.folder))
    else:
        scenes = tuple(scene for scene in catalogue.SCENES if scene.name == given.word)
    if not scenes:
        raise ValueError(f"no scene is called {given.word!r}")
    return told_apart(tuple(with_settings(each, dict(given.settings)) for each in scenes))


def _new(found: Iterable[Any], known: Iterable[Any], name: Callable[[Any], str], given: Given) -> tuple[Any, ...]:
    """Those that are not known yet. Raises ValueError for another one of a known name."""
    by_name = {name(each): each for each in known}
    new = []
    for each in found:
        if name(each) not in by_name:
            by_name[name(each)] = each
            new.append(each)
        elif by_name[name(each)] != each:
            raise ValueError(f"{given.word}: another {given.kind} is called {name(each)!r}; give this one another name")
    return tuple(new)


def registered() -> Known:
    """What is registered. What is wrong there is told on stderr, a line each, and left out."""
    for line in catalogue.TROUBLES:
        said(line)
    return Known(catalogue.SCENES, known_engines(catalogue.PAGES), catalogue.PAGES)


def with_remembered(known: Known, texts: Iterable[str], motion: bool = False) -> Known:
    """What a store remembers too. What can't be found any more is told on stderr, a line each, and left out.

    motion: of a command that asks scenes for their motion.
    """
    given = []
    for text in texts:
        with suppress(ValueError):  # a text of another version
            given.append(Given.of_text(text))
    bad = refused(given, motion)
    for each in given:
        try:
            if each in bad:
                raise ValueError(bad[each])
            known, _ = known.with_(each)
        except ValueError as reason:
            said(f"left out, since it is not as it was when it was run: {reason}")
    return known


def with_words(
    known: Known, scenes: Sequence[str], engine: str | None, settings: Sequence[str] = (), motion: bool = False
) -> tuple[Known, tuple[str, ...], tuple[Engine, ...]]:
    """(known with what the words name, names of the scenes, the engines if `engine` is a reference). Raises BadInput.

    Names that are no references are left for `choose_scenes`, unless numbers of theirs are set. motion: of a command
    that calls the motion of scenes.
    """
    folder = str(Path.cwd())
    values = _settings(settings)
    if values and not scenes:
        raise BadInput("--set changes the numbers of scenes: name a scene before it")
    names: list[str] = []
    engines: tuple[Engine, ...] = ()
    try:
        words = [name for word in scenes for name in (_words_of(known, word) if values else [word])]
        references = {
            word: Given("scene", word, folder, tuple(values.items())) for word in words if values or is_reference(word)
        }
        of_engine = [Given("engine", engine, folder)] if engine is not None and is_reference(engine) else []
        for reason in refused([*of_engine, *references.values()], motion).values():
            raise BadInput(reason)
        for reference in of_engine:
            known, engines = known.with_(reference)
        for word in words:
            loaded: tuple[Any, ...] = ()
            if word in references:
                known, loaded = known.with_(references[word])
            names += [scene.name for scene in loaded] or [word]
    except ValueError as reason:
        raise BadInput(str(reason)) from None
    return known, tuple(names), engines


def one_scene(word: str, settings: Sequence[str] = ()) -> tuple[Known, Scene]:
    """(what is known, the scene) of a command that asks one for its motion. Raises BadInput."""
    known, names, _ = with_words(registered(), [word], None, settings, motion=True)
    found = choose_scenes(names, known.scenes, known.pages)
    if len(found) != 1:
        raise BadInput(f"{word!r} names {len(found)} scenes; give one of {', '.join(each.name for each in found)}")
    return known, found[0]


def _words_of(known: Known, word: str) -> list[str]:
    """A reference or a scene's name as it is; a page's name as those of its scenes. Raises BadInput."""
    if is_reference(word) or any(word == scene.name for scene in catalogue.SCENES):
        return [word]
    for page in known.pages:
        if page.name == word and page.scenes:
            return [scene.name for scene in page.scenes]
    raise nearest("scene", word, (scene.name for scene in catalogue.SCENES))


def _settings(words: Sequence[str]) -> dict[str, str]:
    """Numbers to set, by name. Raises BadInput."""
    out: dict[str, str] = {}
    for word in words:
        name, equals, value = word.partition("=")
        name = name.strip()
        if not (name and equals and value.strip()):
            raise BadInput(f"--set is {word!r}; give NAME=VALUE")
        if name in out:
            raise BadInput(f"--set gives {name} twice")
        out[name] = value.strip()
    return out


@dataclass(frozen=True)
class Trial:
    """The work of a worker: load a reference, and call what a command will call. `motion`: the scene's motion too."""

    motion: bool

    def __call__(self, given: Given) -> str:
        """The sentence that says why it can't be used; empty if it can."""
        try:
            for value in values_of(given):
                # As the tables, dictionaries and lists of a command do.
                if not (isinstance(hash(value), int) and value == value and isinstance(repr(value), str)):
                    raise ValueError("it is not equal to itself")
                is_scene = isinstance(value, Scene)
                if is_scene:
                    value.mechanism()
                for scene in (value,) if is_scene else catalogue.SCENES:
                    for engine in registry.VARIANTS if is_scene else (value,):
                        with suppress(BadInput):  # reported where the cost is needed
                            estimated_cost(Cell(scene, engine, 1))
                if is_scene and self.motion:
                    with suppress(ValueError):  # the textbook refuses, which pages can report
                        value.motion(np.linspace(0.0, value.duration, value.samples + 1))
        except ValueError as reason:
            return str(reason)
        return ""


def refused(given: Sequence[Given], motion: bool = False) -> dict[Given, str]:
    """Why some references can't be used, a sentence each. Raises WorkersLost.

    A worker tries them first: somebody else's code may end its process.
    """
    from reports.run.running import TIME_LIMIT
    from reports.run.supervisor import supervise

    if not given or multiprocessing.parent_process() is not None:  # a worker asks for itself
        return {}
    found = {}
    for each, result, _ in supervise(Trial(motion), given, TIME_LIMIT, workers=1, wall=SLEEPING):
        if isinstance(result, Loss):
            found[each] = f"{each.word}: its own code can't be used: {result.sentence}"
        elif result:
            found[each] = result
    return found
