"""What every user of pymunk or MuJoCo should know: findings, each told only while its rows bear it out.

A finding is a sentence with its numbers from the rows, what has to hold for it, and a small picture for telephones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
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
from reports.pages.faults.page import OFFSETS
from reports.pages.faults.scripts import MUJOCO, PATCHED, PYMUNK, recorded
from reports.pages.versions.page import ratios, table
from reports.plots.looks import colour
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg
from reports.versions.catalogue import COST_ROSE_IN
from reports.versions.table import ACCELERATION, Entry
from reports.write.page_tables import COMPARED, advice
from reports.write.rows import Rows, own_rows
from reports.write.unmeasured import MARK, UNMEASURED, formatted, milliseconds, number

# Inches, 360 pixels of a browser: a telephone shows it unscaled, so that the letters keep their size.
WIDTH, HEIGHT = 3.75, 2.55
# By position, so that lines of one colour, and all of them in grey, differ by dashes, marks and filling.
LOOKS: tuple[dict[str, Any], ...] = (
    {"linestyle": ":", "marker": "o", "filled": False},
    {"linestyle": "--", "marker": "s", "filled": True},
    {"linestyle": "-", "marker": "D", "filled": True},
    {"linestyle": "-.", "marker": "^", "filled": False},
)
STEP, CPU, RELEASE = "step [ms]", "CPU time [ms per simulated second]", "release"


@dataclass(frozen=True)
class Line:
    """Points (x, y) of one engine under a label that a reader understands; x is a number or a release."""

    label: str
    engine: str
    points: tuple[tuple[Any, float], ...]


def of_rows(label: str, rows: Rows, name: str, x: str = STEP) -> Line:
    """The errors of a quantity of this name in rows, from coarse to fine, against the step or the CPU time."""
    engine = rows[0].engine if rows else ""
    if x == CPU:
        usable = [row for row in rows.known(name) if row.cpu > 0 and Outcome(row.outcome).comparable]
        return Line(label, engine, tuple((1e3 * row.cpu, getattr(row, name)) for row in usable))
    return Line(label, engine, tuple((1e3 * step, error) for step, error in rows.points(name)))


def of_releases(label: str, entries: Iterable[Entry]) -> Line:
    """The errors of one scene and method, from the oldest release to the newest."""
    shown = [entry for entry in entries if entry.comparable and entry.error > 0]
    return Line(label, shown[0].engine if shown else "", tuple((entry.version, entry.error) for entry in shown))


def axis_label(name: str) -> str:
    """What stands beside the errors: the quantity with its unit."""
    told = quantity(name)
    return f"{told.label} error [{told.unit}]"


def draw(lines: Sequence[Line], x: str, y: str, theme: Theme = LIGHT) -> Figure:
    """Lines against x, both axes logarithmic, but for releases, which stand side by side; an engine has its own colour.

    Raises ValueError for more lines than there are looks.
    """
    if len(lines) > len(LOOKS):
        raise ValueError(f"a finding's picture has {len(lines)} lines; it must have at most {len(LOOKS)}")
    with settings():
        figure = new_figure(HEIGHT, theme, WIDTH)
        axes = figure.subplots()
        for line, look in zip(lines, LOOKS, strict=False):
            if not line.points:
                continue
            paint = colour(line.engine, theme)
            axes.plot(
                [place for place, _ in line.points],
                [value for _, value in line.points],
                label=line.label,
                color=paint,
                linestyle=look["linestyle"],
                marker=look["marker"],
                markerfacecolor=paint if look["filled"] else theme.paper,
                markeredgecolor=paint,
                markersize=5,
                linewidth=1.6,
            )
        axes.set_yscale("log")
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        style_axes(axes, theme)
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


TENTH = 1e-4  # s


@dataclass(frozen=True)
class Known:
    """What findings are taken from: rows from coarse to fine, and answers to tasks; the releases' rows are a file's."""

    rows: Rows
    answers: Mapping[Task, Answer] = field(default_factory=dict)

    @classmethod
    def of(cls, pages: Mapping[Page, Material]) -> Known:
        answers = {task: answer for material in pages.values() for task, answer in material.answers.items()}
        return cls(own_rows(pages), answers)


@dataclass(frozen=True)
class Finding:
    """name: of the picture; title and text: Markdown, without the link to the page; lines: what the picture shows."""

    name: str
    title: str
    text: str
    page: str
    holds: bool
    lines: tuple[Line, ...]
    y: str  # of the picture
    x: str = STEP

    @property
    def picture(self) -> str:
        """The name of its file."""
        return f"finding_{self.name}.svg"

    @property
    def alternative(self) -> str:
        """The picture in words, for who can't see it."""
        return f"{self.y} against {self.x}: {'; '.join(line.label for line in self.lines)}"

    @property
    def told(self) -> bool:
        """Whether the rows have its numbers and bear its claims out."""
        return self.holds and MARK not in self.title + self.text


