"""Findings for every user of pymunk or MuJoCo. A finding is left out if its rows contradict it.

`findings.toml` has the text, rows, claims and picture of each finding. The functions in FURTHER_NAMES add numbers from
releases and scripts.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.model.cells import is_step
from reports.model.convergence import Verdict
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.model.tasks import Answer, Task
from reports.pages.faults.page import OFFSETS, SCRIPTS, is_right
from reports.plots.looks import colour
from reports.plots.theme import LIGHT, drawing, label_decades, style_axes, svg
from reports.versions.table import ACCELERATION, COST_ROSE_IN, Entry, relative_cost, released, wrong_trees
from reports.write.page_tables import COMPARED_STEP, advice
from reports.write.rows import Rows, rows_of_pages
from reports.write.templates import environment, template
from reports.write.unmeasured import UNKNOWN_MARK, UNMEASURED

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Size of a picture in inches. In a browser the picture has the width of a telephone's screen, 360 pixels.
PICTURE_WIDTH, PICTURE_HEIGHT = 3.75, 2.55
# Styles (dashes, mark, whether the mark is filled) of the lines in a picture. Lines may have the same colour.
LINE_STYLES = ((":", "o", False), ("--", "s", True), ("-", "D", True), ("-.", "^", False))
STEP_AXIS, CPU_AXIS, RELEASE_AXIS = "step [ms]", "CPU time [ms per simulated second]", "release"
TENTH_OF_MS = 1e-4  # s


@dataclass(frozen=True)
class PlottedLine:
    """A line of a picture with the points (x, y) of one engine; x is a number or a release."""

    label: str
    engine: str
    points: tuple[tuple[Any, float], ...]


def of_rows(label: str, rows: Rows, name: str, x: str = STEP_AXIS) -> PlottedLine:
    """The line with the errors of a quantity against step or CPU time; the largest step is first."""
    engine = rows[0].engine if rows else ""
    if x == CPU_AXIS:
        usable = [row for row in rows.known(name) if row.cpu > 0 and Outcome(row.outcome).comparable]
        return PlottedLine(label, engine, tuple((1e3 * row.cpu, getattr(row, name)) for row in usable))
    return PlottedLine(label, engine, tuple((1e3 * step, error) for step, error in rows.points(name)))


def of_releases(label: str, entries: Iterable[Entry]) -> PlottedLine:
    """The line with the errors of one scene and method against the release; the oldest release is first."""
    usable = [entry for entry in entries if entry.comparable and entry.error > 0]
    engine = usable[0].engine if usable else ""
    return PlottedLine(label, engine, tuple((entry.version, entry.error) for entry in usable))


def draw(lines: Sequence[PlottedLine], x: str, y: str) -> Figure:
    """A chart with logarithmic axes; releases are equally spaced. Raises ValueError for more than four lines."""
    if len(lines) > len(LINE_STYLES):
        raise ValueError(f"a finding's picture has {len(lines)} lines; it must have at most {len(LINE_STYLES)}")
    with drawing(PICTURE_HEIGHT, width=PICTURE_WIDTH) as figure:
        axes = figure.subplots()
        for line, (dashes, mark, filled) in zip(lines, LINE_STYLES, strict=False):
            if not line.points:
                continue
            paint = colour(line.engine)
            face = paint if filled else LIGHT.paper
            marks = {"marker": mark, "markersize": 5, "markerfacecolor": face, "markeredgecolor": paint}
            axes.plot(
                *zip(*line.points, strict=True), label=line.label, color=paint, linestyle=dashes, linewidth=1.6, **marks
            )
        axes.set_yscale("log")
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        style_axes(axes)
        if x == RELEASE_AXIS:
            axes.tick_params(axis="x", labelrotation=60, labelsize=7)
        else:
            axes.set_xscale("log")
            label_decades(axes.xaxis, 7, label="{:g}".format)
        label_decades(axes.yaxis, 7)
        axes.minorticks_off()
        figure.legend(loc="outside upper left", ncols=1, handlelength=3.2, fontsize=8.5)
    return figure


@dataclass(frozen=True)
class Sources:
    """The rows and answers of all pages, from which findings are computed."""

    rows: Rows
    answers: Mapping[Task, Answer] = field(default_factory=dict)

    @classmethod
    def of(cls, pages: Mapping[Page, Material]) -> Sources:
        answers = {task: answer for material in pages.values() for task, answer in material.answers.items()}
        return cls(rows_of_pages(pages), answers)


@dataclass(frozen=True)
class Finding:
    """A finding with its numbers. title, text: text in Markdown without the link to `page`. contradicted: claims that
    the rows do not confirm. lines, x, y: the lines of the picture and the labels of its axes."""

    name: str
    page: str
    title: str
    text: str
    contradicted: tuple[str, ...]
    lines: tuple[PlottedLine, ...]
    x: str
    y: str

    @property
    def is_sound(self) -> bool:
        return not self.contradicted and UNKNOWN_MARK not in self.text

    @property
    def picture(self) -> str:
        return f"finding_{self.name}.svg"

    @property
    def alternative(self) -> str:
        return f"{self.y} against {self.x}: {'; '.join(line.label for line in self.lines)}"

    def figure(self) -> Figure:
        return draw(self.lines, self.x, self.y)


# --- functions that the expressions of `findings.toml` can use ---


def error_at(rows: Rows, step: float, name: str) -> float:
    """The error of a quantity at a step [s], or NaN if no row has this step. Failed runs count."""
    return next((error for row_step, error in rows.points(name) if is_step(row_step, step)), math.nan)


def least(rows: Rows, name: str) -> float:
    """The least error of a quantity, or NaN without rows. Failed runs count."""
    return min((error for _, error in rows.points(name)), default=math.nan)


def duration(rows: Rows) -> float:
    """The duration of the scene [s], or NaN without rows."""
    return next((row.samples * row.every * row.step for row in rows), math.nan)


EXPRESSION_NAMES: Mapping[str, Any] = {
    "MS": COMPARED_STEP,
    "TENTH": TENTH_OF_MS,
    "PLATEAU": Verdict.PLATEAU,
    "UNMEASURED": UNMEASURED,
    "error_at": error_at,
    "least": least,
    "duration": duration,
}


def releases(sources: Sources) -> dict[str, Any]:
    """Errors of stiff loops in releases of MuJoCo, and relative costs of a step with default settings."""
    entries, versions = released().of("mujoco"), released().versions("mujoco")
    lines = {
        scene: [entry for entry in entries if (entry.scene, entry.variant) == (scene, "tuned")]
        for scene in ("free_four_bar", "spinning_four_bar", "driven_slider_crank")
    }
    error = {entry.version: entry.error for entry in lines["free_four_bar"]}
    old, new, newest = (error.get(version, math.nan) for version in ("3.6.0", "3.7.0", versions[-1]))
    cost = relative_cost(entries, versions, "default")
    oldest, later = (cost.get(version, math.nan) for version in (versions[0], "3.3.7"))
    numbers = {"old": old, "new": new, "newest": newest, "oldest": oldest, "later": later}
    plotted = {scene: of_releases(scene, of_scene) for scene, of_scene in lines.items()}
    return {**numbers, **plotted, "first": versions[0], "rose_in": COST_ROSE_IN}


def trees(sources: Sources) -> dict[str, Any]:
    """Acceleration errors of MuJoCo's variants "tuned" and "extended" in random trees with loops."""
    newest = released().versions("mujoco")[-1]
    entries = [entry for entry in released().of("mujoco") if entry.quantity == ACCELERATION]
    last = {entry.variant: entry for entry in entries if entry.version == newest}
    many, total = wrong_trees(last["tuned"]) if "tuned" in last else (0, 0)
    soft, hard = (last[variant].error if variant in last else math.nan for variant in ("tuned", "extended"))
    plotted = {
        variant: of_releases(variant, [entry for entry in entries if entry.variant == variant])
        for variant in ("tuned", "extended")
    }
    return {"newest": newest, "many": many, "all": total, "soft": soft, "hard": hard, **plotted}


