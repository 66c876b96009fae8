"""Where methods fail on open chains, and on a ring that one joint closes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engines import Engine, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco import Hardened
from reference.scenes.many_links import SpinningRing
from reference.scenes.pendulum.link import PointPendulum
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Task, Values
from reports.pages.common import ALL, PUBLIC, cells, sweeps
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED


@dataclass(frozen=True)
class Neighbours(Task):
    """A chain that starts at one angle and rate for all links, looked at at times [s]."""

    scene: LinkPendulum
    times: tuple[float, ...]

    @property
    def cost(self) -> float:
        return 0.3 * max(self.times)  # measured on two links: three neighbours and the motion itself, for 12 s

    @property
    def label(self) -> str:
        return f"neighbouring starts of {self.scene.name}"

    def run(self) -> Values:
        """`growth` (times,): how many times larger a small difference of the start has become."""
        scene = self.scene
        start, rate = np.full(scene.links, scene.angle), np.full(scene.links, scene.rate)
        return {"growth": scene.chain.divergence(start, rate, np.array(self.times))}


BEYOND = LinkPendulum(duration=12.0, horizon=12.0)


PARTING = Neighbours(BEYOND, (1.0, LinkPendulum().horizon, 6.0, 9.0, BEYOND.duration))


def divergence(material: Material) -> list[Observation]:
    """How much a difference of the start has grown, measured on neighbours of the double pendulum."""
    if (answer := material.answers.get(PARTING)) is None:
        return []
    method = "the reference, by neighbouring starts"
    if not answer.finished:
        return [Observation(method, "", answer.told)]
    return [
        Observation(method, f"{t:.3g} s", f"{number(growth)} times the difference at 0 s")
        for t, growth in zip(PARTING.times, answer.array("growth"), strict=True)
    ]


FREE = replace(mujoco.EXTENDED, coordinates="free")
# Its sweeps lose the motion at any step: runs at other steps would tell nothing of its error.
SWEPT = replace(FREE, variant="extended, free, PGS, no estimate", solvers=("PGS",), estimates=False)
# Nothing but documented settings; at the largest step, where it starts anew as others do, it takes half a minute.
PATIENT = replace(
    mujoco.TUNED,
    variant="tuned, free, PGS, 10000 sweeps",
    coordinates="free",
    solvers=("PGS",),
    iterations=10000,
    tolerance=1e-20,
)
SOLVED = replace(
    FREE,
    variant="extended, free, sparse Newton",
    solvers=("Newton",),
    iterations=5,
    tolerance=1e-20,
    jacobian="sparse",
)


def hardened(variant: str, softening: float, factorisation: str) -> Engine:
    """MuJoCo's own Newton solver on a loop whose compliance is divided by 1/softening."""
    return replace(
        mujoco.EXTENDED,
        variant=variant,
        stiffness=Hardened(softening=softening),
        solvers=("Newton",),
        iterations=6,
        jacobian=factorisation,
    )


RING = (
    mujoco.DEFAULT,
    mujoco.TUNED,
    hardened("Newton, softening 1e-6", 1e-6, "dense"),
    hardened("Newton, softening 1e-8", 1e-8, "dense"),
    hardened("Newton, softening 1e-8, sparse", 1e-8, "sparse"),
    mujoco.EXTENDED,
    pymunk.TUNED,
)
HEAVY = (*ALL, sweeps(10), sweeps(1000), SWEPT, SOLVED)


def tip(ratio: float) -> LinkPendulum:
    """Three links of which the last is `ratio` times as heavy, for one second."""
    return LinkPendulum(links=3, tip=ratio, duration=1.0, horizon=1.0)


# Extrapolated, a smaller step takes up to six seconds, and is lost as the larger one is.
PHASE = cells(PointPendulum(), PUBLIC, (10, 50, 150)) + cells(
    PointPendulum(), (pymunk.EXTENDED, mujoco.EXTENDED), (10,)
)

