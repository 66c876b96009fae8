"""Findings that every user of pymunk or MuJoCo should know, each dropped where its rows contradict it.

`findings.md` has the sentences; here are their numbers, a predicate for each, and a small picture for telephones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from reports.model.convergence import Verdict
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.model.tasks import Answer, Task
from reports.model.usual_steps import is_step
from reports.pages.faults.page import OFFSETS, SCRIPTS, is_right
from reports.plots.looks import colour
from reports.plots.theme import LIGHT, drawing, style_axes, svg
from reports.versions.catalogue import COST_ROSE_IN
from reports.versions.table import ACCELERATION, Entry, relative_cost, released
from reports.write.page_tables import COMPARED, advice
from reports.write.rows import Rows, own_rows
from reports.write.templates import template
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
            axes.plot(
                *zip(*line.points, strict=True),
                label=line.label,
                color=paint,
                linestyle=dashes,
                marker=mark,
                markerfacecolor=paint if filled else LIGHT.paper,
                markeredgecolor=paint,
                markersize=5,
                linewidth=1.6,
            )
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
class Evidence:
    """Values of a finding's sentences, whether the rows bear it out, and the lines and axes of its picture."""

    words: Mapping[str, Any]
    holds: bool
    lines: tuple[PlottedLine, ...]
    y: str
    x: str = STEP

    def figure(self) -> Figure:
        """Its picture."""
        return draw(self.lines, self.x, self.y)


@dataclass(frozen=True)
class Finding:
    """`name`: that of the picture; `title` and `text`: Markdown, without the link to the page."""

    name: str
    page: str
    title: str
    text: str
    evidence: Evidence

    @property
    def picture(self) -> str:
        """The name of its file."""
        return f"finding_{self.name}.svg"

    @property
    def alternative(self) -> str:
        """The picture in words, for who can't see it."""
        return f"{self.evidence.y} against {self.evidence.x}: {'; '.join(line.label for line in self.evidence.lines)}"

    @property
    def is_sound(self) -> bool:
        """Whether the rows have its numbers and bear its claims out."""
        return self.evidence.holds and MARK not in self.title + self.text


def _against_steps(words: Mapping[str, Any], holds: bool, lines: Mapping[str, Rows], name: str = "angle") -> Evidence:
    """Evidence whose picture has the errors of a quantity against the step."""
    drawn = tuple(of_rows(label, rows, name) for label, rows in lines.items())
    return Evidence(words, holds, drawn, quantity(name).axis)


def spring(sources: Sources) -> Evidence:
    """MuJoCo's loop as shipped: Euler and RK4 have the same limit; gain and cost of documented settings."""
    rows = sources.rows.of("free_four_bar")
    shipped, integrated, tuned = (rows.of(method=f"mujoco {each}") for each in ("default", "RK4 alone", "tuned"))
    limit, same, wide, gap = shipped.sweep(), integrated.sweep(), shipped.sweep("gap"), integrated.sweep("gap")
    before, after = shipped.at(COMPARED), tuned.at(COMPARED)
    costs = after.cpu / before.cpu if before.cpu else UNMEASURED  # not timed
    return _against_steps(
        {"same": same, "gap": gap, "after": after, "costs": costs},
        limit.verdict is same.verdict is gap.verdict is Verdict.PLATEAU
        and abs(limit.plateau - same.plateau) < 0.1 * same.plateau
        and abs(wide.plateau - gap.plateau) < 0.1 * gap.plateau
        and after.angle < 1e-3 * same.plateau
        and after.angle < shipped.at(TENTH).angle,
        {"as shipped (Euler)": shipped, "as shipped, RK4": integrated, "RK4, stiff loop": tuned},
    )


def luck(sources: Sources) -> Evidence:
    """Two errors that cancel at one step."""
    shipped, tuned = (sources.rows.of("spinning_four_bar", f"mujoco {each}") for each in ("default", "tuned"))
    limit, best = shipped.sweep(), shipped.at(COMPARED)
    return _against_steps(
        {"limit": limit, "best": best},
        limit.verdict is Verdict.PLATEAU
        and limit.lucky
        and best.angle == limit.best
        and best.angle < limit.plateau / 5,
        {"as shipped": shipped, "RK4, stiff loop": tuned},
    )