def spring(known: Known) -> Finding:
    """MuJoCo's loop as shipped, by Euler and by RK4 the same limit; and what documented settings win and cost."""
    rows, scene, integrated = known.rows, "free_four_bar", "mujoco RK4 alone"
    shipped, tuned = rows.of(scene, "mujoco default"), rows.of(scene, "mujoco tuned")
    limit, same = shipped.sweep(), rows.of(scene, integrated).sweep()
    gap, wide = rows.of(scene, integrated).sweep("gap"), shipped.sweep("gap")
    before, after = shipped.at(COMPARED), tuned.at(COMPARED)
    costs = after.cpu / before.cpu if before.cpu else UNMEASURED  # not timed
    return Finding(
        "spring",
        "MuJoCo as shipped closes a loop by a spring, which no smaller step cures; documented settings do",
        f"As the step goes to zero, a freely swinging four-bar as shipped is {number(same.plateau)} rad off. The pin "
        f"that closes its loop is {number(1e3 * gap.plateau)} mm open, by Euler and by RK4 alike. The cure is a "
        "`solref` of five steps, a `solimp` with both ends at 0.9999, and RK4: then the four-bar is "
        f"{number(after.angle)} rad off at 1 ms, for {number(costs)} times the CPU time. It takes MuJoCo 3.7 or later; "
        "install `mujoco-core` 4.0.1, since the newest `mujoco` brings 4.0.0, which can factorise wrongly.",
        "four_bar",
        limit.verdict is same.verdict is gap.verdict is Verdict.PLATEAU
        and abs(limit.plateau - same.plateau) < 0.1 * same.plateau
        and abs(wide.plateau - gap.plateau) < 0.1 * gap.plateau
        and after.angle < 1e-3 * same.plateau
        and after.angle < shipped.at(TENTH).angle,
        (
            of_rows("as shipped (Euler)", shipped, "angle"),
            of_rows("as shipped, RK4", rows.of(scene, integrated), "angle"),
            of_rows("RK4, stiff loop", tuned, "angle"),
        ),
        axis_label("angle"),
    )


def luck(known: Known) -> Finding:
    """Two errors that cancel at one step."""
    scene, shipped, tuned = "spinning_four_bar", "mujoco default", "mujoco tuned"
    rows = known.rows
    found, best = rows.of(scene, shipped).sweep(), rows.of(scene, shipped).at(COMPARED)
    return Finding(
        "luck",
        "A small error at one step may be luck",
        f"A spinning four-bar in MuJoCo as shipped is {number(best.angle)} rad off at 1 ms, but "
        f"{number(found.plateau)} rad as the step goes to zero. The error of the step and that of the soft loop have "
        "opposite signs, and at 1 ms they cancel. Compare three steps before you believe one.",
        "four_bar",
        found.verdict is Verdict.PLATEAU
        and found.lucky
        and best.angle == found.best
        and best.angle < found.plateau / 5,
        (
            of_rows("as shipped", rows.of(scene, shipped), "angle"),
            of_rows("RK4, stiff loop", rows.of(scene, tuned), "angle"),
        ),
        axis_label("angle"),
    )


