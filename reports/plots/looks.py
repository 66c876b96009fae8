"""Colours, lines and marks of engines and outcomes. The order of the registry determines the look of a family."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from engines import registry
from reports.model.outcomes import Outcome
from reports.plots.theme import LIGHT, SERIES

# There are nine marks and eight colours, so that 72 families have different pairs of colour and mark.
MARKS = ("o", "s", "^", "D", "P", "*", "p", "h", "<")
DASHES: tuple[Any, ...] = (":", "--", "-", "-.", (0, (6, 1, 1, 1, 1, 1)), (0, (1, 3)), (0, (8, 3)), (0, (4, 1, 1, 1)))
FILLS = ("empty", "left", "full", "bottom", "top", "right", "empty", "full")
USUAL_VARIANTS = ("default", "tuned", "extended")


def family_of(engine: str) -> str:
    """The family of the engine with this name, or the name if the engine is not registered."""
    return next((entry.family for entry in (*registry.ENGINES, *registry.OTHERS) if entry.name == engine), engine)


def _palette_index(family: str, engines: Iterable[str]) -> int:
    """The index of a family in the palette. Registered families come first, then other families of `engines` by
    name."""
    registered = [engine.family for engine in (*registry.ENGINES, *registry.OTHERS)]
    others = sorted({family_of(family), *map(family_of, engines)} - {*registered})
    return [*dict.fromkeys(registered), *others].index(family)


def role(family: str, engines: Iterable[str] = ()) -> str:
    """The role of a family's colour in the theme. `engines`: names of all engines in the picture."""
    return SERIES[_palette_index(family, engines) % len(SERIES)]


def mark(family: str, engines: Iterable[str] = ()) -> str:
    return MARKS[_palette_index(family, engines) % len(MARKS)]


def colour(engine: str, engines: Iterable[str] = ()) -> str:
    return getattr(LIGHT, role(family_of(engine), engines))


def look(engine: str, variant: str, shown: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    """The keyword arguments of a method's line in a chart. `shown`: engine -> variants in the chart. The family
    determines colour and mark, and the variant determines dashes and filling, so that lines differ without colours too.
    The three usual variants of a family look the same in every chart."""
    family = family_of(engine)
    methods = [(name, of_name) for name, variants in shown.items() if family_of(name) == family for of_name in variants]
    usual = [(methods[0][0], usual_variant) for usual_variant in USUAL_VARIANTS]
    first = len(USUAL_VARIANTS) if any(method in usual for method in methods) else 0
    # In a family without usual variants the registered methods come first, so that their look does not depend on the
    # chart.
    everywhere = [] if first else [(entry.name, entry.variant) for entry in registry.VARIANTS if entry.family == family]
    others = [other for other in dict.fromkeys([*everywhere, *methods]) if other not in usual]
    method = (engine, variant)
    index = usual.index(method) if method in usual else first + others.index(method)
    paint, fill = colour(engine, shown), FILLS[index % len(FILLS)]
    return {
        "color": paint,
        "linestyle": DASHES[index % len(DASHES)],
        "marker": mark(family, shown),
        "fillstyle": "full" if fill == "empty" else fill,
        "markerfacecolor": LIGHT.paper if fill == "empty" else paint,
        "markerfacecoloralt": LIGHT.paper,
        "markeredgecolor": paint,
        "markersize": 5.5,
        "linewidth": 1.5,
    }


# Pairs (upper bound of the error, role of the colour). On light paper larger errors have darker colours.
SHADES = ((1e-9, "exact"), (1e-6, "fine"), (1e-4, "good"), (1e-2, "fair"), (math.inf, "middling"))
SHADE_NAMES = {
    "exact": "error below 1e-9",
    "fine": "below 1e-6",
    "good": "below 1e-4",
    "fair": "below 1e-2",
    "middling": "1e-2 or more",
}


def shade(error: float) -> str:
    return next((role for bound, role in SHADES if error < bound), "middling")


def outcome_colour(outcome: Outcome) -> str:
    """The colour of a cell whose run can't be compared."""
    return getattr(LIGHT, outcome.colour)
