"""The page of faults: for each the script, what it prints, the wrong formula, releases, and what to do instead."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
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
    Equalities,
    Grooves,
    Offsets,
    across,
    beside,
    wrong,
)
from reports.pages.faults.scripts import (
    FOLDER,
    MATCHED,
    MJX,
    MUJOCO,
    OWN_TESTS,
    PATCHED,
    PYMUNK,
    Found,
    Script,
    recorded,
    script,
    source,
)
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg
from reports.write.tables import markdown, number
from reports.write.templates import anchor, environment, headings

NAME = "faults"
LOOKED_UP = "2026-11-23"  # when threads were looked for
SCRIPTS: Mapping[str, Script] = {name: script(name) for name in (*MUJOCO, *PYMUNK, *MJX)}
GROOVES = tuple(map(Grooves, CASES))
EQUALITIES = tuple(map(Equalities, KINDS))
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


@dataclass(frozen=True)
class Fault:
    """One entry of the page, and a file to paste into a tracker; its words are the template entries/`name`.md.

    `scripts` and `costs` show it, at one instant and over time, with the newest release or the last that has it,
    `wrong`; `mended` adds the missing term from outside.
    """

    name: str
    releases: str
    scripts: tuple[str, ...]
    costs: tuple[str, ...] = ()
    mended: tuple[str, ...] = ()
    patch: str = ""


ALL = "all tried"
FAULTS = (
    Fault(
        "pymunk_groove",
        ALL,
        ("pymunk_groove", "pymunk_groove_moving"),
        ("pymunk_groove_cost",),
        patch="pymunk_groove.patch",
    ),
    Fault(
        "pymunk_kinetic_energy",
        ALL,
        ("pymunk_kinetic_energy",),
        ("pymunk_kinetic_energy_cost",),
        patch="pymunk_kinetic_energy.patch",
    ),
    Fault(
        "mujoco_curved_equalities",
        ALL,
        ("mujoco_joint_equality", "mujoco_tendon_equality"),
        ("mujoco_joint_equality_cost", "mujoco_tendon_equality_cost"),
        ("mujoco_joint_equality_mended", "mujoco_tendon_equality_mended"),
    ),
    Fault("mujoco_site_near_origin", ALL, ("mujoco_site_near_origin",)),
    Fault("mujoco_loop", "before 3.7.0", ("mujoco_loop",), ("mujoco_loop_cost",)),
    Fault("mujoco_sparse", "4.0.0", ("mujoco_sparse",), ("mujoco_sparse_cost",)),
    Fault("mjx_loop", f"{MATCHED}, known", ("mjx_loop",), ("mjx_loop_cost",)),
)


def _of(rows: tuple[Found, ...], name: str) -> list[Found]:
    """What a script printed, by release, oldest first."""
    return [row for row in rows if row.script == name]


def found_line(rows: tuple[Found, ...], name: str) -> str:
    """What the last release with the fault finds, then the first that is mended, or our build."""
    own = _of(rows, name)
    faulty = [row for row in own if not row.right][-1]
    line = f"{faulty.package} {faulty.version}: expected **{faulty.expected!r}**, found **{faulty.found!r}**"
    mended = next((row for row in own[own.index(faulty) :] if row.right), None)
    if mended is None:
        return f"{line}."
    ours = mended.version.endswith(PATCHED)
    return f"{line}. {'With our patch' if ours else f'Mended in {mended.version}'}: found **{mended.found!r}**."


def told(fault: Fault, layout: str) -> str:
    """The entry of a fault as a part of the page or as a file to paste."""
    rows = recorded()
    seen = [row for name in fault.scripts for row in _of(rows, name)]
    wrong_in = list(dict.fromkeys(f"{row.package} {row.version}" for row in seen if not row.right))
    right_in = list(dict.fromkeys(f"{row.package} {row.version}" for row in seen if row.right))
    last = {name: [row for row in _of(rows, name) if not row.right][-1] for name in fault.scripts}
    proof = [f"* `{name}.py`: {row.printed}." for name in fault.mended for row in _of(rows, name)]
    if fault.patch and layout == "issue":
        proof.append(own_tests(rows))
    scripts = [(name, source(name), last[name].printed) for name in fault.scripts]
    scripts += [(name, source(name), row.printed) for name in fault.mended for row in _of(rows, name)]
    costs = {name: _of(rows, name) for name in fault.costs}
    return (
        environment()
        .get_template(f"faults/entries/{fault.name}.md")
        .render(
            layout=f"faults/{layout}.md",
            fault=fault,
            looked_up=LOOKED_UP,
            matched=MATCHED,
            seen_line="  \n".join(found_line(rows, name) for name in fault.scripts),
            costs="\n\n".join(cost_text(row) for own in costs.values() for row in own),
            cost_scripts=[(name, source(name), [cost_text(row) for row in own]) for name, own in costs.items()],
            scripts=scripts,
            versions=f"Wrong: {', '.join(wrong_in)}. "
            + (f"Right: {', '.join(right_in)}. " if right_in else "")
            + f"{next(iter(last.values())).machine}.",
            patches=[(FOLDER / fault.patch).read_text(encoding="utf-8")] if fault.patch else [],
            proof="\n".join(proof),
        )
    )


def own_tests(rows: tuple[Found, ...]) -> str:
    """How pymunk's own tests end with the release and with our build."""
    lines = (f"* {row.version}: {', '.join(row.printed.splitlines())}." for row in _of(rows, OWN_TESTS))
    return "\n".join(lines)


