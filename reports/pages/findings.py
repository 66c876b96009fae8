"""Findings that every user of pymunk or MuJoCo should know, each dropped where its rows contradict it.

`findings.toml` has their sentences, the rows that these are about, the claims that must hold, and the lines of a small
picture for telephones. What is no row, releases and answers of scripts, is read by the functions of FURTHER.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from reports.model.cells import is_step
from reports.model.convergence import Verdict
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.model.tasks import Answer, Task
from reports.pages.faults.page import OFFSETS, SCRIPTS, is_right
from reports.plots.looks import colour
from reports.plots.theme import LIGHT, drawing, style_axes, svg
from reports.versions.catalogue import COST_ROSE_IN
from reports.versions.table import ACCELERATION, Entry, relative_cost, released
from reports.write.page_tables import COMPARED, advice
from reports.write.rows import Rows, own_rows
from reports.write.templates import environment, template
from reports.write.unmeasured import MARK, UNMEASURED

# Inches, 360 pixels of a browser: a telephone shows it unscaled, so that the letters keep their size.
WIDTH, HEIGHT = 3.75, 2.55
# Dashes, mark and whether it is filled, by position: lines of one colour, and all of them in grey, differ.
LOOKS = ((":", "o", False), ("--", "s", True), ("-", "D", True), ("-.", "^", False))
STEP, CPU, RELEASE = "step [ms]", "CPU time [ms per simulated second]", "release"
TENTH = 1e-4  # s


@dataclass(frozen=True)
class PlottedLine:
    """Points (x, y) of one engine under a label that a reader understands; x is a number or a release."""

    label: str
    engine: str
    points: tuple[tuple[Any, float], ...]


def of_rows(label: str, rows: Rows, name: str, x: str = STEP) -> PlottedLine:
    """The errors of a quantity of this name in rows, from coarse to fine, against the step or the CPU time."""
    engine = rows[0].engine if rows else ""
    if x == CPU:
        usable = [row for row in rows.known(name) if row.cpu > 0 and Outcome(row.outcome).comparable]
        return PlottedLine(label, engine, tuple((1e3 * row.cpu, getattr(row, name)) for row in usable))
    return PlottedLine(label, engine, tuple((1e3 * step, error) for step, error in rows.points(name)))


def of_releases(label: str, entries: Iterable[Entry]) -> PlottedLine:
    """The errors of one scene and method, from the oldest release to the newest."""
    shown = [entry for entry in entries if entry.comparable and entry.error > 0]
    return PlottedLine(label, shown[0].engine if shown else "", tuple((entry.version, entry.error) for entry in shown))


def draw(lines: Sequence[PlottedLine], x: str, y: str) -> Figure:
    """Lines against x, both axes logarithmic, but for releases, which stand side by side; an engine has its own colour.

    Raises ValueError for more lines than there are looks.
    """
    if len(lines) > len(LOOKS):
        raise ValueError(f"a finding's picture has {len(lines)} lines; it must have at most {len(LOOKS)}")
    with drawing(HEIGHT, width=WIDTH) as figure:
        axes = figure.subplots()
        for line, (dashes, mark, filled) in zip(lines, LOOKS, strict=False):
            if not line.points:
                continue
            paint = colour(line.engine)
            face = paint if filled else LIGHT.paper
            marks = {"marker": mark, "markersize": 5, "markerfacecolor": face, "markeredgecolor": paint}
            shown = zip(*line.points, strict=True)
            axes.plot(*shown, label=line.label, color=paint, linestyle=dashes, linewidth=1.6, **marks)
        axes.set_yscale("log")
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        style_axes(axes)
        if x == RELEASE:
            axes.tick_params(axis="x", labelrotation=60, labelsize=7)
        else:
            axes.set_xscale("log")
            axes.xaxis.set_major_locator(LogLocator(base=10, numticks=7))
            axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_locator(LogLocator(base=10, numticks=7))
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.minorticks_off()
        figure.legend(loc="outside upper left", ncols=1, handlelength=3.2, fontsize=8.5)
    return figure


@dataclass(frozen=True)
class Sources:
    """The source of findings: rows from coarse to fine, and answers to tasks; the releases' rows are a file's."""

    rows: Rows
    answers: Mapping[Task, Answer] = field(default_factory=dict)

    @classmethod
    def of(cls, pages: Mapping[Page, Material]) -> Sources:
        answers = {task: answer for material in pages.values() for task, answer in material.answers.items()}
        return cls(own_rows(pages), answers)


@dataclass(frozen=True)
class Finding:
    """`title` and `text`: Markdown, without the link to the page; `lines`, `x`, `y`: of its picture.

    contradicted: the claims that the rows do not bear out.
    """

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
        """Whether the rows have its numbers and bear its claims out."""
        return not self.contradicted and MARK not in self.text

    @property
    def picture(self) -> str:
        """The name of its file."""
        return f"finding_{self.name}.svg"

    @property
    def alternative(self) -> str:
        """The picture in words, for who can't see it."""
        return f"{self.y} against {self.x}: {'; '.join(line.label for line in self.lines)}"

    def figure(self) -> Figure:
        return draw(self.lines, self.x, self.y)