# Script on the page of faults -> the fault that it shows.
FAULTS_OF_SCRIPTS: Mapping[str, str] = {
    "pymunk_groove": "a `GrooveJoint` off the centre of mass creates velocity across itself",
    "pymunk_kinetic_energy": "`Body.kinetic_energy` is twice the kinetic energy",
    "mujoco_joint_equality": "a curved `equality/joint` lacks its velocity term",
    "mujoco_tendon_equality": "so does `equality/tendon`",
    "mujoco_site_near_origin": "a site within a micrometre of its body's origin is moved to the origin",
}


def faults(sources: Sources) -> dict[str, Any]:
    """The faults that scripts show in the installed releases, and the number of scripts without a fault."""
    wrong, missing = [], 0
    for title in ("pymunk", "MuJoCo"):
        sentences, release = [], UNKNOWN_MARK
        for name, sentence in FAULTS_OF_SCRIPTS.items():
            if name.startswith(title.lower()):
                answer = sources.answers.get(SCRIPTS[name])
                if answer is None or not answer.finished or is_right(answer.number("expected"), answer.number("found")):
                    missing += 1
                else:
                    sentences.append(sentence)
                    release = str(answer.values["version"])
        wrong.append(f"{title} {release}: {'; '.join(sentences)}.")
    answer = sources.answers.get(OFFSETS)
    across = answer.array("across") if answer is not None and answer.finished else np.array([])
    groove = PlottedLine("", "pymunk", tuple(zip(OFFSETS.offsets, -across, strict=False)))
    return {"wrong": " ".join(wrong), "missing": missing, "groove": groove}