def cost_text(row: Found) -> str:
    """What a script printed of the costs, with the build told where it is ours."""
    first, _, rest = row.printed.partition("\n")
    return f"{first}{PATCHED if row.version.endswith(PATCHED) else ''}\n{rest}"


def further(material: Material) -> dict[str, str]:
    """The files to paste, one for each fault."""
    return {f"upstream/{fault.name}.md": told(fault, "issue") for fault in FAULTS}


def words(material: Material) -> Mapping[str, Any]:
    """The entries from what releases printed; what the random models said, absent where nothing was run."""
    build = [row for row in _of(recorded(), "pymunk_groove_random") if row.version.endswith(PATCHED)]
    ours = {line[:24].strip(): line.split()[-1] for row in build for line in row.printed.splitlines()}
    grooves = [
        [
            task.case,
            f"{int(np.sum(off > WRONG))} of {len(off)}",
            number(float(np.median(off))),
            number(float(off.max())),
            number(answer.number("missed")),
            ours.get(task.case, ""),
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
            "" if task.kind == "connect" else number(float(answer.array("mended").max())),
        ]
        for task in EQUALITIES
        if (answer := material.finished(task))
        for off in (answer.array("off"),)
    ]
    entries = {fault.name: told(fault, "entry") for fault in FAULTS}
    listed = [
        [f"[{title}](#{anchor(title)})", fault.releases]
        for fault in FAULTS
        for title in headings(entries[fault.name])[:1]
    ]
    header = ["", "wrong", "median", "largest", "off the wrong formula, at most"]
    mended = "off the right one with our patch"
    return {
        "entries": entries,
        "own_tests": own_tests(recorded()),
        "looked_up": LOOKED_UP,
        "listed": markdown(["fault", "releases"], listed),
        "grooves": markdown(["groove in, anchor at", *header[1:], mended], grooves) if grooves else "",
        "equalities": markdown(["equality", *header[1:], "off the right one with the term added"], equalities)
        if equalities
        else "",
        "unfinished": {
            name: material.unfinished(task) for name, task in SCRIPTS.items() if not material.finished(task)
        },
        "wrong": WRONG,
        "off": OFF,
    }


PAGE = Page(
    name=NAME,
    title="Faults of released engines",
    lesson="Wrong in a release, not soft or coarse: the formula behind it, what it costs, what to send to its authors.",
    scenes=(),
    engines=(),
    companions=(DrivenFourBar(), FreeFourBar(), SpinningFourBar(), DrivenSliderCrank()),
    figures=figures,
    words=words,
    further=further,
    tasks=(*SCRIPTS.values(), *GROOVES, *EQUALITIES, OFFSETS),
)
