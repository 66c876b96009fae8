"""The page of faults: for each the script, what it prints, the wrong formula, releases, and what to do instead."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reports.model.page import Material, Page
from reports.pages.faults.experiments import (
    CASES,
    KINDS,
    WRONG,
    Bead,
    Equalities,
    Grooves,
    Offsets,
    across,
    beside,
    wrong,
)
from reports.pages.faults.scripts import MJX, MUJOCO, PYMUNK, Script, recorded, script
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg
from reports.write.tables import markdown, number

NAME = "faults"
SNIPPETS = "faults/snippets"
SCRIPTS: Mapping[str, Script] = {name: script(name) for name in (*MUJOCO, *PYMUNK, *MJX)}
GROOVES = tuple(map(Grooves, CASES))
EQUALITIES = tuple(map(Equalities, KINDS))
BEADS = (Bead(1e-2), Bead(1e-4), Bead(1e-3, tied=True), Bead(1e-4, tied=True))
OFFSETS = Offsets(tuple(np.geomspace(0.05, 5.0, 13).round(6).tolist()))
# Beyond this an equality counts as wrong, of its accelerations: rows with 1e-4 of softness agree far better.
OFF = 1e-4


def draw_offsets(measured: np.ndarray, theme: Theme = LIGHT) -> Figure:
    """What the groove makes of a body that slides along it, against the offset of its anchor."""
    with settings():
        figure = new_figure(3.4, theme, 6.4)
        axes = figure.subplots()
        fine = np.geomspace(OFFSETS.offsets[0], OFFSETS.offsets[-1], 200).tolist()
        line = [-across(setup, setup.predicted(wrong)) for setup in map(beside, fine)]
        axes.loglog(fine, line, color=theme.first, linewidth=2, label="the wrong formula")
        axes.loglog(OFFSETS.offsets, -measured, "o", color=theme.ink, markersize=5, label="pymunk, measured")
        axes.set_xlabel("anchor's distance from the centre of mass [m]")
        axes.set_ylabel("velocity across the groove\nafter a step, should be 0 [m/s]")
        style_axes(axes, theme)
        axes.legend(loc="lower right")
    return figure


def figures(material: Material) -> dict[str, str]:
    """The groove's chart, if it was measured."""
    answer = material.finished(OFFSETS)
    if answer is None:
        return {}
    title = "Velocity that a groove creates across itself, against its anchor's offset"
    return {"groove": svg(draw_offsets(answer.array("across")), title)}


def versions_table(names: tuple[str, ...]) -> str:
    """What scripts find, by release."""
    rows = [row for row in recorded() if row.script in names]
    releases = list(dict.fromkeys((row.package, row.version) for row in rows))
    body = []
    for package, version in releases:
        own = {row.script: row for row in rows if (row.package, row.version) == (package, version)}
        cells = [f"{own[name].found:.6g}" if own[name].right else f"**{own[name].found:.6g}**" for name in names]
        body.append([f"{package} {version}", *cells])
    wanted = [f"{next(row.expected for row in reversed(rows) if row.script == name):.6g}" for name in names]
    return markdown(["release", *(f"`{name}.py`" for name in names)], [["*expected*", *wanted], *body])


def words(material: Material) -> Mapping[str, Any]:
    """What the scripts and the random models said, by name; absent where nothing was run."""
    said = {name: answer for name, task in SCRIPTS.items() if (answer := material.finished(task))}
    printed = {
        name: {
            "expected": repr(answer.number("expected")),
            "found": repr(answer.number("found")),
            "version": str(answer.values["version"]),
        }
        for name, answer in said.items()
    }
    grooves = [
        [
            task.case,
            f"{int(np.sum(off > WRONG))} of {len(off)}",
            number(float(np.median(off))),
            number(float(off.max())),
            number(answer.number("missed")),
        ]
        for task in GROOVES
        if (answer := material.finished(task))
        for off in (answer.array("off"),)
    ]
    equalities = [
        [
            task.kind,
            f"{int(np.sum(off > OFF))} of {len(off)}",
            number(float(np.median(off))),
            number(float(off.max())),
            number(float(answer.array("missed").max())),
        ]
        for task in EQUALITIES
        if (answer := material.finished(task))
        for off in (answer.array("off"),)
    ]
    header = ["", "wrong", "median", "largest", "from the other formula, at most"]
    return {
        "printed": printed,
        "unfinished": {name: material.unfinished(task) for name, task in SCRIPTS.items() if name not in printed},
        "snippets": SNIPPETS,
        "grooves": markdown(["groove in, anchor at", *header[1:]], grooves) if grooves else "",
        "equalities": markdown(["equality", *header[1:]], equalities) if equalities else "",
        "mujoco_versions": versions_table(MUJOCO),
        "pymunk_versions": versions_table(PYMUNK),
        "beads": [(task.step, answer.number("gap")) for task in BEADS if (answer := material.finished(task))],
        "faulty": {row.script: row for row in recorded() if not row.right},  # the last release of each
        "wrong": WRONG,
        "off": OFF,
    }


PAGE = Page(
    name=NAME,
    title="Faults of released engines",
    lesson="Wrong in a release, not soft or coarse: the shortest script, and the formula that it computes instead.",
    scenes=(),
    engines=(),
    companions=(DrivenFourBar(), FreeFourBar(), SpinningFourBar(), DrivenSliderCrank()),
    figures=figures,
    words=words,
    tasks=(*SCRIPTS.values(), *GROOVES, *EQUALITIES, *BEADS, OFFSETS),
)