def crank(known: Known) -> Finding:
    """Overwriting the crank's state after each step, with the loop as shipped and tuned."""
    scene, shipped, stiff, inside = (
        "driven_four_bar",
        "mujoco default, overwritten crank",
        "mujoco tuned, overwritten crank",
        "mujoco tuned",
    )
    rows = known.rows
    soft = [rows.of(scene, shipped, "failure").at(step) for step in (COMPARED, TENTH)]
    over, right = rows.of(scene, stiff, "failure").at(COMPARED), rows.of(scene, inside).at(COMPARED)
    return Finding(
        "crank",
        "A crank whose angle is overwritten after each step is not a driven crank",
        "MuJoCo still takes it for a body that the loop's forces accelerate, so these forces are wrong. With the loop "
        f"as shipped the linkage is {number(soft[0].angle)} rad off at 1 ms and {number(soft[1].angle)} rad at 0.1 ms. "
        f"With a stiff loop it is {number(over.angle)} rad off at 1 ms. Give the crank an armature that nothing can "
        f"accelerate (in pymunk: make it a kinematic body), and it is {number(right.angle)} rad off.",
        "four_bar",
        soft[1].angle > 0.9 * soft[0].angle and soft[0].angle > over.angle > 1000 * right.angle,
        (
            of_rows("overwritten, as shipped", rows.of(scene, shipped, "failure"), "angle"),
            of_rows("overwritten, stiff loop", rows.of(scene, stiff, "failure"), "angle"),
            of_rows("armature, stiff loop", rows.of(scene, inside), "angle"),
        ),
        axis_label("angle"),
    )


def start(known: Known) -> Finding:
    """pymunk's loop as shipped, with all of its gap closed, and started half a step ahead."""
    scene, rows = "free_four_bar", known.rows
    shipped, plain, ahead = (rows.of(scene, f"pymunk {variant}") for variant in ("default", "tuned", "leapfrog"))
    first, second = plain.sweep(), ahead.sweep()
    before, closed, after = (each.at(COMPARED) for each in (shipped, plain, ahead))
    return Finding(
        "start",
        "In pymunk `error_bias = 0` and velocities that start half a step ahead give second order",
        f"A free four-bar as shipped is {number(before.angle)} rad off at 1 ms. With `error_bias = 0` and as many "
        f"iterations as the loop needs it is {number(closed.angle)} rad off, and of order "
        f"{formatted('%.1f', first.order)}. Give the bodies the velocities of half a step later at the start as well: "
        f"then it is {number(after.angle)} rad off, and of order {formatted('%.1f', second.order)}. The velocity at "
        "$t$ is then the mean of the two around it; to read it so alone changes no position.",
        "four_bar",
        abs(first.order - 1) < 0.1
        and abs(second.order - 2) < 0.1
        and after.angle < closed.angle / 5
        and closed.angle < before.angle / 5,
        (
            of_rows("as shipped", shipped, "angle"),
            of_rows("error_bias = 0", plain, "angle"),
            of_rows("and started half a step ahead", ahead, "angle"),
        ),
        axis_label("angle"),
    )


def seconds(rows: Rows) -> float:
    """How long their scene is [s]; NaN without any."""
    return next((row.samples * row.every * row.step for row in rows), math.nan)


def energy(known: Known) -> Finding:
    """The pendulum that slows down, in both engines as shipped and set."""
    scene, rows = "pendulum_1", known.rows
    methods = {
        "pymunk as shipped": "pymunk default",
        "pymunk, error_bias = 0": "pymunk tuned",
        "MuJoCo as shipped": "mujoco default",
        "MuJoCo's tree, RK4": "mujoco tuned",
    }
    lost, kept, euler, exact = (_at(COMPARED, rows.of(scene, method), "energy") for method in methods.values())
    return Finding(
        "energy",
        "A pendulum without friction slows down in pymunk as shipped; one setting makes it as good as MuJoCo's",
        f"After {number(seconds(rows.of(scene)))} s at 1 ms the energy is off by {number(100 * lost)} % of the largest "
        f"kinetic energy in pymunk as shipped, and by {number(100 * kept)} % with `error_bias = 0` on the pin. MuJoCo "
        f"as shipped (Euler) is off by {number(100 * euler)} %, and with RK4 by {number(100 * exact)} %: its pendulum "
        "is a tree, whose hinges are exact.",
        "pendulum",
        lost > 10 * kept > 1e3 * exact and kept < 1.5 * euler,
        tuple(of_rows(label, rows.of(scene, method), "energy") for label, method in methods.items()),
        axis_label("energy"),
    )


def _at(step: float, rows: Rows, quantity: str) -> float:
    """The error at a step [s], of a failed run too; NaN without one."""
    return next((error for other, error in rows.points(quantity) if is_step(other, step)), math.nan)


def person(count: int) -> tuple[str, str, str]:
    """Scene, method and purpose of the person whose joints are swept so often in a step."""
    return "person_one_foot", f"pymunk {count} sweeps, all of the gap", "failure"


