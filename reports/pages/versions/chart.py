"""Versions as pictures: a line a scene, a heat table, and cost."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from reports.model.outcomes import Outcome
from reports.plots.looks import HATCHES, outcome_colour
from reports.plots.theme import LIGHT, SERIES, Theme, new_figure, settings, style_axes
from reports.versions.comparison import lines, size
from reports.versions.table import Entry

# Shades of errors in the heat table: below each bound, from exact to useless; the numbers say which.
SHADES = ((1e-6, "good"), (1e-2, "middling"), (math.inf, "bad"))
MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
MARKED = 6  # lines of a panel that are named: those with the largest steps


def variants(entries: Sequence[Entry]) -> tuple[str, ...]:
    """The methods in the order in which they stand in every table."""
    found = dict.fromkeys(entry.variant for entry in entries)
    usual = ("default", "tuned", "extended")
    return (*(each for each in usual if each in found), *sorted(each for each in found if each not in usual))


def over_versions(
    entries: Sequence[Entry], versions: Sequence[str], steps: Mapping[str, str], theme: Theme = LIGHT
) -> Figure:
    """Error over versions, a panel a method, a line a scene; lines with a step are coloured and named.

    steps: version -> the short label of a step that stands there.
    """
    methods = variants(entries)
    with settings():
        figure = new_figure(2.9 * len(methods) + 0.6, theme)
        panels = figure.subplots(len(methods), 1, squeeze=False, sharex=True).ravel()
        for panel, method in zip(panels, methods, strict=True):
            style_axes(panel, theme)
            panel.set_yscale("log")
            panel.set_title(method, loc="left", fontweight="bold", color=theme.ink)
            panel.set_ylabel("largest error\n[rad, m, or relative]")
            _draw_lines(panel, [entry for entry in entries if entry.variant == method], versions, theme)
            for version, label in steps.items():
                place = versions.index(version) - 0.5
                panel.axvline(place, color=theme.quiet, linewidth=0.9, linestyle=(0, (4, 3)))
                if panel is panels[0]:
                    panel.annotate(
                        label,
                        (place, 1.0),
                        xycoords=("data", "axes fraction"),
                        xytext=(3, 3),
                        textcoords="offset points",
                        fontsize=8,
                        color=theme.ink,
                    )
            panel.set_xlim(-0.6, len(versions) - 0.4)
        panels[-1].set_xticks(range(len(versions)), versions, rotation=45, ha="right")
        panels[-1].set_xlabel("version")
    return figure


def _draw_lines(panel: Axes, entries: Sequence[Entry], versions: Sequence[str], theme: Theme) -> None:
    found = {scene: members for (_, scene, _), members in lines(entries).items()}
    stepped = sorted((scene for scene in found if _change(found[scene]) > 1), key=lambda scene: -_change(found[scene]))
    # Beside coloured lines the others are a background; where there are no coloured ones, they are the picture.
    others = {"color": theme.grid if stepped else theme.quiet, "linewidth": 1.2, "zorder": 2}
    for scene, members in found.items():
        if scene not in stepped[:MARKED]:
            _line(panel, members, versions, others)
    for index, scene in enumerate(stepped[:MARKED]):
        look = {
            "color": getattr(theme, SERIES[index % len(SERIES)]),
            "linewidth": 1.5,
            "marker": MARKS[index % len(MARKS)],
            "markersize": 4,
            "zorder": 3,
            "label": scene.replace("_", " "),
        }
        _line(panel, found[scene], versions, look)
    if stepped:
        legend = panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
        for text in legend.get_texts():
            text.set_color(theme.ink)


def _change(members: Sequence[Entry]) -> float:
    """Decades between the least and the largest of a line's errors."""
    sizes = [size(entry) for entry in members if entry.comparable]
    return math.log10(max(sizes) / min(sizes)) if sizes else 0.0


def _line(panel: Axes, members: Sequence[Entry], versions: Sequence[str], look: Mapping[str, object]) -> None:
    shown = {entry.version: entry.error for entry in members if entry.comparable and entry.error > 0}
    values = [shown.get(version, math.nan) for version in versions]
    panel.plot(range(len(versions)), values, **look)  # type: ignore[arg-type]


