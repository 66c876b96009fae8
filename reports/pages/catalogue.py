"""PAGES: the one list. A new page is its own module and template, and one line here."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from reference.scene import Scene
from reports.pages.centrodes import page as centrodes
from reports.pages.errata import page as errata
from reports.pages.four_bar import page as four_bar
from reports.pages.n_four_bar import page as n_four_bar
from reports.pages.page import Page
from reports.pages.pendulum import page as pendulum
from reports.pages.person import page as person
from reports.pages.rolling import page as rolling
from reports.pages.scaling import page as scaling
from reports.pages.skate import page as skate
from reports.pages.slider_crank import page as slider_crank
from reports.pages.wheels import page as wheels

PAGES: tuple[Page, ...] = (
    four_bar.PAGE,
    skate.PAGE,
    wheels.PAGE,
    pendulum.PAGE,
    slider_crank.PAGE,
    n_four_bar.PAGE,
    person.PAGE,
    scaling.PAGE,
    rolling.PAGE,
    centrodes.PAGE,
    errata.PAGE,
)


def page_of(scene: Scene, pages: Sequence[Page] = PAGES) -> Page | None:
    """The page that teaches a scene; None for a scene from elsewhere."""
    return next((page for page in pages if page.teaches(scene)), None)


def untaught(scenes: Iterable[Scene], pages: Sequence[Page] = PAGES) -> tuple[str, ...]:
    """The names of the scenes that no page teaches."""
    return tuple(scene.name for scene in scenes if page_of(scene, pages) is None)