def exact(sources: Sources) -> dict[str, Any]:
    """CPU times on the free four-bar. `fine`: engine -> least CPU time for an error of 1e-6 rad. `wins`: whether
    `lagrange` is cheaper, by target and engine."""
    settings = advice(sources.rows.of("free_four_bar"), "angle")
    rows = {(setting.engine, target): setting.row for setting in settings for target in setting.targets}
    cost = {key: row.cpu if row is not None and row.cpu > 0 else math.inf for key, row in rows.items()}

    def of(engine: str, target: float) -> float:
        return cost.get((engine, target), math.nan)

    targets = {target for _, target in rows}
    wins = [of("lagrange", target) < of(engine, target) for target in targets for engine in ("mujoco", "pymunk")]
    return {"fine": {engine: of(engine, 1e-6) for engine in ("lagrange", "mujoco", "pymunk")}, "wins": wins}


FURTHER_NAMES: Mapping[str, Callable[[Sources], dict[str, Any]]] = {
    "releases": releases,
    "trees": trees,
    "faults": faults,
    "exact": exact,
}
FINDING_PLANS: Mapping[str, Mapping[str, Any]] = tomllib.loads(
    Path(__file__).with_name("findings.toml").read_text(encoding="utf-8")
)


@cache
def _expression(text: str) -> Callable[..., Any]:
    return environment().compile_expression(text, undefined_to_none=False)


def finding(name: str, sources: Sources) -> Finding:
    plan = FINDING_PLANS[name]
    names = {**EXPRESSION_NAMES, **(FURTHER_NAMES[name](sources) if name in FURTHER_NAMES else {})}
    names |= {rows: sources.rows.of(*selection) for rows, selection in plan.get("rows", {}).items()}
    for number, expression in plan.get("let", {}).items():
        names[number] = _expression(expression)(names)
    compared, x = plan.get("quantity", "angle"), plan.get("x", STEP_AXIS)
    lines = []
    for label, line in plan["lines"].items():
        rows_name, plotted = (line, compared) if isinstance(line, str) else line
        rows = names[rows_name]
        lines.append(of_rows(label, rows, plotted, x) if isinstance(rows, Rows) else replace(rows, label=label))
    text = template(" ".join(plan["text"].split())).render(names)
    contradicted = tuple(claim for claim in plan["holds"] if not _expression(claim)(names))
    y = plan.get("y", quantity(compared).heading)
    return Finding(name, plan["page"], plan["title"], text, contradicted, tuple(lines), x, y)


def findings(pages: Mapping[Page, Material]) -> list[Finding]:
    """The findings that the rows confirm and that a page in `pages` explains, in the order of `findings.toml`."""
    sources, names = Sources.of(pages), {page.name for page in pages}
    candidates = (finding(name, sources) for name in FINDING_PLANS)
    return [candidate for candidate in candidates if candidate.is_sound and candidate.page in names]


def pictures(sound: Iterable[Finding]) -> dict[str, str]:
    return {finding.picture: svg(finding.figure(), finding.title) for finding in sound}