LATE = cells(BEYOND, (*ALL, Lagrange("rk4", "projection")), (1, 10))
HIGHER_ORDER = (mujoco.TUNED, pymunk.EXTENDED, mujoco.EXTENDED, Lagrange("rk4", "projection"))
LARGE_STEPS = tuple(
    cell
    for samples in (20, 40, 100)
    for cell in cells(HundredLinks(), (*PUBLIC, Lagrange("euler", "projection")), (1,), samples)
)


def beyond_the_horizon(material: Material) -> dict[str, Any]:
    """`worst` [rad]: the largest angle error of the methods of higher order at the smaller step."""
    rows = material.of(cell for cell in LATE if cell.engine in HIGHER_ORDER and cell.every > 1)
    return {"worst": np.max([row.angle for row in rows]) if rows else UNMEASURED}


def fastest(scene: LinkPendulum) -> float:
    """The highest frequency of small oscillations about hanging [rad/s]."""
    return float(scene.chain.modes()[0][-1])


def opened_joints(material: Material) -> dict[str, Any]:
    """`opened`: how far joints of pymunk opened at most, over a link's length; `fastest` [rad/s], the chain's mode."""
    rows = material.of(cell for cell in LARGE_STEPS if cell.engine in (pymunk.DEFAULT, pymunk.TUNED))
    opened = np.max([row.gap for row in rows]) / HundredLinks().length if rows else UNMEASURED
    return {"opened": opened, "fastest": fastest(HundredLinks())}


