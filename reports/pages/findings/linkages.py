"""What linkages teach: loops, settings, luck, the moment of reading, and driven cranks."""

from __future__ import annotations

from reports.model.convergence import Verdict
from reports.pages.findings.finding import MILLISECOND, TENTH, Finding
from reports.pages.findings.lookup import Rows
from reports.pages.findings.pictures import Line
from reports.write.unmeasured import UNMEASURED, formatted, number

ENGINES = {"pymunk": "pymunk", "mujoco": "MuJoCo"}  # as their makers write them


def spring(rows: Rows) -> Finding:
    """MuJoCo's loop as shipped: by Euler and by RK4 the same limit."""
    scene, shipped, integrated, tuned = "free_four_bar", "mujoco default", "mujoco RK4 alone", "mujoco tuned"
    limit, same = rows.sweep(scene, shipped), rows.sweep(scene, integrated)
    gap, wide = rows.sweep(scene, integrated, "gap"), rows.sweep(scene, shipped, "gap")
    stiff = rows.at(MILLISECOND, scene, tuned)
    return Finding(
        "spring",
        "A loop in MuJoCo is closed by a spring, and no smaller step removes the spring's error",
        f"As the step goes to zero, a freely swinging four-bar as shipped is {number(same.plateau)} rad off. The pin "
        f"that closes its loop is {number(1e3 * gap.plateau)} mm open, by Euler and by RK4 alike. The cure is a "
        f"stiffer `solref` and `solimp`: with both as stiff as is documented, and RK4, the four-bar is "
        f"{number(stiff.angle)} rad off at 1 ms.",
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
    found, best = rows.sweep(scene, shipped), rows.at(MILLISECOND, scene, shipped)
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
        before, after = (rows.at(MILLISECOND, scene, f"{engine} {variant}") for variant in ("default", "tuned"))
        wins[engine] = before.angle / after.angle if after.angle else before.angle
        costs[engine] = after.cpu / before.cpu if before.cpu else UNMEASURED  # not timed
        better = better and after.angle < rows.at(TENTH, scene, f"{engine} default").angle
    return Finding(
        "tuned",
        "A few documented settings win more than a step a tenth as large",
        "Take the free four-bar at 1 ms. In pymunk (`error_bias = 0`, and as many iterations as the loop needs) they "
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
    """pymunk's velocities belong half a step later than its positions."""
    scene, plain, leapfrog = "free_four_bar", "pymunk tuned", "pymunk leapfrog"
    first, second = rows.sweep(scene, plain), rows.sweep(scene, leapfrog)
    before, after = rows.at(MILLISECOND, scene, plain), rows.at(MILLISECOND, scene, leapfrog)
    return Finding(
        "reading",
        "The moment at which pymunk's velocities are read decides the order",
        "After a step $h$ the positions are those of $t$, and the velocities those of $t + h/2$. Start them half a "
        "step apart, and read the velocity at $t$ as the mean of its two neighbours. With the same engine and "
        f"settings the order is then {formatted('%.1f', second.order)} instead of {formatted('%.1f', first.order)}. "
        f"At 1 ms the free four-bar is {number(after.angle)} rad off instead of {number(before.angle)} rad.",
        "four_bar",
        abs(first.order - 1) < 0.1 and abs(second.order - 2) < 0.1 and after.angle < before.angle / 5,
        (
            Line("read as it is", rows.of(scene, plain)),
            Line("read half a step apart", rows.of(scene, leapfrog)),
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
    soft = [rows.at(step, scene, shipped, "failure") for step in (MILLISECOND, TENTH)]
    over, right = rows.at(MILLISECOND, scene, stiff, "failure"), rows.at(MILLISECOND, scene, inside, "failure")
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
            Line("armature, stiff loop", rows.of(scene, inside, "failure")),
        ),
        "angle",
    )