def crank(sources: Sources) -> Evidence:
    """Overwriting the crank's state after each step, with the loop as shipped and tuned."""
    rows, scene = sources.rows, "driven_four_bar"
    soft, stiff = (rows.of(scene, f"mujoco {each}, overwritten crank", "failure") for each in ("default", "tuned"))
    armature = rows.of(scene, "mujoco tuned")
    coarse, fine, over, right = soft.at(COMPARED), soft.at(TENTH), stiff.at(COMPARED), armature.at(COMPARED)
    return _against_steps(
        {"coarse": coarse, "fine": fine, "over": over, "right": right},
        fine.angle > 0.9 * coarse.angle and coarse.angle > over.angle > 1000 * right.angle,
        {"overwritten, as shipped": soft, "overwritten, stiff loop": stiff, "armature, stiff loop": armature},
    )


def start(sources: Sources) -> Evidence:
    """pymunk's loop as shipped, with all of its gap closed, and started half a step ahead."""
    rows = sources.rows.of("free_four_bar")
    shipped, plain, ahead = (rows.of(method=f"pymunk {each}") for each in ("default", "tuned", "leapfrog"))
    first, second = plain.sweep(), ahead.sweep()
    before, closed, after = (each.at(COMPARED) for each in (shipped, plain, ahead))
    return _against_steps(
        {"before": before, "closed": closed, "after": after, "first": first, "second": second},
        abs(first.order - 1) < 0.1
        and abs(second.order - 2) < 0.1
        and after.angle < closed.angle / 5
        and closed.angle < before.angle / 5,
        {"as shipped": shipped, "error_bias = 0": plain, "and started half a step ahead": ahead},
    )


def _seconds(rows: Rows) -> float:
    """How long their scene is [s]; NaN without any."""
    return next((row.samples * row.every * row.step for row in rows), math.nan)


def energy(sources: Sources) -> Evidence:
    """The pendulum that slows down, in both engines as shipped and set."""
    rows = sources.rows.of("pendulum_1")
    lines = {
        "pymunk as shipped": rows.of(method="pymunk default"),
        "pymunk, error_bias = 0": rows.of(method="pymunk tuned"),
        "MuJoCo as shipped": rows.of(method="mujoco default"),
        "MuJoCo's tree, RK4": rows.of(method="mujoco tuned"),
    }
    # A run whose angle is lost has an energy all the same.
    lost, closed, euler, exact = (
        next((error for step, error in each.points("energy") if is_step(step, COMPARED)), math.nan)
        for each in lines.values()
    )
    words = {"seconds": _seconds(rows), "lost": lost, "closed": closed, "euler": euler, "exact": exact}
    return _against_steps(words, lost > 10 * closed > 1e3 * exact and closed < 1.5 * euler, lines, "energy")


def _person(sources: Sources, count: int) -> Rows:
    """The person whose joints are swept so often in a step, with all of each gap closed."""
    return sources.rows.of("person_one_foot", f"pymunk {count} sweeps, all of the gap", "failure")


def iterations(sources: Sources) -> Evidence:
    """Ten iterations and twenty, on a person that falls, with all of each gap closed in a step; and as shipped."""
    five, ten, twenty = (_person(sources, count) for count in (5, 10, 20))
    shipped = sources.rows.of("person_one_foot", "pymunk default")
    coarse, fine, right = ten.at(1e-2), ten.at(COMPARED), twenty.at(COMPARED)
    return _against_steps(
        {"coarse": coarse, "fine": fine, "right": right, "shipped": shipped.at(COMPARED)},
        fine.angle > 2 * coarse.angle
        and right.angle < fine.angle / 20
        and shipped.at(COMPARED).angle < shipped.at(1e-2).angle / 5,
        {
            "5 iterations, error_bias = 0": five,
            "10 iterations, error_bias = 0": ten,
            "20 iterations, error_bias = 0": twenty,
            "10 iterations, as shipped": shipped,
        },
    )


