"""The page of versions: everything on it is read from one file of rows; steps are found in it, and then looked up."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.plots.looks import SHADE_NAMES, outcome_colour, shade
from reports.plots.theme import LIGHT, SERIES, Theme, new_figure, settings, style_axes, svg
from reports.versions.catalogue import COST_ROSE_IN, changes_between
from reports.versions.comparison import Step, by_version, steps
from reports.versions.table import ACCELERATION, Entry, Table, catalogued, read
from reports.write.tables import markdown, number

MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")


def variants(entries: Sequence[Entry]) -> tuple[str, ...]:
    """The methods in the order in which they stand in every table."""
    found = dict.fromkeys(entry.variant for entry in entries)
    usual = ("default", "tuned", "extended")
    return (*(each for each in usual if each in found), *sorted(each for each in found if each not in usual))


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


def _look(entry: Entry, theme: Theme) -> tuple[str, str]:
    """(colour, letters) of a cell. The letter of a failure needs no hatch, which would make it unreadable."""
    if not entry.comparable:
        outcome = Outcome(entry.outcome)
        return outcome_colour(outcome, theme), outcome.letter
    power = math.floor(math.log10(entry.error)) if entry.error > 0 and math.isfinite(entry.error) else None
    return getattr(theme, shade(entry.error)), "0" if power is None else f"{power}"


def _cell(panel: Axes, column: int, row: int, entry: Entry, theme: Theme) -> None:
    colour, letters = _look(entry, theme)
    # No patch: the limits are given, and need not follow each of some thousand cells.
    panel.add_artist(Rectangle((column, row), 1, 1, facecolor=colour, edgecolor=theme.paper, linewidth=1))
    panel.text(column + 0.5, row + 0.5, letters, ha="center", va="center", color=theme.ink, fontsize=7, in_layout=False)


def _legend(figure: Figure, entries: Sequence[Entry], theme: Theme) -> None:
    colours = {name: getattr(theme, role) for role, name in SHADE_NAMES.items()}
    for outcome in Outcome:
        if any(not entry.comparable and entry.outcome == outcome for entry in entries):
            told = "our adapter builds none" if outcome is Outcome.UNSUPPORTED else outcome
            colours[f"{outcome.letter}  {told}"] = outcome_colour(outcome, theme)
    patches = [Rectangle((0, 0), 1, 1, facecolor=colour, edgecolor=theme.quiet) for colour in colours.values()]
    figure.legend(patches, list(colours), loc="outside lower center", ncols=4)


def cost(entries: Sequence[Entry], versions: Sequence[str], theme: Theme = LIGHT) -> Figure:
    """CPU time of stepping over that of the newest version: the median of the scenes, and the middle half of them."""
    with settings():
        figure = new_figure(3.0, theme)
        panel = figure.subplots()
        style_axes(panel, theme)
        for index, (method, found) in enumerate(ratios_by_method(entries, versions).items()):
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
        figure.legend(loc="outside lower center", ncols=4)
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


def ratios_by_method(entries: Sequence[Entry], versions: Sequence[str]) -> dict[str, dict[str, list[float]]]:
    """The same of every method that has any."""
    return {method: found for method in variants(entries) if (found := ratios(entries, versions, method))}


DATA = Path(__file__).parents[2] / "results" / "versions.csv"
EXAMPLES = 2  # of each kind of step that are told


@cache
def table(path: Path = DATA) -> Table:
    """What was kept of all versions that are compared by now."""
    return catalogued(read(path))


def _told(entry: Entry) -> str:
    return number(entry.error) if entry.comparable else f"**{entry.outcome}**"


def _example(found: Sequence[Step]) -> str:
    """'free four bar, tuned: 7.4e-4 to 9.6e-7' of the largest steps."""

    def factor(step: Step) -> float:
        if not (step.before.comparable and step.after.comparable):
            return 1.0
        return abs(np.log(max(step.after.error, 1e-300) / max(step.before.error, 1e-300)))

    largest = sorted(found, key=factor, reverse=True)[:EXAMPLES]
    return "; ".join(
        f"{step.after.scene.replace('_', ' ')}, {step.after.variant}: {_told(step.before)} to {_told(step.after)}"
        for step in largest
    )


def on_edge(found: Sequence[Step]) -> tuple[tuple[str, str], ...]:
    """(scene, variant) of lines with steps for the better and for the worse, none of which is known by name."""
    lines: dict[tuple[str, str], list[Step]] = {}
    for step in found:
        lines.setdefault((step.after.scene, step.after.variant), []).append(step)
    return tuple(
        line
        for line, own in lines.items()
        if len({step.worse for step in own}) == 2
        and not any(changes_between(s.after.engine, s.before.version, s.after.version, s.worse) for s in own)
    )


def step_table(own: Table, engine: str) -> str:
    """A line for every pair of neighbouring versions between which lines have steps; empty without any.

    Lines that go to and fro without a known change stand on an edge between two outcomes, and are left out.
    """
    body = []
    found_steps = steps([entry for entry in own.entries if entry.engine == engine])
    edges = on_edge(found_steps)
    kept = [step for step in found_steps if (step.after.scene, step.after.variant) not in edges]
    for (_, before, after), found in by_version(kept).items():
        for worse in (False, True):
            own_way = [step for step in found if step.worse == worse]
            if own_way:
                known = changes_between(engine, before, after, worse)
                told = "; ".join(f"{each.version}: {each.changed} ([source]({each.source}))" for each in known)
                way = f"{len(own_way)} **worse**" if worse else f"{len(own_way)} better"
                body.append([f"{before} to {after}", way, _example(own_way), told or "no change is known by name"])
    header = ["between", "lines", "largest steps", "what is known of the newer version"]
    return markdown(header, body, left=4) if body else ""


def cost_table(own: Table, engine: str) -> str:
    """The median of the scenes' CPU times over those of the newest version, a line a version."""
    entries, versions = [e for e in own.entries if e.engine == engine], own.versions(engine)
    found = ratios_by_method(entries, versions)
    body = [
        [version, *(f"{np.median(own[version]):.2f}" if version in own else "-" for own in found.values())]
        for version in versions
    ]
    return markdown(["version", *found], body) if found else ""


