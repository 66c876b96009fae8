"""Where methods fail on open chains, and on a ring that one joint closes; stability maps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from engines import Engine, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco import Hardened
from reference.pendulum.link import PointPendulum
from reference.pendulum.scenes import HundredLinks, LinkPendulum
from reference.rolling.spinning_ring import SpinningRing
from reference.scene import Scene
from reports.cells import Cell
from reports.page import Failure, Observation, StabilityMap
from reports.tables import number

PUBLIC: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
ALL: tuple[Engine, ...] = (*PUBLIC, pymunk.EXTENDED, mujoco.EXTENDED)
SWEPT = replace(mujoco.EXTENDED, variant="extended, free, PGS", coordinates="free", solvers=("PGS",))
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


@lru_cache
def divergence() -> tuple[Observation, ...]:
    """How much a difference of the start has grown, measured on neighbours of the double pendulum."""
    start, rest = np.full(BEYOND.links, BEYOND.angle), np.full(BEYOND.links, BEYOND.rate)
    times = np.array([1.0, LinkPendulum().horizon, 6.0, 9.0, BEYOND.duration])
    growth = BEYOND.chain.divergence(start, rest, times)
    return tuple(
        Observation("the reference, by neighbouring starts", f"{t:.3g} s", f"{number(g)} times the difference at 0 s")
        for t, g in zip(times, growth, strict=True)
    )


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
            "The library's first benchmark, a test of phase alone. MuJoCo's Euler in a tree is symplectic: its energy "
            "only wavers, so at large steps its phase is better than that of RK4, which loses a little energy in every "
            "swing; at small steps order 4 wins. pymunk's pendulum loses its swing at each of these steps, with all of "
            "the gap closed too, and extrapolation can't help once its runs are a swing apart. A user who saw a "
            "pendulum slow down, at a smaller step too, was told that nothing could be done "
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
        cells=_cells(tip(1e4), HEAVY, (1, 10, 100)),
        remark=(
            "Each joint's impulse moves the light link and undoes its neighbour's; a sweep passes on one part in the "
            "mass ratio, so not even a thousand sweeps agree, and closing all of the gap makes it worse. In free "
            "coordinates MuJoCo's PGS, a sweep too, fails like pymunk, and its Newton solver, which factorises, needs "
            "a step that follows the quiver, as the tree does, whose mass matrix has the ratio in it and no row. "
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
            "As shipped the ring is soft: its error does not fall with the step. Hardened a millionfold it is exact to "
            "1e-11. A hundred times harder again, the same solver returns accelerations that are not solutions: at "
            "0.01 s the joint stays shut and the angles look right while the energy is wrong by more than all there "
            "was, and MuJoCo says nothing. Only asking whether the accelerations satisfy their equation shows it: the "
            "sentences that begin with ours are from such a check, which the extended variant makes at the start "
            "before it takes a solver."
        ),
    ),
    Failure(
        title="Beyond the horizon of the double pendulum",
        expected=(
            "It is chaotic: a difference of its start grows as listed, so every error does. Within the horizon methods "
            "can be compared; beyond, the same growth makes all of them wrong, whatever their order."
        ),
        cells=_cells(BEYOND, (*ALL, Lagrange("rk4", "projection")), (1, 10)),
        observations=divergence,
        remark=(
            "An error of 1e-12 times the growth is what the best can reach. Whether a simulation of a chaotic "
            "motion is right can be asked only up to a time, and that time is part of the scene."
        ),
    ),
    Failure(
        title="A hundred links at large steps",
        expected="The chain falls like a rope: nothing in the visible motion is faster than a few radians a second.",
        cells=tuple(
            cell
            for samples in (20, 40, 100)
            for cell in _cells(HundredLinks(), (*PUBLIC, Lagrange("euler", "projection")), (1,), samples)
        ),
        remark=(
            "Hanging, the chain has modes of up to 103 rad/s beside the visible ones, and an explicit method must "
            "follow all of them or explode, though the motion does not show them. Impulses forget the fast modes at "
            "the end of a step: joints open, by a percent or three of the chain, but the numbers stay finite and "
            "the energy near what it was, where Euler in the tree and exact multipliers end in infinity. "
            "Neither is right; at 0.02 s all of them are usable again."
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