# --- the names of its expressions ---


def error_at(rows: Rows, step: float, name: str) -> float:
    """The error of a quantity at a step [s], of a failed run too; NaN where there is none."""
    return next((error for taken, error in rows.points(name) if is_step(taken, step)), math.nan)


def least(rows: Rows, name: str) -> float:
    """The least error of a quantity, of failed runs too; NaN where there is none."""
    return min((error for _, error in rows.points(name)), default=math.nan)


def duration(rows: Rows) -> float:
    """How long their scene is [s]; NaN without any."""
    return next((row.samples * row.every * row.step for row in rows), math.nan)


NAMES: Mapping[str, Any] = {
    "MS": COMPARED,
    "TENTH": TENTH,
    "PLATEAU": Verdict.PLATEAU,
    "UNMEASURED": UNMEASURED,
    "error_at": error_at,
    "least": least,
    "duration": duration,
}


def releases(sources: Sources) -> dict[str, Any]:
    """The cure of MuJoCo 3.7.0, by the rows of the releases; and how the cost of a step as shipped has grown."""
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
    plotted = {scene: of_releases(scene, shown) for scene, shown in lines.items()}
    return {**numbers, **plotted, "first": versions[0], "rose_in": COST_ROSE_IN}


def trees(sources: Sources) -> dict[str, Any]:
    """Random trees with loops across, in MuJoCo with the stiffest documented settings and with stiffer rows of ours."""
    newest = released().versions("mujoco")[-1]
    entries = [entry for entry in released().of("mujoco") if entry.quantity == ACCELERATION]
    last = {entry.variant: entry for entry in entries if entry.version == newest}
    many, _, rest = last["tuned"].sentence.partition(" of ") if "tuned" in last else ("0", "", "")
    soft, hard = (last[variant].error if variant in last else math.nan for variant in ("tuned", "extended"))
    plotted = {
        variant: of_releases(variant, [entry for entry in entries if entry.variant == variant])
        for variant in ("tuned", "extended")
    }
    return {"newest": newest, "many": int(many), "all": rest.partition(" ")[0], "soft": soft, "hard": hard, **plotted}


# The fault that each script of the page of faults shows, in a few words.
FAULTS: Mapping[str, str] = {
    "pymunk_groove": "a `GrooveJoint` off the centre of mass creates velocity across itself",
    "pymunk_kinetic_energy": "`Body.kinetic_energy` is twice the kinetic energy",
    "mujoco_joint_equality": "a curved `equality/joint` lacks its velocity term",
    "mujoco_tendon_equality": "so does `equality/tendon`",
    "mujoco_site_near_origin": "a site within a micrometre of its body's origin is put there",
}


