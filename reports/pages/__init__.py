"""PAGES: the one list. A new page is its own module and template, and one line here."""

from __future__ import annotations

from reports.page import Page
from reports.pages import (
    centrodes,
    errata,
    four_bar,
    n_four_bar,
    pendulum,
    person,
    rolling,
    scaling,
    skate,
    slider_crank,
    wheels,
)

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
