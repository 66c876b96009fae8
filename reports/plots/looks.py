"""How families of engines and outcomes are drawn; families in the registry's order, so that pictures keep theirs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from engines import registry
from reports.model.outcomes import Outcome
from reports.plots.theme import LIGHT, SERIES, Theme

# One more than there are colours: family by family both change, and no pair comes again before the 72nd.
MARKS = ("o", "s", "^", "D", "P", "*", "p", "h", "<")
LINES: tuple[Any, ...] = (":", "--", "-", "-.", (0, (6, 1, 1, 1, 1, 1)), (0, (1, 3)), (0, (8, 3)), (0, (4, 1, 1, 1)))
FILLS = ("empty", "left", "full", "bottom", "top", "right", "empty", "full")
# A family's three variants look the same in every chart, whichever of them are shown.
VARIANTS = ("default", "tuned", "extended")


def family_of(engine: str) -> str:
    """The family of an engine by its name; of one that is not registered (any more) the name itself."""
    return next((each.family for each in (*registry.ENGINES, *registry.OTHERS) if each.name == engine), engine)


def places(engines: Iterable[str] = ()) -> dict[str, int]:
    """Family -> its place in the palette: the registry's first, then those of other engines by name."""
    registered = [each.family for each in (*registry.ENGINES, *registry.OTHERS)]
    return {
        family: place for place, family in enumerate(dict.fromkeys([*registered, *sorted(map(family_of, engines))]))
    }


def role(family: str, engines: Iterable[str] = ()) -> str:
    """The role of a family's colour in a theme; `engines`: the names of all that stand in the same picture."""
    return SERIES[places([family, *engines])[family] % len(SERIES)]


def mark(family: str, engines: Iterable[str] = ()) -> str:
    """The shape of a family's marks."""
    return MARKS[places([family, *engines])[family] % len(MARKS)]


def colour(engine: str, theme: Theme = LIGHT, engines: Iterable[str] = ()) -> str:
    """The colour of an engine's family."""
    return getattr(theme, role(family_of(engine), engines))


def look(engine: str, variant: str, shown: Mapping[str, Sequence[str]], theme: Theme = LIGHT) -> dict[str, Any]:
    """Line and mark of one method among all that are shown, variants by engine: its family is colour and shape of the
    mark, its variant line and filling, so that a chart survives without colours.
    """
    family = family_of(engine)
    methods = [(name, each) for name, variants in shown.items() if family_of(name) == family for each in variants]
    usual = [(methods[0][0], each) for each in VARIANTS]
    first = len(VARIANTS) if any(method in usual for method in methods) else 0
    # A family without these three: what is run in every scene comes first, and looks the same whatever else is shown.
    everywhere = [] if first else [(each.name, each.variant) for each in registry.VARIANTS if each.family == family]
    named = [method for method in dict.fromkeys([*everywhere, *methods]) if method not in usual]
    own = (engine, variant)
    index = usual.index(own) if own in usual else first + named.index(own)
    paint, fill = colour(engine, theme, shown), FILLS[index % len(FILLS)]
    return {
        "color": paint,
        "linestyle": LINES[index % len(LINES)],
        "marker": mark(family, shown),
        "fillstyle": "full" if fill == "empty" else fill,
        "markerfacecolor": theme.paper if fill == "empty" else paint,
        "markerfacecoloralt": theme.paper,
        "markeredgecolor": paint,
        "markersize": 5.5,
        "linewidth": 1.5,
    }


# Errors in maps and tables by their bounds, each darker than the last on light paper: no failure is friendlier.
SHADES = ((1e-9, "exact"), (1e-6, "fine"), (1e-4, "good"), (1e-2, "fair"), (math.inf, "middling"))
SHADE_NAMES = {
    "exact": "error below 1e-9",
    "fine": "below 1e-6",
    "good": "below 1e-4",
    "fair": "below 1e-2",
    "middling": "1e-2 or more",
}


def shade(error: float) -> str:
    """The role of an error's colour; an unknown one is told by no smaller bound than the largest."""
    return next((role for bound, role in SHADES if error < bound), "middling")


def outcome_colour(outcome: Outcome, theme: Theme) -> str:
    """The colour of a cell of a map that ended so, where its error is not told (`shade`)."""
    return getattr(theme, outcome.colour)