FAILURES: tuple[Failure, ...] = (
    Failure(
        title="Two thousand seconds of a point pendulum",
        expected=(
            f"From horizontal it swings to and fro every {PointPendulum().pendulum.period:.7f} s, "
            f"{PointPendulum().duration / PointPendulum().pendulum.period:.1f} times. Its energy fixes its period, so "
            "whatever a method does to the energy becomes a phase that grows for ever."
        ),
        cells=PHASE,
        remark=(
            "Benchmark A01 of the IFToMM library, a test of phase alone. MuJoCo's semi-implicit Euler is symplectic if "
            "the inertia is constant, as that of one hinge is: its energy only wavers. So at large steps its phase is "
            "better than that of RK4, which loses a little energy in every swing. At small steps RK4 is better. The "
            "inertia of two links or more is not constant. MuJoCo's own example of a pendulum that keeps its energy "
            "takes RK4 ([pendulum.xml](https://mujoco.readthedocs.io/en/3.2.1/_static/pendulum.xml)). As shipped "
            "pymunk loses nearly all of its energy at each of these steps. With all of the gap closed it keeps nearly "
            "all of it at the smallest step, but the phase is lost at each. Extrapolation can't help once its runs are "
            "a swing apart. A user saw a pendulum slow down, at a smaller step too. The answer was that an ideal one "
            "is in general not possible, as small inconsistencies build up over time "
            "([pymunk#216](https://github.com/viblo/pymunk/issues/216))."
        ),
        columns=("angle", "rate", "gap", "energy"),
    ),
    Failure(
        title="A light chain with a heavy tip",
        expected=(
            "Three links, the last ten thousand times as heavy. It swings nearly as if alone. The light ones are "
            "pulled straight by forces that are large against their weight, and oscillate about that line with up to "
            f"{number(fastest(tip(1e4)))} rad/s."
        ),
        # A run of pymunk extended at the smaller steps takes half a minute and four minutes.
        cells=cells(tip(1e4), [engine for engine in HEAVY if engine != pymunk.EXTENDED], (1, 10, 100))
        + cells(tip(1e4), (pymunk.EXTENDED,), (1,))
        + cells(tip(1e4), (PATIENT,), (10,)),
        remark=(
            "The impulse of one joint moves the light link, and undoes what its neighbour's did. A sweep removes only "
            "about $1 / r$ of the error, where $r$ is the ratio of the masses, so even a thousand sweeps are too few. "
            "Ten sweeps, the number as shipped, are worse if they close all of the gap. At 1 ms and below pymunk "
            "finishes, as shipped and tuned. A thousand sweeps that close all of the gap fail at 0.1 ms. The extended "
            "variant is run at the largest step alone, and says that its error is not resolved: at the others a run "
            "takes up to four minutes. MuJoCo's PGS is a sweep too. In free "
            "coordinates the extended variant tears or starts anew with it at each step: it divides the regularisation "
            "by 1e8, far beyond what `solimp` admits, and stops after 100 sweeps. With the documented stiffness and "
            "10000 sweeps PGS finishes at 1 ms. MuJoCo's Newton solver factorises a matrix, and needs a step that "
            "follows the oscillation. So does the tree, which has the ratio in its mass matrix and has no rows. A user "
            "with a weak chain was told to raise the iterations or to take reduced coordinates "
            "([PhysX#308](https://github.com/NVIDIAGameWorks/PhysX/issues/308))."
        ),
    ),
    Failure(
        title="A ring of a hundred links, closed by one joint",
        expected=(
            "It turns like a rigid wheel. The chain is a tree. The hundredth joint closes it, by rows that reach "
            "through a hundred coordinates."
        ),
        cells=cells(SpinningRing(), RING, (1, 10)),
        remark=(
            "As shipped the ring is soft: its error does not fall with the step. Made a million times harder, its "
            'angles are right{% filter if_measured %} to {{ at("mujoco Newton, softening 1e-6", 1e-2).angle | number '
            "}} rad{% endfilter %}. A hundred times harder again, the same solver gives accelerations that are no "
            "solutions. "
            "At 0.01 s the joint stays shut and the angles look right, but the error of the energy is more than all "
            'there was{% filter if_measured %} ({{ at("mujoco Newton, softening 1e-8", 1e-2).energy | number }} times '
            "as much){% endfilter %}. There is no warning. This is no fault of a model that MuJoCo documents: its "
            "softness is 1e8 times less than `solimp` admits, and only fields of the compiled model can ask for it "
            "([solver parameters](https://mujoco.readthedocs.io/en/stable/modeling.html#solver-parameters)). One can "
            "see it only by testing whether the accelerations satisfy their equation. The extended variant does so at "
            "the start, before it chooses a solver; the messages that begin with 'ours' are from this test."
        ),
    ),
    Failure(
        title="Beyond the horizon of the double pendulum",
        expected=(
            "It is chaotic: a difference of its start grows as listed, and so does every error. Within the horizon "
            "methods can be compared. Beyond it, each of them loses one digit after another, whatever its order."
        ),
        cells=LATE,
        tasks=(PARTING,),
        words=beyond_the_horizon,
        observations=divergence,
        remark=(
            "The best that a method can reach is 1e-12 times the growth. At 12 s the methods of first order, pymunk "
            "tuned among them, are lost at both steps. Those of higher order are still right at 1 ms{% filter "
            "if_measured %}, to {{ worst | number }} rad or better{% endfilter %}, since their smaller error needs "
            "more time to grow. One can ask only up to a certain time whether a simulation of a chaotic motion is "
            "right, and that time is part of the scene."
        ),
    ),
    Failure(
        title="A hundred links at large steps",
        expected="The chain falls like a rope: nothing in the visible motion is faster than a few radians a second.",
        cells=LARGE_STEPS,
        words=opened_joints,
        remark=(
            "When it hangs, the chain has modes of up to {{ fastest | number }} rad/s. The motion does not show the "
            "fast ones, but an explicit method must follow all of them, or its numbers grow without limit. pymunk's "
            "impulses forget the fast modes at the end of a step. Its joints open{% filter if_measured %}, by up to {{ "
            "opened | number }} times a link's length{% endfilter %}, but the numbers stay finite and the energy stays "
            "near what it was. MuJoCo's Euler in the tree starts anew at 0.1 s, and at 0.05 s it ends with wrong "
            "numbers. RK4 starts anew at both, and exact multipliers under Euler end in infinity. At these two steps "
            "no method is right; at 0.02 s all of them can be compared again."
        ),
    ),
)
