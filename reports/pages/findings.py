"""What every user of pymunk or MuJoCo should know: ten findings, each told only while its rows bear it out.

A finding is a sentence with its numbers from the rows, what has to hold for it, and a small picture for telephones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from reports.model.convergence import Verdict
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.model.usual_steps import is_step
from reports.plots.looks import colour
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg
from reports.write.rows import Rows, own_rows
from reports.write.unmeasured import MARK, UNMEASURED, formatted, number

# Inches, 360 pixels of a browser: a telephone shows it unscaled, so that the letters keep their size.
WIDTH, HEIGHT = 3.75, 2.55
# By position, so that lines of one colour, and all of them in grey, differ by dashes, marks and filling.
LOOKS: tuple[dict[str, Any], ...] = (
    {"linestyle": ":", "marker": "o", "filled": False},
    {"linestyle": "--", "marker": "s", "filled": True},
    {"linestyle": "-", "marker": "D", "filled": True},
    {"linestyle": "-.", "marker": "^", "filled": False},
)


@dataclass(frozen=True)
class Line:
    """Rows of one engine from coarse to fine, under a label that a reader of the finding understands."""

    label: str
    rows: Rows


def axis_label(name: str) -> str:
    """What stands beside the errors: the quantity with its unit."""
    told = quantity(name)
    return f"{told.label} error [{told.unit}]"


def draw(lines: Sequence[Line], name: str, theme: Theme = LIGHT) -> Figure:
    """Errors of the quantity of this name against the step [ms], both logarithmic; an engine has its own colour.

    Raises ValueError for more lines than there are looks.
    """
    if len(lines) > len(LOOKS):
        raise ValueError(f"a finding's picture has {len(lines)} lines; it must have at most {len(LOOKS)}")
    with settings():
        figure = new_figure(HEIGHT, theme, WIDTH)
        axes = figure.subplots()
        for line, look in zip(lines, LOOKS, strict=False):
            if not line.rows:
                continue
            paint, shown = colour(line.rows[0].engine, theme), line.rows.points(name)
            axes.plot(
                [1e3 * step for step, _ in shown],
                [error for _, error in shown],
                label=line.label,
                color=paint,
                linestyle=look["linestyle"],
                marker=look["marker"],
                markerfacecolor=paint if look["filled"] else theme.paper,
                markeredgecolor=paint,
                markersize=5,
                linewidth=1.6,
            )
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("step [ms]")
        axes.set_ylabel(axis_label(name))
        style_axes(axes, theme)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(base=10, numticks=7))
            axis.set_minor_formatter(NullFormatter())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.minorticks_off()
        figure.legend(loc="outside upper left", ncols=1, handlelength=3.2, fontsize=8.5)
    return figure


MILLISECOND = 1e-3  # s, the step at which findings compare: the grid of nearly every scene has it
TENTH = 1e-4  # s


@dataclass(frozen=True)
class Finding:
    """name: of the picture; title and text: Markdown, without the link to the page; lines: what the picture shows."""

    name: str
    title: str
    text: str
    page: str
    holds: bool
    lines: tuple[Line, ...]
    quantity: str  # of the picture, a name in `reports.model.quantities`

    @property
    def picture(self) -> str:
        """The name of its file."""
        return f"finding_{self.name}.svg"

    @property
    def alternative(self) -> str:
        """The picture in words, for who can't see it."""
        shown = "; ".join(line.label for line in self.lines)
        return f"{axis_label(self.quantity)} against step [ms]: {shown}"

    @property
    def told(self) -> bool:
        """Whether the rows have its numbers and bear its claims out."""
        return self.holds and MARK not in self.title + self.text


ENGINES = {"pymunk": "pymunk", "mujoco": "MuJoCo"}  # as their makers write them