def forces(sources: Sources) -> Evidence:
    """The same motion with 20 and with 100 iterations, but not the same reactions."""
    few, many = (_person(sources, count) for count in (20, 100))
    less, more = few.at(COMPARED), many.at(COMPARED)
    return Evidence(
        {"less": less, "more": more},
        abs(less.angle - more.angle) < 0.02 * more.angle and less.reaction > 5 * more.reaction,
        (
            of_rows("forces, 20 iterations", few, "reaction"),
            of_rows("forces, 100 iterations", many, "reaction"),
            of_rows("motion [rad], 20 iterations", few, "angle"),
            of_rows("motion [rad], 100 iterations", many, "angle"),
        ),
        "error [relative or rad]",
    )


def releases(sources: Sources) -> Evidence:
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
    return Evidence(
        {"old": old, "new": new, "oldest": oldest, "later": later, "first": versions[0], "rose_in": COST_ROSE_IN},
        3e3 < old / new < 3e4 and later / oldest > 1.4 and newest < 1.1 * new,
        tuple(of_releases(scene.replace("_", " "), shown) for scene, shown in lines.items()),
        quantity("angle").axis,
        RELEASE,
    )


def trees(sources: Sources) -> Evidence:
    """Random trees with loops across, in MuJoCo with the stiffest documented settings and with stiffer rows of ours."""
    newest = released().versions("mujoco")[-1]
    entries = [entry for entry in released().of("mujoco") if entry.quantity == ACCELERATION]
    tuned, ours = ([entry for entry in entries if entry.variant == variant] for variant in ("tuned", "extended"))
    last = {entry.variant: entry for entry in entries if entry.version == newest}
    many, _, rest = last["tuned"].sentence.partition(" of ") if "tuned" in last else ("0", "", "")
    soft, hard = (last[variant].error if variant in last else math.nan for variant in ("tuned", "extended"))
    return Evidence(
        {"newest": newest, "many": many, "all": rest.partition(" ")[0], "soft": soft, "hard": hard},
        int(many) >= 10 and soft > 0.1 and hard < 1e-3,
        (of_releases("documented settings", tuned), of_releases("with our code", ours)),
        "error [relative]",
        RELEASE,
    )


# The fault that each script of the page of faults shows, in a few words.
FAULTS: Mapping[str, str] = {
    "pymunk_groove": "a `GrooveJoint` off the centre of mass creates velocity across itself",
    "pymunk_kinetic_energy": "`Body.kinetic_energy` is twice the kinetic energy",
    "mujoco_joint_equality": "a curved `equality/joint` lacks its velocity term",
    "mujoco_tendon_equality": "so does `equality/tendon`",
    "mujoco_site_near_origin": "a site within a micrometre of its body's origin is put there",
}


def faults(sources: Sources) -> Evidence:
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
    line = PlottedLine("pymunk's groove (ideal: 0)", "pymunk", tuple(zip(OFFSETS.offsets, -across, strict=False)))
    return Evidence(
        {"wrong": " ".join(wrong)},
        not missing and len(line.points) > 3,
        (line,),
        "velocity across [m/s]",
        "anchor's distance from the centre of mass [m]",
    )