def words(material: Material) -> Mapping[str, Any]:
    """A dictionary an engine; nothing else on the page has numbers."""
    own = table()
    told = []
    for engine in own.engines:
        entries = [entry for entry in own.entries if entry.engine == engine]
        versions = own.versions(engine)
        told.append(
            {
                "name": engine,
                "versions": versions,
                "steps": step_table(own, engine),
                "edges": [f"{scene.replace('_', ' ')}, {variant}" for scene, variant in on_edge(steps(entries))],
                "refused": sum(
                    entry.outcome == Outcome.UNSUPPORTED for entry in entries if entry.version == versions[-1]
                ),
                "trees": [
                    (entry.variant, entry.sentence, entry.error)
                    for entry in entries
                    if entry.quantity == ACCELERATION and entry.version == versions[-1]
                ],
                "cost": cost_table(own, engine),
                "marks": [(version, mark) for (name, version), mark in own.marks.items() if name == engine],
                "scenes": len({entry.scene for entry in entries}),
                "lines": len({(entry.scene, entry.variant) for entry in entries}),
            }
        )
    return {"engines": told, "cost_rose_in": COST_ROSE_IN}


def figures(material: Material) -> Mapping[str, str]:
    """A heat table and the cost of each engine, in the order of the page."""
    own, out = table(), {}
    for engine in own.engines:
        entries, versions = [e for e in own.entries if e.engine == engine], own.versions(engine)
        out[f"{engine}_heat"] = svg(heat_table(entries, versions), f"{engine}: errors of scenes by version")
        out[f"{engine}_cost"] = svg(cost(entries, versions), f"{engine}: CPU time over versions")
    return out


PAGE = Page(
    name="versions",
    title="Versions",
    lesson="What changed when an engine was upgraded: errors and costs of every scene over released versions.",
    scenes=(),
    engines=(),
    words=words,
    figures=figures,
)