def spring(rows: Rows) -> Finding:
    """MuJoCo's loop as shipped: by Euler and by RK4 the same limit."""
    scene, shipped, integrated, tuned = "free_four_bar", "mujoco default", "mujoco RK4 alone", "mujoco tuned"
    limit, same = rows.of(scene, shipped).sweep(), rows.of(scene, integrated).sweep()
    gap, wide = rows.of(scene, integrated).sweep("gap"), rows.of(scene, shipped).sweep("gap")
    stiff = rows.of(scene, tuned).at(MILLISECOND)
    return Finding(
        "spring",
        "MuJoCo as shipped closes a loop by a spring, and no smaller step removes the spring's error",
        f"As the step goes to zero, a freely swinging four-bar as shipped is {number(same.plateau)} rad off. The pin "
        f"that closes its loop is {number(1e3 * gap.plateau)} mm open, by Euler and by RK4 alike. The cure is a "
        "`solref` of five steps, a `solimp` with both ends at 0.9999, and RK4: then the four-bar is "
        f"{number(stiff.angle)} rad off at 1 ms. It takes MuJoCo 3.7 or later; install `mujoco-core` 4.0.1, since the "
        "newest `mujoco` brings 4.0.0, which can factorise wrongly.",
        "four_bar",
        limit.verdict is same.verdict is gap.verdict is Verdict.PLATEAU
        and abs(limit.plateau - same.plateau) < 0.1 * same.plateau
        and abs(wide.plateau - gap.plateau) < 0.1 * gap.plateau
        and stiff.angle < 1e-3 * same.plateau,
        (
            Line("as shipped (Euler)", rows.of(scene, shipped)),
            Line("as shipped, RK4", rows.of(scene, integrated)),
            Line("RK4, stiff loop", rows.of(scene, tuned)),
        ),
        "angle",
    )


def luck(rows: Rows) -> Finding:
    """Two errors that cancel at one step."""
    scene, shipped, tuned = "spinning_four_bar", "mujoco default", "mujoco tuned"
    found, best = rows.of(scene, shipped).sweep(), rows.of(scene, shipped).at(MILLISECOND)
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
        (Line("as shipped", rows.of(scene, shipped)), Line("RK4, stiff loop", rows.of(scene, tuned))),
        "angle",
    )


def tuned(rows: Rows) -> Finding:
    """What documented settings win and cost, in both engines."""
    scene, wins, costs, better = "free_four_bar", {}, {}, True
    for engine in ENGINES:
        before, after = (rows.of(scene, f"{engine} {variant}").at(MILLISECOND) for variant in ("default", "tuned"))
        wins[engine] = before.angle / after.angle if after.angle else before.angle
        costs[engine] = after.cpu / before.cpu if before.cpu else UNMEASURED  # not timed
        better = better and after.angle < rows.of(scene, f"{engine} default").at(TENTH).angle
    return Finding(
        "tuned",
        "On a free four-bar a few documented settings win more than a step a tenth as large",
        "At 1 ms: in pymunk (`error_bias = 0`, and as many iterations as the loop needs) they "
        f"divide the error by {number(wins['pymunk'])}, for {number(costs['pymunk'])} times the CPU time. In MuJoCo "
        f"(RK4 and a stiff loop) they divide it by {number(wins['mujoco'])}, for {number(costs['mujoco'])} times the "
        "CPU time.",
        "four_bar",
        better,
        tuple(
            Line(f"{ENGINES[engine]} {words}", rows.of(scene, f"{engine} {variant}"))
            for engine in ENGINES
            for variant, words in (("default", "as shipped"), ("tuned", "tuned"))
        ),
        "angle",
    )


def reading(rows: Rows) -> Finding:
    """pymunk's velocities belong half a step later than its positions, and so does their start."""
    scene, plain, leapfrog = "free_four_bar", "pymunk tuned", "pymunk leapfrog"
    first, second = rows.of(scene, plain).sweep(), rows.of(scene, leapfrog).sweep()
    before, after = rows.of(scene, plain).at(MILLISECOND), rows.of(scene, leapfrog).at(MILLISECOND)
    return Finding(
        "reading",
        "Velocities that start half a step ahead make pymunk a method of second order",
        "Give the bodies the velocities of half a step later at the start, and read the velocity at $t$ as the mean of "
        "the two around it. Reading alone changes no position. With the same engine and settings the order is then "
        f"{formatted('%.1f', second.order)} instead of {formatted('%.1f', first.order)}. "
        f"At 1 ms the free four-bar is {number(after.angle)} rad off instead of {number(before.angle)} rad.",
        "four_bar",
        abs(first.order - 1) < 0.1 and abs(second.order - 2) < 0.1 and after.angle < before.angle / 5,
        (
            Line("started as it is", rows.of(scene, plain)),
            Line("started half a step ahead", rows.of(scene, leapfrog)),
        ),
        "angle",
    )