def iterations(known: Known) -> Finding:
    """Ten iterations and twenty, on a person that falls, with all of each gap closed in a step; and as shipped."""
    rows = known.rows
    coarse, fine = (rows.of(*person(10)).at(step) for step in (1e-2, COMPARED))
    right = rows.of(*person(20)).at(COMPARED)
    shipped = rows.of("person_one_foot", "pymunk default")
    return Finding(
        "iterations",
        "In pymunk with `error_bias = 0`, but not as shipped, too few iterations make a smaller step worse",
        "A falling person is a chain of five unequal bodies. With all of each gap closed in every step, "
        f"pymunk's usual 10 iterations leave an error of {number(coarse.angle)} rad at 10 ms, and "
        f"of {number(fine.angle)} rad at 1 ms. 20 iterations leave {number(right.angle)} rad at 1 ms, and the same 10 "
        f"with `error_bias` as shipped {number(shipped.at(COMPARED).angle)} rad. Long chains and unequal masses "
        "need more iterations before they need smaller steps.",
        "person",
        fine.angle > 2 * coarse.angle
        and right.angle < fine.angle / 20
        and shipped.at(COMPARED).angle < shipped.at(1e-2).angle / 5,
        (
            *(
                of_rows(f"{count} iterations, error_bias = 0", rows.of(*person(count)), "angle")
                for count in (5, 10, 20)
            ),
            of_rows("10 iterations, as shipped", shipped, "angle"),
        ),
        axis_label("angle"),
    )


def forces(known: Known) -> Finding:
    """The same motion with 20 and with 100 iterations, but not the same reactions."""
    few, many = (known.rows.of(*person(count)) for count in (20, 100))
    less, more = few.at(COMPARED), many.at(COMPARED)
    return Finding(
        "forces",
        "The right motion does not mean the right forces",
        "Take the same falling person in pymunk at 1 ms. With 20 and with 100 iterations the motion is the same, "
        f"{number(less.angle)} rad off. But with 20 the joint forces are off by {number(100 * less.reaction)} % of "
        f"the largest, and with 100 by {number(100 * more.reaction)} %. Before you use a force, see whether it "
        "changes with the iterations and with the step.",
        "person",
        abs(less.angle - more.angle) < 0.02 * more.angle and less.reaction > 5 * more.reaction,
        (
            of_rows("forces, 20 iterations", few, "reaction"),
            of_rows("forces, 100 iterations", many, "reaction"),
            of_rows("motion [rad], 20 iterations", few, "angle"),
            of_rows("motion [rad], 100 iterations", many, "angle"),
        ),
        "error [relative or rad]",
    )


def releases(known: Known) -> Finding:
    """What MuJoCo 3.7.0 mended, by the rows of the releases; and what a step as shipped has come to cost."""
    own = table()
    entries = [entry for entry in own.entries if entry.engine == "mujoco"]
    versions = own.versions("mujoco")
    lines = {
        scene: [entry for entry in entries if (entry.scene, entry.variant) == (scene, "tuned")]
        for scene in ("free_four_bar", "spinning_four_bar", "driven_slider_crank")
    }
    error = {(entry.scene, entry.version): entry.error for found in lines.values() for entry in found}
    old, new, newest = (error.get(("free_four_bar", each), math.nan) for each in ("3.6.0", "3.7.0", versions[-1]))
    cost = ratios(entries, versions, "default")
    oldest, later = (float(np.median(cost[each])) if each in cost else math.nan for each in (versions[0], "3.3.7"))
    return Finding(
        "releases",
        "MuJoCo 3.7.0 divided the error of stiff loops by ten thousand: never judge an engine without its release",
        f"With the same settings a free four-bar at 1 ms is {number(old)} rad off in 3.6.0 and {number(new)} rad in "
        "3.7.0, which gave loops the velocity term that they lacked. An upgrade costs as well: as shipped a step takes "
        f"{number(later / oldest)} times the CPU time of {versions[0]} in 3.3.7, in the median of the scenes; the rise "
        f"came with {COST_ROSE_IN}.",
        "versions",
        3e3 < old / new < 3e4 and later / oldest > 1.4 and newest < 1.1 * new,
        tuple(of_releases(scene.replace("_", " "), found) for scene, found in lines.items()),
        axis_label("angle"),
        RELEASE,
    )