def exact(sources: Sources) -> Evidence:
    """The plain judge against both engines, by the CPU time that errors of four sizes cost."""
    rows = sources.rows.of("free_four_bar")
    least = {(each.engine, target): each.row for each in advice(rows, "angle") for target in each.targets}
    cost = {key: row.cpu if row is not None and row.cpu > 0 else math.inf for key, row in least.items()}
    targets = {target for _, target in least}
    engines = {
        "pymunk, half a step ahead": "pymunk leapfrog",
        "MuJoCo, RK4, stiff loop": "mujoco tuned",
        "exact multipliers, RK4": "lagrange rk4 none",
        "pymunk, 5 runs extrapolated": "pymunk extended",
    }
    return Evidence(
        {"fine": {engine: cost.get((engine, 1e-6), math.nan) for engine in ("lagrange", "mujoco", "pymunk")}},
        len(targets) > 1
        and all(
            cost.get(("lagrange", target), math.nan) < cost.get((engine, target), math.nan)
            for target in targets
            for engine in ("mujoco", "pymunk")
        ),
        tuple(of_rows(label, rows.of(method=method), "angle", CPU) for label, method in engines.items()),
        quantity("angle").axis,
        CPU,
    )


def contact(sources: Sources) -> Evidence:
    """An ellipse that rolls: as a polygon, as an ellipsoid, and by two rows."""
    rows = sources.rows.of("rolling_ellipse")
    polygon, ellipsoid = rows.of(method="pymunk tuned"), rows.of(method="mujoco default")
    tuned, written = rows.of(method="mujoco tuned"), rows.of(method="mujoco extended")
    corners, smooth = polygon.sweep(), ellipsoid.sweep()
    stiff, exactly = tuned.at(COMPARED), written.at(COMPARED)
    return _against_steps(
        {"corners": corners, "smooth": smooth, "stiff": stiff, "exactly": exactly},
        corners.verdict is smooth.verdict is Verdict.PLATEAU
        and stiff.angle < 0.1 * smooth.plateau
        and exactly.angle < 1e-6 * min(corners.plateau, smooth.plateau),
        {
            "pymunk, 512 corners": polygon,
            "MuJoCo's contact as shipped": ellipsoid,
            "MuJoCo's contact, stiff": tuned,
            "MuJoCo with two rows of ours": written,
        },
    )


def skate(sources: Sources) -> Evidence:
    """The naive skate, which no step improves, and a groove."""
    rows = sources.rows.of("sleigh")
    naive, groove = rows.of(method="pymunk default"), rows.of(method="pymunk tuned")
    least = min((error for _, error in naive.points("position")), default=math.nan)
    better = groove.at(COMPARED)
    return _against_steps(
        {"seconds": _seconds(rows), "least": least, "better": better},
        len(naive) >= 3 and least > 1.0 and better.position < 1e-3 * least,
        {"centre's velocity zeroed": naive, "groove, aimed anew each step": groove},
        "position",
    )


FINDINGS: Mapping[str, Callable[[Sources], Evidence]] = {
    find.__name__: find
    for find in (
        spring, luck, crank, releases, faults, exact, start, energy, forces, iterations, trees, contact, skate,
    )
}  # fmt: skip


@cache
def texts() -> Mapping[str, tuple[str, str, str]]:
    """Page, title and text of each finding by its name."""
    sections = Path(__file__).with_name("findings.md").read_text(encoding="utf-8").removeprefix("## ").split("\n## ")
    found = {}
    for section in sections:
        heading, title, text = (" ".join(paragraph.split()) for paragraph in section.strip().split("\n\n"))
        name, _, page = heading.partition(" on ")
        found[name] = (page, title, text)
    return found


def finding(name: str, sources: Sources) -> Finding:
    """The finding of this name with its numbers from these rows."""
    page, title, text = texts()[name]
    evidence = FINDINGS[name](sources)
    return Finding(name, page, title, template(text).render(**evidence.words), evidence)


def findings(pages: Mapping[Page, Material]) -> list[Finding]:
    """Those that these rows bear out and that one of these pages explains, in the order of FINDINGS."""
    sources, names = Sources.of(pages), {page.name for page in pages}
    return [each for name in FINDINGS if (each := finding(name, sources)).is_sound and each.page in names]


def pictures(shown: Iterable[Finding]) -> dict[str, str]:
    """The SVG text of each finding's picture by file name."""
    return {
        each.picture: svg(draw(each.evidence.lines, each.evidence.x, each.evidence.y), each.title) for each in shown
    }