def crank(rows: Rows) -> Finding:
    """Overwriting the crank's state after each step, with the loop as shipped and tuned."""
    scene, shipped, stiff, inside = (
        "driven_four_bar",
        "mujoco default, overwritten crank",
        "mujoco tuned, overwritten crank",
        "mujoco tuned",
    )
    soft = [rows.of(scene, shipped, "failure").at(step) for step in (MILLISECOND, TENTH)]
    over, right = rows.of(scene, stiff, "failure").at(MILLISECOND), rows.of(scene, inside).at(MILLISECOND)
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
            Line("overwritten, as shipped", rows.of(scene, shipped, "failure")),
            Line("overwritten, stiff loop", rows.of(scene, stiff, "failure")),
            Line("armature, stiff loop", rows.of(scene, inside)),
        ),
        "angle",
    )


def seconds(rows: Rows) -> float:
    """How long their scene is [s]; NaN without any."""
    return next((row.samples * row.every * row.step for row in rows), math.nan)


def energy(rows: Rows) -> Finding:
    """The pendulum that slows down."""
    scene, shipped, closed, tree = "pendulum_1", "pymunk default", "pymunk tuned", "mujoco tuned"
    lost, kept, exact = (_at(MILLISECOND, rows.of(scene, method), "energy") for method in (shipped, closed, tree))
    euler = _at(MILLISECOND, rows.of(scene, "mujoco default"), "energy")
    return Finding(
        "energy",
        "A pendulum without friction slows down in pymunk as shipped, and one setting cures most of it",
        f"After {number(seconds(rows.of(scene)))} s at 1 ms the energy is off by {number(100 * lost)} % of the largest "
        f"kinetic energy, with `error_bias = 0` on the pin by {number(100 * kept)} %. MuJoCo as shipped (Euler) is off "
        f"by {number(100 * euler)} %, and with RK4 by {number(100 * exact)} %: its pendulum is a tree, whose hinges "
        "are exact.",
        "pendulum",
        lost > 10 * kept > 1e3 * exact,
        (
            Line("pymunk as shipped", rows.of(scene, shipped)),
            Line("pymunk, error_bias = 0", rows.of(scene, closed)),
            Line("MuJoCo as shipped", rows.of(scene, "mujoco default")),
            Line("MuJoCo's tree, RK4", rows.of(scene, tree)),
        ),
        "energy",
    )


def _at(step: float, rows: Rows, quantity: str) -> float:
    """The error at a step [s], of a failed run too; NaN without one."""
    return next((error for other, error in rows.points(quantity) if is_step(other, step)), math.nan)


def person(count: int) -> tuple[str, str, str]:
    """Scene, method and purpose of the person whose joints are swept so often in a step."""
    return "person_one_foot", f"pymunk {count} sweeps, all of the gap", "failure"


def iterations(rows: Rows) -> Finding:
    """Ten iterations and twenty, on a person that falls, with all of each gap closed in a step."""
    coarse, fine = (rows.of(*person(10)).at(step) for step in (1e-2, MILLISECOND))
    right = rows.of(*person(20)).at(MILLISECOND)
    return Finding(
        "iterations",
        "With `error_bias = 0` and too few iterations a smaller step makes pymunk worse",
        "A falling person is a chain of five unequal bodies. With all of each gap closed in every step, "
        f"pymunk's usual 10 iterations leave an error of {number(coarse.angle)} rad at 10 ms, and "
        f"of {number(fine.angle)} rad at 1 ms. 20 iterations leave {number(right.angle)} rad at 1 ms. Long chains and "
        "unequal masses need more iterations before they need smaller steps.",
        "person",
        fine.angle > 2 * coarse.angle and right.angle < fine.angle / 20,
        tuple(Line(f"{count} iterations", rows.of(*person(count))) for count in (5, 10, 20)),
        "angle",
    )