def trees(known: Known) -> Finding:
    """Random trees with loops across, in MuJoCo with the stiffest documented settings and with stiffer rows of ours."""
    own = table()
    newest = own.versions("mujoco")[-1]
    found = [entry for entry in own.entries if entry.engine == "mujoco" and entry.quantity == ACCELERATION]
    tuned, ours = ([entry for entry in found if entry.variant == variant] for variant in ("tuned", "extended"))
    last = {entry.variant: entry for entry in found if entry.version == newest}
    many, _, rest = last["tuned"].sentence.partition(" of ") if "tuned" in last else ("0", "", "")
    soft, hard = (last[variant].error if variant in last else math.nan for variant in ("tuned", "extended"))
    return Finding(
        "trees",
        "On random trees with loops MuJoCo's stiffest documented settings may still be too soft",
        f"MuJoCo {newest}: the accelerations of {many} of {rest.partition(' ')[0]} random trees of twelve bodies and "
        f"four loops are off by more than 1 %, of the worst by {number(100 * soft)} %. Where loops nearly depend on "
        "one another, what `solimp` leaves of softness is as large as what it is added to. With softness divided by "
        f"1e8 in the compiled model the worst is {number(100 * hard)} % off.",
        "versions",
        int(many) >= 10 and soft > 0.1 and hard < 1e-3,
        (of_releases("documented settings", tuned), of_releases("with our code", ours)),
        "error [relative]",
        RELEASE,
    )


# What each script of the page of faults shows, in a few words.
FAULTS: Mapping[str, str] = {
    "pymunk_groove": "a `GrooveJoint` off the centre of mass creates velocity across itself",
    "pymunk_kinetic_energy": "`Body.kinetic_energy` is twice the kinetic energy",
    "mujoco_joint_equality": "a curved `equality/joint` lacks its velocity term",
    "mujoco_tendon_equality": "so does `equality/tendon`",
    "mujoco_site_near_origin": "a site within a micrometre of its body's origin is put there",
}


def faults(known: Known) -> Finding:
    """What the newest releases compute wrongly at one instant, by the scripts that were run with them."""
    # Of each script the newest release, as it was released.
    last = {row.script: row for row in recorded() if not row.version.endswith(PATCHED)}
    told = []
    for title, names in (("pymunk", PYMUNK), ("MuJoCo", MUJOCO)):
        own = [last[name] for name in names if name in FAULTS and name in last]
        words = "; ".join(FAULTS[row.script] for row in own if not row.right)
        told.append(f"{title} {own[0].version if own else MARK}: {words}.")
    answer = known.answers.get(OFFSETS)
    measured = answer.array("across") if answer is not None and answer.finished else np.array([])
    line = Line("pymunk's groove (ideal: 0)", "pymunk", tuple(zip(OFFSETS.offsets, -measured, strict=False)))
    return Finding(
        "faults",
        "Releases of today compute some things wrongly, at any step: grooves, curved equalities, an energy",
        " ".join(told) + " Each has a script that needs the engine alone.",
        "faults",
        all(name in last and not last[name].right for name in FAULTS) and len(line.points) > 3,
        (line,),
        "velocity across [m/s]",
        "anchor's distance from the centre of mass [m]",
    )


def exact(known: Known) -> Finding:
    """The plain judge against both engines, by the CPU time that errors of four sizes cost."""
    rows = known.rows.of("free_four_bar")
    least: dict[tuple[str, float], Any] = {}
    for each in advice(rows, "angle"):
        least.update({(each.engine, target): each.row for target in each.targets})
    targets = sorted({target for _, target in least})
    cost = {key: row.cpu if row is not None and row.cpu > 0 else math.inf for key, row in least.items()}
    fine = {engine: cost.get((engine, 1e-6), math.nan) for engine in ("lagrange", "mujoco", "pymunk")}
    return Finding(
        "exact",
        "On a small loop, plain exact multipliers in compiled code beat both engines per CPU second",
        "This suite's judge solves for the forces of ideal joints, with textbook integrators and nothing else. On the "
        f"free four-bar an error of 1e-6 rad costs it {milliseconds(fine['lagrange'])} ms of CPU time per simulated "
        f"second, MuJoCo {milliseconds(fine['mujoco'])} ms and pymunk {milliseconds(fine['pymunk'])} ms at their best. "
        "Errors of 1e-2 and 1e-9 rad cost it least too. It is planar, without the contacts that engines are made for.",
        "four_bar",
        len(targets) > 1
        and all(
            cost.get(("lagrange", target), math.nan) < cost.get((engine, target), math.nan)
            for target in targets
            for engine in ("mujoco", "pymunk")
        ),
        (
            of_rows("pymunk, half a step ahead", rows.of(method="pymunk leapfrog"), "angle", CPU),
            of_rows("MuJoCo, RK4, stiff loop", rows.of(method="mujoco tuned"), "angle", CPU),
            of_rows("exact multipliers, RK4", rows.of(method="lagrange rk4 none"), "angle", CPU),
            of_rows("pymunk, 5 runs extrapolated", rows.of(method="pymunk extended"), "angle", CPU),
        ),
        axis_label("angle"),
        CPU,
    )


