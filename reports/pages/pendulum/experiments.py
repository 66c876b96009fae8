"""Where methods fail on open chains, and on a ring that one joint closes; stability maps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from engines import Engine, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco import Hardened
from reference.pendulum.link import PointPendulum
from reference.pendulum.scenes import HundredLinks, LinkPendulum
from reference.rolling.spinning_ring import SpinningRing
from reference.scene import Scene
from reports.grid.cells import Cell
from reports.pages.page import Failure, Material, Observation, StabilityMap
from reports.pages.pendulum.neighbours import Neighbours
from reports.text.tables import number
from reports.text.unmeasured import UNMEASURED

PUBLIC: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
ALL: tuple[Engine, ...] = (*PUBLIC, pymunk.EXTENDED, mujoco.EXTENDED)
SWEPT = replace(mujoco.EXTENDED, variant="extended, free, PGS", coordinates="free", solvers=("PGS",))
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
    SWEPT,
    variant="extended, free, sparse Newton",
    solvers=("Newton",),
    iterations=5,
    tolerance=1e-20,
    jacobian="sparse",
)

BEYOND = LinkPendulum(duration=12.0, horizon=12.0)


def _cells(
    scene: Scene, engines: Iterable[Engine], every: Iterable[int], samples: int | None = None
) -> tuple[Cell, ...]:
    steps = tuple(every)
    return tuple(Cell(scene, engine, count, "failure", samples) for engine in engines for count in steps)


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


def sweeps(count: int) -> Engine:
    """pymunk closing every gap in one step, by this many sweeps."""
    return replace(pymunk.DEFAULT, variant=f"{count} sweeps, all of the gap", iterations=count, error_bias=0.0)


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
TIPS = (1.0, 1e1, 1e2, 1e3, 1e4)
HEAVY = (*ALL, sweeps(10), sweeps(1000), SWEPT, SOLVED)


def tip(ratio: float) -> LinkPendulum:
    """Three links of which the last is `ratio` times as heavy, for one second."""
    return LinkPendulum(links=3, tip=ratio, duration=1.0, horizon=1.0)


PHASE = _cells(PointPendulum(), (*ALL, SOLVED), (10, 50)) + _cells(
    PointPendulum(), (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED), (150,)
)

LATE = _cells(BEYOND, (*ALL, Lagrange("rk4", "projection")), (1, 10))
HIGHER_ORDER = (mujoco.TUNED, pymunk.EXTENDED, mujoco.EXTENDED, Lagrange("rk4", "projection"))
LARGE_STEPS = tuple(
    cell
    for samples in (20, 40, 100)
    for cell in _cells(HundredLinks(), (*PUBLIC, Lagrange("euler", "projection")), (1,), samples)
)


def beyond_the_horizon(material: Material) -> dict[str, Any]:
    """`worst` [rad]: the largest angle error of the methods of higher order at the smaller step."""
    rows = material.of(cell for cell in LATE if cell.engine in HIGHER_ORDER and cell.every > 1)
    return {"worst": np.max([row.angle for row in rows]) if rows else UNMEASURED}


def opened_joints(material: Material) -> dict[str, Any]:
    """`opened`: how far joints of pymunk opened at most, over a link's length."""
    rows = material.of(cell for cell in LARGE_STEPS if cell.engine in (pymunk.DEFAULT, pymunk.TUNED))
    return {"opened": np.max([row.gap for row in rows]) / HundredLinks().length if rows else UNMEASURED}


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
            "Benchmark A01 of the IFToMM library, a test of phase alone. The inertia of one hinge is constant, and for "
            "that alone MuJoCo's semi-implicit Euler is symplectic: its energy only wavers, so at large steps its "
            "phase is better than that of RK4, which loses a little energy in every swing; at small steps order 4 "
            "wins. A chain of two links or more has no such protection: MuJoCo's own example of a pendulum that "
            "keeps its energy takes RK4 ([pendulum.xml](https://mujoco.readthedocs.io/en/3.2.1/_static/pendulum.xml)). "
            "pymunk as shipped loses nearly all of its energy at each of these steps; with all of the gap closed it "
            "keeps nearly all at the smallest one, but its phase is lost at each. Extrapolation can't help once its "
            "runs are a swing apart. A user who saw a pendulum slow down, at a smaller step too, was told that an "
            "ideal one is in general not possible, as small inconsistencies build up over time "
            "([pymunk#216](https://github.com/viblo/pymunk/issues/216))."
        ),
        columns=("angle", "rate", "gap", "energy"),
    ),
    Failure(
        title="A light chain with a heavy tip",
        expected=(
            "Three links, the last ten thousand times as heavy: it swings nearly as if alone, while the light ones are "
            "pulled straight by forces large against their weight, and quiver about that line at 540 rad/s."
        ),
        cells=_cells(tip(1e4), HEAVY, (1, 10, 100)) + _cells(tip(1e4), (PATIENT,), (10,)),
        remark=(
            "Each joint's impulse moves the light link and undoes its neighbour's; a sweep removes only about "
            "1 / (mass ratio) of the error, so not even a thousand sweeps agree, and as many sweeps as shipped that "
            "close all of the gap are worse than as shipped. pymunk still finishes from 1e-3 s on, but for a thousand "
            "sweeps that close all of the gap. In free coordinates MuJoCo's PGS, a sweep too, tears or starts anew at "
            "each step in the extended variant, because that divides the regularisation by 1e8, far beyond what "
            "solimp admits, and stops after 100 sweeps; at 1e-3 s with the stiffness that is documented and 10000 "
            "sweeps it finishes. MuJoCo's Newton solver, which factorises, needs a step that follows the quiver, and "
            "so does the tree, whose mass matrix has the ratio in it and no row. "
            "With weak chains users are told to raise the iterations or to take reduced coordinates "
            "([PhysX#308](https://github.com/NVIDIAGameWorks/PhysX/issues/308))."
        ),
    ),
    Failure(
        title="A ring of a hundred links, closed by one joint",
        expected=(
            "It turns like a rigid wheel. The chain is a tree; the hundredth joint closes it, by a row that reaches "
            "through a hundred coordinates."
        ),
        cells=_cells(SpinningRing(), RING, (1, 10)),
        remark=(
            "As shipped the ring is soft: its error does not fall with the step. Hardened a millionfold its angles "
            'are right{% filter if_measured %} to {{ at("mujoco Newton, softening 1e-6", 1e-2).angle | number }} '
            "rad{% endfilter %}. A hundred times harder again, the same solver returns accelerations that are not "
            "solutions: at 0.01 s the joint stays shut and the angles look right while the energy is wrong by more "
            'than all there was{% filter if_measured %} ({{ at("mujoco Newton, softening 1e-8", 1e-2).energy | '
            "number }} times as much){% endfilter %}, without a warning. This is no fault of a model that MuJoCo "
            "documents: its softness is 1e8 times less than solimp admits, and only fields of the compiled model can "
            "ask for it ([solver "
            "parameters](https://mujoco.readthedocs.io/en/stable/modeling.html#solver-parameters)). Only asking "
            "whether the accelerations satisfy their equation shows it: the sentences that begin with ours are from "
            "such a check, which the extended variant makes at the start before it takes a solver."
        ),
    ),
    Failure(
        title="Beyond the horizon of the double pendulum",
        expected=(
            "It is chaotic: a difference of its start grows as listed, so every error does. Within the horizon methods "
            "can be compared; beyond, the same growth takes one digit after another from each, whatever its order."
        ),
        cells=LATE,
        tasks=(PARTING,),
        words=beyond_the_horizon,
        observations=divergence,
        remark=(
            "An error of 1e-12 times the growth is what the best can reach. At 12 s the methods of first order, "
            "pymunk tuned among them, are lost at both steps, while those of higher order are still right at 1e-3 "
            "s{% filter if_measured %}, to {{ worst | number }} rad or better{% endfilter %}: their smaller error "
            "leaves them more time. Whether a simulation of a chaotic motion is right can be asked only up to a "
            "time, and that time is part of the scene."
        ),
    ),
    Failure(
        title="A hundred links at large steps",
        expected="The chain falls like a rope: nothing in the visible motion is faster than a few radians a second.",
        cells=LARGE_STEPS,
        words=opened_joints,
        remark=(
            "Hanging, the chain has modes of up to 103 rad/s beside the visible ones, and an explicit method must "
            "follow all of them or explode, though the motion does not show them. Impulses forget the fast modes at "
            "the end of a step: joints open{% filter if_measured %}, by up to {{ opened | number }} times a link's "
            "length{% endfilter %}, but the numbers stay finite and the energy near what it was. MuJoCo's Euler in "
            "the tree starts anew at 0.1 s, and stays finite but wrong at 0.05 s; its RK4 starts anew at both, and "
            "exact multipliers under Euler end in infinity. No method is right; at 0.02 s all of them can be "
            "compared again."
        ),
    ),
)