def forces(rows: Rows) -> Finding:
    """The same motion with 20 and with 100 iterations, but not the same reactions."""
    less, more = (rows.of(*person(count)).at(MILLISECOND) for count in (20, 100))
    return Finding(
        "forces",
        "The right motion does not mean the right forces",
        "Take the same falling person in pymunk at 1 ms. With 20 and with 100 iterations the motion is the same, "
        f"{number(less.angle)} rad off. But with 20 the joint forces are off by {number(100 * less.reaction)} % of "
        f"the largest, and with 100 by {number(100 * more.reaction)} %. Before you use a force, see whether it "
        "changes with the iterations and with the step.",
        "person",
        abs(less.angle - more.angle) < 0.02 * more.angle and less.reaction > 5 * more.reaction,
        tuple(Line(f"{count} iterations", rows.of(*person(count))) for count in (20, 100)),
        "reaction",
    )


def skate(rows: Rows) -> Finding:
    """The naive skate, which no step improves, and a groove."""
    scene, naive, groove = "sleigh", "pymunk default", "pymunk tuned"
    naively, better = rows.of(scene, naive), rows.of(scene, groove).at(MILLISECOND)
    least = min((error for _, error in naively.points("position")), default=math.nan)
    return Finding(
        "skate",
        "A body whose centre may not move sideways is no skate, unless the blade is there",
        "Neither engine has a skate or an ideal wheel. A common trick sets the sideways velocity of the body's centre "
        "to zero after each step. Where the blade is not below the centre, that is another mechanism: after "
        f"{number(seconds(rows.of(scene)))} s it is off by {number(least)} m or more at every step. A groove of pymunk "
        f"that our code aims anew before each step is {number(better.position)} m off at 1 ms.",
        "skate",
        len(naively) >= 3 and least > 1.0 and better.position < 1e-3 * least,
        (
            Line("centre's velocity zeroed", naively),
            Line("groove, aimed anew each step", rows.of(scene, groove)),
        ),
        "position",
    )


def contact(rows: Rows) -> Finding:
    """An ellipse that rolls: as a polygon, as an ellipsoid, and by two rows."""
    scene, polygon, ellipsoid, written = "rolling_ellipse", "pymunk tuned", "mujoco default", "mujoco extended"
    corners, smooth = rows.of(scene, polygon).sweep(), rows.of(scene, ellipsoid).sweep()
    stiff, exact = (rows.of(scene, method).at(MILLISECOND) for method in ("mujoco tuned", written))
    return Finding(
        "contact",
        "A body that is not round does not roll truly on contact as shipped, nor as a polygon",
        f"pymunk has no ellipses. However small the step, a rolling ellipse is {number(corners.plateau)} rad off as a "
        f"polygon of 512 corners (our choice) in pymunk, and {number(smooth.plateau)} rad on MuJoCo's contact as "
        f"shipped. A contact as stiff as the step allows does converge: {number(stiff.angle)} rad at 1 ms. With two "
        f"constraint rows of our code instead of the contact it is {number(exact.angle)} rad.",
        "rolling",
        corners.verdict is smooth.verdict is Verdict.PLATEAU
        and stiff.angle < 0.1 * smooth.plateau
        and exact.angle < 1e-6 * min(corners.plateau, smooth.plateau),
        (
            Line("pymunk, 512 corners", rows.of(scene, polygon)),
            Line("MuJoCo's contact as shipped", rows.of(scene, ellipsoid)),
            Line("MuJoCo's contact, stiff", rows.of(scene, "mujoco tuned")),
            Line("MuJoCo with two rows of ours", rows.of(scene, written)),
        ),
        "angle",
    )


FINDINGS: tuple[Callable[[Rows], Finding], ...] = (
    spring,
    tuned,
    luck,
    reading,
    energy,
    iterations,
    forces,
    skate,
    crank,
    contact,
)


def findings(pages: Mapping[Page, Material]) -> list[Finding]:
    """Those that these rows bear out, in the order of FINDINGS."""
    rows = own_rows(pages)
    return [found for find in FINDINGS if (found := find(rows)).told]


def pictures(told: Iterable[Finding]) -> dict[str, str]:
    """The SVG text of each finding's picture by file name."""
    return {found.picture: svg(draw(found.lines, found.quantity), found.title) for found in told}