def contact(known: Known) -> Finding:
    """An ellipse that rolls: as a polygon, as an ellipsoid, and by two rows."""
    scene, polygon, ellipsoid, written = "rolling_ellipse", "pymunk tuned", "mujoco default", "mujoco extended"
    rows = known.rows
    corners, smooth = rows.of(scene, polygon).sweep(), rows.of(scene, ellipsoid).sweep()
    stiff, exactly = (rows.of(scene, method).at(COMPARED) for method in ("mujoco tuned", written))
    return Finding(
        "contact",
        "A body that is not round does not roll truly on contact as shipped, nor as a polygon",
        f"pymunk has no ellipses. However small the step, a rolling ellipse is {number(corners.plateau)} rad off as a "
        f"polygon of 512 corners (our choice) in pymunk, and {number(smooth.plateau)} rad on MuJoCo's contact as "
        f"shipped. A contact as stiff as the step allows does converge: {number(stiff.angle)} rad at 1 ms. With two "
        f"constraint rows of our code instead of the contact it is {number(exactly.angle)} rad.",
        "rolling",
        corners.verdict is smooth.verdict is Verdict.PLATEAU
        and stiff.angle < 0.1 * smooth.plateau
        and exactly.angle < 1e-6 * min(corners.plateau, smooth.plateau),
        (
            of_rows("pymunk, 512 corners", rows.of(scene, polygon), "angle"),
            of_rows("MuJoCo's contact as shipped", rows.of(scene, ellipsoid), "angle"),
            of_rows("MuJoCo's contact, stiff", rows.of(scene, "mujoco tuned"), "angle"),
            of_rows("MuJoCo with two rows of ours", rows.of(scene, written), "angle"),
        ),
        axis_label("angle"),
    )


def skate(known: Known) -> Finding:
    """The naive skate, which no step improves, and a groove."""
    scene, rows = "sleigh", known.rows
    naively, groove = rows.of(scene, "pymunk default"), rows.of(scene, "pymunk tuned")
    least = min((error for _, error in naively.points("position")), default=math.nan)
    better = groove.at(COMPARED)
    return Finding(
        "skate",
        "To stop a body's centre sideways makes no skate, unless the blade is there",
        "Neither engine has a skate or an ideal wheel. A common trick sets the sideways velocity of the body's centre "
        "to zero after each step. Where the blade is not below the centre, that is another mechanism: after "
        f"{number(seconds(rows.of(scene)))} s it is off by {number(least)} m or more at every step. A groove of pymunk "
        f"that our code aims anew before each step is {number(better.position)} m off at 1 ms.",
        "skate",
        len(naively) >= 3 and least > 1.0 and better.position < 1e-3 * least,
        (
            of_rows("centre's velocity zeroed", naively, "position"),
            of_rows("groove, aimed anew each step", groove, "position"),
        ),
        axis_label("position"),
    )


FINDINGS: tuple[Callable[[Known], Finding], ...] = (
    spring,
    luck,
    crank,
    releases,
    faults,
    exact,
    start,
    energy,
    forces,
    iterations,
    trees,
    contact,
    skate,
)


def findings(pages: Mapping[Page, Material]) -> list[Finding]:
    """Those that these rows bear out and that one of these pages explains, in the order of FINDINGS."""
    known, names = Known.of(pages), {page.name for page in pages}
    return [found for find in FINDINGS if (found := find(known)).told and found.page in names]


def pictures(told: Iterable[Finding]) -> dict[str, str]:
    """The SVG text of each finding's picture by file name."""
    return {found.picture: svg(draw(found.lines, found.x, found.y), found.title) for found in told}