CHAINS = (2, 5, 10, 20, 50)
SWEEPS = (2, 5, 10, 30)

MAPS: tuple[StabilityMap, ...] = (
    StabilityMap(
        name="tips",
        title="How heavy may the tip be, at which step?",
        parameter="tip's mass over a link's",
        cells=tuple(
            (ratio, Cell(tip(ratio), engine, every, "map", samples=20))
            for engine in (*PUBLIC, mujoco.EXTENDED, SOLVED)
            for ratio in TIPS
            for every in (1, 5, 50)
        ),
        remark="The steps are 50, 10 and 1 ms. A heavy tip is hard for sweeps and for large steps of a tree alike.",
    ),
    StabilityMap(
        name="sweeps",
        title="How many sweeps for how many links, when all of the gap is closed?",
        parameter="links",
        cells=tuple(
            (float(links), Cell(LinkPendulum(links=links, duration=1.0, horizon=1.0), sweeps(count), every, "map", 20))
            for count in SWEEPS
            for links in CHAINS
            for every in (5, 50)
        ),
        remark=(
            "With too few sweeps what they leave is corrected again in the next step, too much of it, until the motion "
            "explodes; a smaller step explodes as well. As shipped pymunk closes a gap so slowly that nothing "
            "explodes, and stays soft instead."
        ),
    ),
)
