"""The registered scenes and pages, and a generic page for each scene without a page.

An entry point of the group `crosscheck.scenes` is a scene, or a tuple or list of scenes. An entry point of the group
`crosscheck.pages` is a page (`reports.model.page.Page`), or a tuple or list of pages. The scenes of a page need not be
registered. The entry points of this suite are in pyproject.toml, in the order of the pages.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Sequence
from dataclasses import MISSING, fields, is_dataclass, replace
from typing import Any

from engines import Engine, method_name, registry
from engines.loading import Kind, registered
from reference.checks import InvalidMechanism, validate
from reference.scene import TIME_ANNOTATIONS, Scene
from reports.model.page import Page

LONGEST_NAME = 100  # Largest number of characters in a page's name, which is also the name of files.
INDEX = "index.md"
NO_FILE_NAME = re.compile(r"[^A-Za-z0-9.+-]+")  # Characters that must not be in the names of files and links.


def _no_scene(value: Any) -> str:
    if isinstance(value, type):
        return f"it is a class; give a scene made of it, {value.__name__}()"
    if not isinstance(value, Scene):
        return "it does not inherit from reference.scene.Scene"
    if not is_dataclass(value):
        return "its class is no dataclass, and a scene's numbers are its fields"
    for name in ("name", "source"):
        word = getattr(value, name, None)
        if not (isinstance(word, str) and word.strip() and word.isprintable()):
            return f"its {name} is {word!r}; it must be a string that is not empty and can be printed"
    if type(value).__module__.startswith("reference."):  # tests check these scenes
        return ""
    try:  # The constructor checks fields, but not values of properties.
        for name, annotation in TIME_ANNOTATIONS:
            validate(f"scene {value.name!r}", name, getattr(value, name, None), annotation)
    except InvalidMechanism as reason:
        return str(reason)
    return ""


def _by_defaults(cls: type) -> Scene | None:
    if not (issubclass(cls, Scene) and is_dataclass(cls)) or inspect.isabstract(cls):
        return None
    if not isinstance(getattr(cls, "name", None), str):
        return None
    required = (field.default is MISSING and field.default_factory is MISSING for field in fields(cls))
    return None if any(required) else cls()  # type: ignore[call-arg]


SCENE = Kind("scene", _no_scene, _by_defaults)
PAGE = Kind("page", lambda value: "" if isinstance(value, Page) else "it is no reports.model.page.Page")
_scenes = registered("crosscheck.scenes", SCENE, lambda scene: scene.name)
_pages = registered("crosscheck.pages", PAGE, lambda page: page.name)


def page_of(scene: Scene, pages: Sequence[Page] | None = None) -> Page | None:
    """The page of a scene among `pages`, by default among PAGES. Without such a page the result is None."""
    return next((page for page in (PAGES if pages is None else pages) if page.teaches(scene)), None)


def generic_page(scene: Scene, engines: Sequence[Engine], taken: Iterable[str] = ()) -> Page:
    """A page that shows all rows of a scene. The name of the document is none of the names in `taken`."""
    stem = NO_FILE_NAME.sub("_", scene.name)[:LONGEST_NAME].strip("_.") or "scene"
    summary = " ".join((type(scene).__doc__ or "").split("\n\n")[0].split())
    page = Page(stem, scene.name, summary or f"From {scene.source}.", (scene,), tuple(engines))
    number, forbidden = 1, {INDEX, *taken}
    while page.document in forbidden:
        number += 1
        page = replace(page, name=f"{stem}_{number}")
    return page


def with_scenes(pages: Sequence[Page], scenes: Iterable[Scene], engines: Sequence[Engine]) -> tuple[Page, ...]:
    """The pages, and for each scene without a page a generic page with these engines."""
    out = list(pages)
    for scene in scenes:
        if page_of(scene, out) is None:
            out.append(generic_page(scene, engines, {page.document for page in out}))
    return tuple(out)


def with_engines(pages: Iterable[Page], engines: Sequence[Engine]) -> tuple[Page, ...]:
    """Add the engines to all pages that compare engines, also to their charts."""
    added = {method_name(engine) for engine in engines}

    def extended(page: Page) -> Page:
        shown = page.featured
        return replace(
            page,
            engines=tuple(dict.fromkeys([*page.engines, *engines])),
            featured=lambda row: row.method in added or shown(row),
        )

    return tuple(extended(page) if engines and page.engines else page for page in pages)


def _without_doubles(pages: Iterable[Page]) -> tuple[tuple[Page, ...], tuple[str, ...]]:
    """(pages without duplicate scenes or documents, a message about each omitted page)."""
    accepted: list[Page] = []
    troubles: list[str] = []
    for page in pages:
        double = next((f"{s.name!r}, as {p.name!r} does" for s in page.scenes for p in accepted if p.teaches(s)), "")
        same = next((f"{page.document}, as {p.name!r} has" for p in accepted if page.document == p.document), "")
        if page.document == INDEX:
            same = f"{INDEX}, as the index of all pages has"
        if double or same:
            why = f"it teaches {double}" if double else f"it would have the file {same}"
            troubles.append(f"crosscheck.pages: the page {page.name!r} is left out, since {why}")
        else:
            accepted.append(page)
    return tuple(accepted), tuple(troubles)


_accepted, _doubles = _without_doubles(_pages.values)
_by_name = {scene.name: scene for scene in _scenes.values}
SCENES: tuple[Scene, ...] = (
    *_scenes.values,
    *(scene for page in _accepted for scene in page.scenes if scene.name not in _by_name),
)
PAGES: tuple[Page, ...] = with_scenes(_accepted, SCENES, registry.VARIANTS)
TROUBLES = (*registry.TROUBLES, *_scenes.troubles, *_pages.troubles, *_doubles)