def heat_table(entries: Sequence[Entry], versions: Sequence[str], theme: Theme = LIGHT) -> Figure:
    """Scenes by versions, a panel a method; each cell says its error's power of ten, or the outcome's letter."""
    methods = variants(entries)
    scenes = {method: tuple(dict.fromkeys(e.scene for e in entries if e.variant == method)) for method in methods}
    heights = [len(scenes[method]) for method in methods]
    with settings():
        figure = new_figure(0.17 * sum(heights) + 0.5 * len(methods) + 1.4, theme)
        panels = figure.subplots(
            len(methods), 1, squeeze=False, sharex=True, gridspec_kw={"height_ratios": heights}
        ).ravel()
        for panel, method in zip(panels, methods, strict=True):
            style_axes(panel, theme, grid=False)
            panel.set_title(method, loc="left", fontweight="bold", color=theme.ink)
            known = {(e.scene, e.version): e for e in entries if e.variant == method}
            for row, scene in enumerate(scenes[method]):
                for column, version in enumerate(versions):
                    entry = known.get((scene, version))
                    if entry is not None:
                        _cell(panel, column, row, entry, theme)
            panel.set_xlim(0, len(versions))
            panel.set_ylim(len(scenes[method]), 0)
            names = [scene.replace("_", " ") for scene in scenes[method]]
            panel.set_yticks(np.arange(len(names)) + 0.5, names)
            panel.tick_params(length=0)
        panels[-1].set_xticks(np.arange(len(versions)) + 0.5, versions, rotation=45, ha="right")
        panels[-1].set_xlabel("version")
        _legend(figure, entries, theme)
    return figure


def _look(entry: Entry, theme: Theme) -> tuple[str, str | None, str]:
    """(colour, hatch, letters) of a cell."""
    if not entry.comparable:
        outcome = Outcome(entry.outcome)
        return outcome_colour(outcome, theme), HATCHES.get(outcome), outcome.letter
    role = next(role for bound, role in SHADES if entry.error < bound or math.isinf(bound))
    power = math.floor(math.log10(entry.error)) if entry.error > 0 and math.isfinite(entry.error) else None
    return getattr(theme, role), None, "0" if power is None else f"{power}"


def _cell(panel: Axes, column: int, row: int, entry: Entry, theme: Theme) -> None:
    colour, hatch, letters = _look(entry, theme)
    # No patch: the limits are given, and need not follow each of some thousand cells.
    panel.add_artist(Rectangle((column, row), 1, 1, facecolor=colour, edgecolor=theme.paper, linewidth=1, hatch=hatch))
    panel.text(column + 0.5, row + 0.5, letters, ha="center", va="center", color=theme.ink, fontsize=7, in_layout=False)


def _legend(figure: Figure, entries: Sequence[Entry], theme: Theme) -> None:
    patches = [Rectangle((0, 0), 1, 1, facecolor=getattr(theme, role)) for _, role in SHADES]
    names = ["error below 1e-6 (the number: its power of ten)", "below 1e-2", "1e-2 and more"]
    for outcome in Outcome:
        if any(not entry.comparable and entry.outcome == outcome for entry in entries):
            patches.append(
                Rectangle((0, 0), 1, 1, facecolor=outcome_colour(outcome, theme), hatch=HATCHES.get(outcome))
            )
            names.append(f"{outcome.letter}  {outcome}")
    legend = figure.legend(patches, names, loc="outside lower center", ncols=3, frameon=False)
    for text in legend.get_texts():
        text.set_color(theme.ink)


def cost(entries: Sequence[Entry], versions: Sequence[str], theme: Theme = LIGHT) -> Figure:
    """CPU time of stepping over that of the newest version: the median of the scenes, and the middle half of them."""
    with settings():
        figure = new_figure(3.0, theme)
        panel = figure.subplots()
        style_axes(panel, theme)
        methods = [method for method in variants(entries) if ratios(entries, versions, method)]
        for index, method in enumerate(methods):
            found = ratios(entries, versions, method)
            places = [versions.index(version) + 0.12 * (index - 1) for version in found]
            low, middle, high = (np.array([np.percentile(v, share) for v in found.values()]) for share in (25, 50, 75))
            colour = getattr(theme, SERIES[index])
            panel.errorbar(
                places,
                middle,
                yerr=[middle - low, high - middle],
                color=colour,
                marker=MARKS[index],
                markersize=4.5,
                linewidth=1.3,
                elinewidth=0.8,
                linestyle=("-", "--", ":")[index % 3],
                label=method,
            )
        panel.axhline(1.0, color=theme.quiet, linewidth=0.8)
        panel.set_ylim(bottom=0)
        panel.set_xticks(range(len(versions)), versions, rotation=45, ha="right")
        panel.set_ylabel(f"CPU time over that of {versions[-1]} [1]")
        panel.set_xlabel("version")
        legend = figure.legend(loc="outside lower center", ncols=4, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def ratios(entries: Sequence[Entry], versions: Sequence[str], method: str) -> dict[str, list[float]]:
    """Version -> CPU time of each scene over that of the newest version, where both were run to their ends."""
    own = {
        (entry.version, entry.scene): entry.cpu
        for entry in entries
        if entry.variant == method and entry.comparable and entry.cpu > 0
    }
    scenes = {scene for version, scene in own if version == versions[-1]}
    found = {
        version: [own[version, scene] / own[versions[-1], scene] for scene in sorted(scenes) if (version, scene) in own]
        for version in versions
    }
    return {version: values for version, values in found.items() if values}
