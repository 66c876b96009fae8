"""The page of versions: a table and a heat map for each engine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.plots.looks import SHADE_NAMES, outcome_colour, shade
from reports.plots.theme import LIGHT, drawing, style_axes, svg
from reports.versions.table import (
    ACCELERATION,
    COST_ROSE_IN,
    Entry,
    ReleaseTable,
    changes,
    changes_between,
    relative_cost,
    released,
)
from reports.write.tables import markdown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def variants(entries: Sequence[Entry]) -> tuple[str, ...]:
    """The variants in the order of tables: the usual variants come first, then other variants by name."""
    present = {entry.variant for entry in entries}
    usual = [variant for variant in ("default", "tuned", "extended") if variant in present]
    return (*usual, *sorted(present - {*usual}))


def heat_map(entries: Sequence[Entry], versions: Sequence[str]) -> Figure:
    """A panel for each method with a cell for each scene and version. A cell shows the error's power of ten or a
    letter."""
    methods = variants(entries)
    scenes = {method: tuple(dict.fromkeys(e.scene for e in entries if e.variant == method)) for method in methods}
    heights = [len(scenes[method]) for method in methods]
    with drawing(0.17 * sum(heights) + 0.5 * len(methods) + 1.4) as figure:
        panels = figure.subplots(
            len(methods), 1, squeeze=False, sharex=True, gridspec_kw={"height_ratios": heights}
        ).ravel()
        for panel, method in zip(panels, methods, strict=True):
            style_axes(panel, grid=False)
            panel.set_title(method, loc="left", fontweight="bold", color=LIGHT.ink)
            by_cell = {(e.scene, e.version): e for e in entries if e.variant == method}
            for row, scene in enumerate(scenes[method]):
                for column, version in enumerate(versions):
                    if (scene, version) in by_cell:
                        _draw_cell(panel, column, row, by_cell[scene, version])
            panel.set_xlim(0, len(versions))
            panel.set_ylim(len(scenes[method]), 0)
            names = [scene.replace("_", " ") for scene in scenes[method]]
            panel.set_yticks(np.arange(len(names)) + 0.5, names)
            panel.tick_params(length=0)
        panels[-1].set_xticks(np.arange(len(versions)) + 0.5, versions, rotation=45, ha="right")
        panels[-1].set_xlabel("version")
        _legend(figure, entries)
    return figure


def _look(entry: Entry) -> tuple[str, str]:
    """The colour and the text of a cell. A failure is not hatched, because its letter would be hard to read."""
    if not entry.comparable:
        outcome = Outcome(entry.outcome)
        return outcome_colour(outcome), outcome.letter
    power = math.floor(math.log10(entry.error)) if entry.error > 0 and math.isfinite(entry.error) else None
    return getattr(LIGHT, shade(entry.error)), "0" if power is None else f"{power}"


def _draw_cell(panel: Axes, column: int, row: int, entry: Entry) -> None:
    from matplotlib.patches import Rectangle

    colour, letters = _look(entry)
    # With `add_patch`, matplotlib would update the limits for each of a thousand cells.
    panel.add_artist(Rectangle((column, row), 1, 1, facecolor=colour, edgecolor=LIGHT.paper, linewidth=1))
    panel.text(column + 0.5, row + 0.5, letters, ha="center", va="center", color=LIGHT.ink, fontsize=7, in_layout=False)


def _legend(figure: Figure, entries: Sequence[Entry]) -> None:
    from matplotlib.patches import Rectangle

    colours = {name: getattr(LIGHT, role) for role, name in SHADE_NAMES.items()}
    for outcome in Outcome:
        if any(not entry.comparable and entry.outcome == outcome for entry in entries):
            label = "our adapter builds none" if outcome is Outcome.UNSUPPORTED else outcome
            colours[f"{outcome.letter}  {label}"] = outcome_colour(outcome)
    patches = [Rectangle((0, 0), 1, 1, facecolor=colour, edgecolor=LIGHT.quiet) for colour in colours.values()]
    figure.legend(patches, list(colours), loc="outside lower center", ncols=4)


def version_table(table: ReleaseTable, engine: str) -> str:
    """A Markdown table of versions, with known changes, the numbers of smaller and larger errors, and relative
    costs."""
    entries, versions = table.of(engine), table.versions(engine)
    costs = {method: relative_cost(entries, versions, method) for method in variants(entries)}
    costs = {method: ratios for method, ratios in costs.items() if ratios}
    changed = changes(entries)
    body = []
    for previous, version in pairwise(("", *versions)):
        verdicts = [verdict for _, after, verdict in changed if after.version == version]
        known_changes = changes_between(engine, previous, version) if previous else ()
        change = "; ".join("{changed} ([source]({source}))".format(**known) for known in known_changes)
        counts = (
            f"{verdicts.count('better') or '-'}",
            f"**{verdicts.count('WORSE')}**" if "WORSE" in verdicts else "-",
        )
        ratios = [f"{costs[method][version]:.2f}" if version in costs[method] else "-" for method in costs]
        body.append([version, change or "-", *counts, *ratios])
    header = ["version", "change known by name", "better", "worse", *(f"CPU time, {method}" for method in costs)]
    return markdown(header, body, left=2)


def context(material: Material) -> Mapping[str, Any]:
    table, described = released(), []
    for engine in table.engines:
        entries, versions = table.of(engine), table.versions(engine)
        newest = [entry for entry in entries if entry.version == versions[-1]]
        described.append(
            {
                "name": engine,
                "versions": versions,
                "table": version_table(table, engine),
                "refused": sum(entry.outcome == Outcome.UNSUPPORTED for entry in newest),
                "trees": [(e.variant, e.sentence, e.error) for e in newest if e.quantity == ACCELERATION],
                "marks": [(version, mark) for (name, version), mark in table.marks.items() if name == engine],
                "lines": len({(entry.scene, entry.variant) for entry in entries}),
            }
        )
    return {"engines": described, "cost_rose_in": COST_ROSE_IN}


def figures(material: Material) -> Mapping[str, str]:
    table = released()
    return {
        f"{name}_heat": svg(heat_map(table.of(name), table.versions(name)), f"{name}: errors of scenes by version")
        for name in table.engines
    }


PAGE = Page(
    name="versions",
    title="Versions",
    lesson="What changed when an engine was upgraded: errors and costs of every scene over released versions.",
    context=context,
    figures=figures,
)
