"""The page of versions: everything on it is read from one file of rows; steps are found in it, and then looked up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages.versions.chart import cost, heat_table, over_versions, ratios, variants
from reports.plots.theme import svg
from reports.versions.catalogue import changes_between
from reports.versions.comparison import Step, by_version, steps
from reports.versions.table import ACCELERATION, Entry, Table, catalogued, read
from reports.write.tables import markdown, number

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
    methods = [method for method in variants(entries) if ratios(entries, versions, method)]
    found = {method: ratios(entries, versions, method) for method in methods}
    body = [
        [version, *(f"{np.median(found[m][version]):.2f}" if version in found[m] else "-" for m in methods)]
        for version in versions
    ]
    return markdown(["version", *methods], body) if methods else ""


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
                "milliseconds": sorted({1e3 * entry.step for entry in entries if entry.step > 0}),
            }
        )
    return {"engines": told}


def figures(material: Material) -> Mapping[str, str]:
    """A picture of lines, a heat table and the cost of each engine, in the order of the page."""
    own, out = table(), {}
    for engine in own.engines:
        entries, versions = [e for e in own.entries if e.engine == engine], own.versions(engine)
        at = {after: after for (_, _, after) in by_version(steps(entries))}
        out[f"{engine}_lines"] = svg(over_versions(entries, versions, at), f"{engine}: error over versions")
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
