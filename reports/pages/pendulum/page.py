"""The page of pendulums with 1 to 100 links."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from engines import mujoco, pymunk
from engines.lagrange import Lagrange
from engines.registry import VARIANTS
from reference.chapter import errata
from reference.numerics.calculus import derivative
from reference.scenes.pendulum.link import BarPendulum, PointPendulum
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum, SpinningRing, TenLinks
from reports.model.page import FEATURED, Failure, Material, Observation
from reports.model.tasks import Task, Values
from reports.pages.atlas.maps import stiffest_hanging
from reports.pages.common import MAIN_METHODS, PUBLIC, cells, described, scene_page, sweeps
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.tables import markdown, number
from reports.write.unmeasured import UNMEASURED


@dataclass(frozen=True)
class NeighbourGrowth(Task):
    """A task with the growth of a small difference between two motions of a chain, at `times` [s]."""

    scene: LinkPendulum
    times: tuple[float, ...]
    seconds: ClassVar[float] = 4.0  # measured with two links
    words: ClassVar[str] = "growth of a difference in {0.scene.name}"

    def run(self) -> Values:
        scene = self.scene
        start, rate = np.full(scene.links, scene.angle), np.full(scene.links, scene.rate)
        return {"growth": scene.chain.divergence(start, rate, np.array(self.times))}


BEYOND = LinkPendulum(duration=12.0, horizon=12.0)
DIVERGENCE = NeighbourGrowth(BEYOND, (1.0, LinkPendulum().horizon, 6.0, 9.0, BEYOND.duration))


def divergence(material: Material) -> list[Observation]:
    method = "the reference, by neighbouring starts"
    answer = material.answers.get(DIVERGENCE)
    if answer is None or not answer.finished:
        return [Observation(method, "", answer.told)] if answer else []
    return [
        Observation(method, f"{t:.3g} s", f"{number(growth)} times the difference at 0 s")
        for t, growth in zip(DIVERGENCE.times, answer.array("growth"), strict=True)
    ]


PENDULUM_SPARSE_NEWTON = replace(
    mujoco.EXTENDED,
    variant="extended, free, sparse Newton",
    coordinates="free",
    solvers=("Newton",),
    iterations=5,
    tolerance=1e-20,
    jacobian="sparse",
)
RING_METHODS = (mujoco.DEFAULT, mujoco.TUNED, mujoco.EXTENDED, pymunk.TUNED)
HEAVY_TIP_METHODS = (*MAIN_METHODS, sweeps(10), sweeps(1000), PENDULUM_SPARSE_NEWTON)


HEAVY_TIP = LinkPendulum(links=3, tip=1e4, duration=1.0, horizon=1.0)

# Extrapolated variants are run at the largest step only, since they fail at each step.
PHASE = cells(PointPendulum(), PUBLIC, (10, 50, 150)) + cells(
    PointPendulum(), (pymunk.EXTENDED, mujoco.EXTENDED), (10,)
)

BEYOND_HORIZON = cells(BEYOND, (*MAIN_METHODS, Lagrange("rk4", "projection")), (1, 10))
HIGHER_ORDER = (mujoco.TUNED, pymunk.EXTENDED, mujoco.EXTENDED, Lagrange("rk4", "projection"))
LARGE_STEPS = tuple(
    cell
    for samples in (20, 40, 100)
    for cell in cells(HundredLinks(), (*PUBLIC, Lagrange("euler", "projection")), (1,), samples)
)


def beyond_the_horizon(material: Material) -> dict[str, Any]:
    """`worst`: the largest angle error [rad] of HIGHER_ORDER at the smaller step."""
    rows = material.of(cell for cell in BEYOND_HORIZON if cell.engine in HIGHER_ORDER and cell.every > 1)
    return {"worst": np.max([row.angle for row in rows]) if rows else UNMEASURED}


def opened_joints(material: Material) -> dict[str, Any]:
    """`opened`: the largest gap in pymunk relative to the length of a link. `fastest`: the chain's highest frequency
    [rad/s]."""
    rows = material.of(cell for cell in LARGE_STEPS if cell.engine in (pymunk.DEFAULT, pymunk.TUNED))
    opened = np.max([row.gap for row in rows]) / HundredLinks().length if rows else UNMEASURED
    return {"opened": opened, "fastest": stiffest_hanging(HundredLinks())}


# MuJoCo with free bodies, where each joint is an equality constraint.
FREE_COORDINATE_METHODS = (
    replace(mujoco.DEFAULT, variant="default, free coordinates", coordinates="free"),
    PENDULUM_SPARSE_NEWTON,
)
FEATURED_VARIANTS = (*FEATURED, *(engine.variant for engine in FREE_COORDINATE_METHODS))


def figures(material: Material) -> dict[str, str]:
    single, two, ten, hundred = BarPendulum(), LinkPendulum(), TenLinks(), HundredLinks()
    end = ((single.length / 2, 0.0),)
    strips = (
        Strip(single, "One link", 12, end=1.1, ends={"link 1": end}),
        Strip(two, "Two links, and the path of the tip", 21, end=2.0, ends={"link 2": end}, trace=("link 2", end[0])),
        Strip(ten, "Ten links", 11, end=2.0, ends={"link 10": end}),
        Strip(hundred, "A hundred links", 9, ends={"link 100": end}),
    )
    return {"stroboscope": svg(stroboscope(strips), "Pendulums of one, two, ten and a hundred links in motion")}


def answers() -> str:
    """A Markdown table of the answers to problems 18.5.1 and 18.5.2, with their differences from derivatives."""
    length, angles, rates, turning = errata.BAR, errata.PHI, errata.PHI_RATE, errata.PHI_ACCELERATION
    first = errata.velocities(length, angles, rates)
    second = errata.accelerations(length, angles, rates, turning)
    a, b_relative_to_a = ((lambda t, bar=bar: errata.bar_end(t, bar)) for bar in (0, 1))
    positions = {"a": a, "b_relative_to_a": b_relative_to_a, "b": lambda t: a(t) + b_relative_to_a(t)}
    body = []
    for problem, solution, order, unit in (("18.5.1", first, 1, "m/s"), ("18.5.2", second, 2, "m/s²")):
        for part, (name, position) in zip("abc", positions.items(), strict=True):
            answer = getattr(solution, name)
            miss = np.abs(answer - derivative(position, 0.0, order)).max()
            body.append([f"{problem} {part}", f"({answer[0]:.5f}, {answer[1]:.5f}) {unit}", number(float(miss))])
    return markdown(["problem", "answer", "difference to the derivative"], body, left=2)


def context(material: Material) -> Mapping[str, Any]:
    numbers = (errata.BAR, *errata.PHI, *errata.PHI_RATE, *errata.PHI_ACCELERATION)
    return {"answers": answers(), "numbers": numbers}


PAGE = scene_page(
    "pendulum",
    title="Pendulums of 1, 2, 10 and 100 links",
    lesson="Open chains: in reduced coordinates the joints are exact; pymunk computes their impulses by iteration.",
    scenes=(BarPendulum(), LinkPendulum(), TenLinks(), HundredLinks(), PointPendulum()),
    advised="pendulum_2",
    engines=(*VARIANTS, *FREE_COORDINATE_METHODS),
    compared=lambda scene, engine: engine not in FREE_COORDINATE_METHODS or scene.name != PointPendulum.name,
    failures=described(
        __file__,
        Failure("Two thousand seconds of a point pendulum", cells=PHASE, columns=("angle", "rate", "gap", "energy")),
        Failure(
            "A light chain with a heavy tip",
            # "pymunk extended" is run at the largest step only, because it takes minutes at the smallest step.
            cells=cells(HEAVY_TIP, [engine for engine in HEAVY_TIP_METHODS if engine != pymunk.EXTENDED], (1, 10, 100))
            + cells(HEAVY_TIP, (pymunk.EXTENDED,), (1,)),
        ),
        Failure("A ring of a hundred links, closed by one joint", cells=cells(SpinningRing(), RING_METHODS, (1, 10))),
        Failure(
            "Beyond the horizon of the double pendulum",
            cells=BEYOND_HORIZON,
            tasks=(DIVERGENCE,),
            context=beyond_the_horizon,
            observations=divergence,
        ),
        Failure("A hundred links at large steps", cells=LARGE_STEPS, context=opened_joints),
        period=lambda: f"{PointPendulum().pendulum.period:.7f}",
        swings=lambda: f"{PointPendulum().duration / PointPendulum().pendulum.period:.1f}",
        oscillates=lambda: number(stiffest_hanging(HEAVY_TIP)),
    ),
    featured=lambda row: row.variant in FEATURED_VARIANTS,
    figures=figures,
    context=context,
)