def faults(sources: Sources) -> dict[str, Any]:
    """Faults of the installed releases at one instant, by the scripts that were run with them."""
    wrong, missing = [], 0
    for title in ("pymunk", "MuJoCo"):
        words, release = [], MARK
        for name, sentence in FAULTS.items():
            if name.startswith(title.lower()):
                answer = sources.answers.get(SCRIPTS[name])
                if answer is None or not answer.finished or is_right(answer.number("expected"), answer.number("found")):
                    missing += 1
                else:
                    words.append(sentence)
                    release = str(answer.values["version"])
        wrong.append(f"{title} {release}: {'; '.join(words)}.")
    answer = sources.answers.get(OFFSETS)
    across = answer.array("across") if answer is not None and answer.finished else np.array([])
    groove = PlottedLine("", "pymunk", tuple(zip(OFFSETS.offsets, -across, strict=False)))
    return {"wrong": " ".join(wrong), "missing": missing, "groove": groove}


def exact(sources: Sources) -> dict[str, Any]:
    """CPU times of errors of four sizes: `fine`, of 1e-6 rad by engine; `wins`, whether the judge is cheaper."""
    found = advice(sources.rows.of("free_four_bar"), "angle")
    rows = {(each.engine, target): each.row for each in found for target in each.targets}
    cost = {key: row.cpu if row is not None and row.cpu > 0 else math.inf for key, row in rows.items()}

    def of(engine: str, target: float) -> float:
        return cost.get((engine, target), math.nan)

    targets = {target for _, target in rows}
    wins = [of("lagrange", target) < of(engine, target) for target in targets for engine in ("mujoco", "pymunk")]
    return {"fine": {engine: of(engine, 1e-6) for engine in ("lagrange", "mujoco", "pymunk")}, "wins": wins}


FURTHER: Mapping[str, Callable[[Sources], dict[str, Any]]] = {
    "releases": releases,
    "trees": trees,
    "faults": faults,
    "exact": exact,
}
FINDINGS: Mapping[str, Mapping[str, Any]] = tomllib.loads(
    Path(__file__).with_name("findings.toml").read_text(encoding="utf-8")
)


@cache
def _expression(text: str) -> Callable[..., Any]:
    return environment().compile_expression(text, undefined_to_none=False)


def finding(name: str, sources: Sources) -> Finding:
    """The finding of this name with its numbers from these rows."""
    plan = FINDINGS[name]
    names = {**NAMES, **(FURTHER[name](sources) if name in FURTHER else {})}
    names |= {word: sources.rows.of(*which) for word, which in plan.get("rows", {}).items()}
    for word, expression in plan.get("let", {}).items():
        names[word] = _expression(expression)(names)
    compared, x = plan.get("quantity", "angle"), plan.get("x", STEP)
    lines = []
    for label, which in plan["lines"].items():
        word, shown = (which, compared) if isinstance(which, str) else which
        rows = names[word]
        lines.append(of_rows(label, rows, shown, x) if isinstance(rows, Rows) else replace(rows, label=label))
    text = template(" ".join(plan["text"].split())).render(names)
    contradicted = tuple(claim for claim in plan["holds"] if not _expression(claim)(names))
    y = plan.get("y", quantity(compared).axis)
    return Finding(name, plan["page"], plan["title"], text, contradicted, tuple(lines), x, y)


def findings(pages: Mapping[Page, Material]) -> list[Finding]:
    """Those that these rows bear out and that one of these pages explains, in the order of `findings.toml`."""
    sources, names = Sources.of(pages), {page.name for page in pages}
    return [each for name in FINDINGS if (each := finding(name, sources)).is_sound and each.page in names]


def pictures(shown: Iterable[Finding]) -> dict[str, str]:
    """The SVG text of each finding's picture by file name."""
    return {each.picture: svg(each.figure(), each.title) for each in shown}
