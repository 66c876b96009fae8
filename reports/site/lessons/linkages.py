"""Lessons on pins: the four-bar, the slider-crank, pendulums, and the curves of an instant centre."""

from __future__ import annotations

from engines import mujoco, pymunk
from reference.scenes.four_bar.scenes import (
    DrivenFourBar,
    FreeFourBar,
    OverdrivenFourBar,
    Parallelogram,
    SpinningFourBar,
)
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reports.pages.centrodes.page import exact
from reports.site.lesson import Lesson, Step, Take
from reports.site.live import scenes

SHIPPED = (("pymunk as shipped", pymunk.DEFAULT), ("MuJoCo as shipped", mujoco.DEFAULT))
SET = (("pymunk, tuned", pymunk.TUNED), ("MuJoCo, tuned", mujoco.TUNED))
BOTH = (*SHIPPED, *SET)


def with_steps(methods, every: int):
    """Methods of a take, all with as many steps between samples."""
    return tuple((word, engine, every) for word, engine in methods)


COUPLER = (("coupler", (0.0, 0.0)),)

FOUR_BAR = Lesson(
    "four_bar",
    "The four-bar linkage",
    "four_bar",
    {
        "driven": Take(DrivenFourBar(), with_steps(SHIPPED, 1), traces=COUPLER, centre="coupler"),
        "free": Take(FreeFourBar(), with_steps(SHIPPED, 1), traces=COUPLER, centre="coupler"),
        "set": Take(FreeFourBar(), with_steps(BOTH, 1), traces=COUPLER),
        "large": Take(SpinningFourBar(), with_steps(BOTH, 1), samples=20, traces=COUPLER),
        "heavy": Take(FreeFourBar(density=(0.01, 0.01, 100.0)), with_steps(BOTH, 1), traces=COUPLER),
        "change": Take(Parallelogram(), with_steps(BOTH, 1), traces=COUPLER),
        "overdriven": Take(
            OverdrivenFourBar(),
            with_steps(SHIPPED, 1),
            end=int(OverdrivenFourBar().stopping_time / OverdrivenFourBar().spacing) + 1,
        ),
    },
    (
        Step("driven", frozenset({"paths"}), ("four_bar", "Nine configurations")),
        Step("driven", frozenset({"gaps"}), ("four_bar", "Why the engine's pin is not the ideal one")),
        Step("free", frozenset({"reactions"})),
        Step("set", frozenset({"gaps"}), ("four_bar", "Which step for which mechanism")),
        Step(
            "large",
            frozenset(),
            ("four_bar", "Where methods fail"),
            (
                (
                    "A step of a twentieth of a second",
                    "large",
                    "The bars turn at 10 rad/s and more, so that half a radian passes in a step. No method is accurate "
                    "here. The joints open, and no engine says so.",
                ),
                (
                    "A heavy bar on light ones",
                    "heavy",
                    "The rocker is ten thousand times as dense as the other bars. The motion is as smooth as before; "
                    "sweeps over the joints need many more rounds for it.",
                ),
                (
                    "Through a change point",
                    "change",
                    "Twice a revolution all bars lie in line, and the loop could go on parallel or crossed. The "
                    "bars' inertia decides: it goes on parallel.",
                ),
                (
                    "Driven towards a dead centre",
                    "overdriven",
                    "These bars can follow the crank for a while only. Shown is the time until then. After it no "
                    "position closes the loop, and the reference refuses.",
                ),
            ),
        ),
    ),
    live=scenes.FOUR_BAR,
)

SLIDER_CRANK = Lesson(
    "slider_crank",
    "The slider-crank",
    "slider_crank",
    {
        "driven": Take(DrivenSliderCrank(), with_steps(SHIPPED, 1), traces=(("rod", (0.0, 0.0)),), centre="rod"),
        "free": Take(FreeSliderCrank(), with_steps(SHIPPED, 1), traces=(("rod", (0.0, 0.0)),), centre="rod"),
        "set": Take(FreeSliderCrank(), with_steps(BOTH, 1), traces=(("rod", (0.0, 0.0)),)),
        "large": Take(FreeSliderCrank(), with_steps(BOTH, 1), samples=20),
    },
    (
        Step("driven", frozenset({"paths"}), ("slider_crank", "In motion")),
        Step("driven", frozenset({"centre"})),
        Step("free", frozenset({"reactions"})),
        Step("set", frozenset({"gaps"}), ("slider_crank", "Which step for which mechanism")),
        Step(
            "large",
            frozenset(),
            ("slider_crank", "Where methods fail"),
            (
                (
                    "Steps of a twentieth of a second",
                    "large",
                    "The linkage falls and swings back, the slider stays on its line. Steps this large are wrong, and "
                    "a warning would help.",
                ),
            ),
        ),
    ),
    live=scenes.SLIDER_CRANK,
)

TIP = ((0.5, 0.0), (-0.5, 0.0))
TWO = (("link 2", (0.5, 0.0)),)
PENDULUM = Lesson(
    "pendulum",
    "Pendulums",
    "pendulum",
    {
        "one": Take(BarPendulum(duration=4.0), with_steps(SHIPPED, 1), ends={"link 1": TIP}),
        "two": Take(LinkPendulum(), with_steps(SHIPPED, 1), ends={"link 2": TIP}, traces=TWO),
        "set": Take(LinkPendulum(), with_steps(BOTH, 10), ends={"link 2": TIP}, traces=TWO),
        "ten": Take(TenLinks(), with_steps(SHIPPED, 1), ends={"link 10": TIP}, end=301),
        "heavy": Take(
            LinkPendulum(links=3, tip=100.0, duration=2.0),
            (*with_steps(SHIPPED, 10), ("MuJoCo, tuned", mujoco.TUNED, 10)),
            ends={"link 3": TIP},
        ),
    },
    (
        Step("one", frozenset({"reactions"}), ("pendulum", "In motion")),
        Step("two", frozenset({"paths"})),
        Step("set", frozenset({"paths"}), ("pendulum", "Which step for which mechanism")),
        Step("ten", frozenset({"gaps"})),
        Step(
            "heavy",
            frozenset({"gaps"}),
            ("pendulum", "Where methods fail"),
            (
                (
                    "A heavy tip on light links",
                    "heavy",
                    "The last of three links is a hundred times as heavy. It should swing nearly as if alone, and pull "
                    "the light ones straight.",
                ),
            ),
        ),
    ),
    live=scenes.PENDULUM,
)


def centrode_take(alone: bool) -> Take:
    """The four-bar with both curves of its coupler's instant centre, over the arc on which that turns one way."""
    truth, curves = exact()
    scene = DrivenFourBar()
    fixed = tuple(map(tuple, curves.space_curve.point(_arcs(curves.space_arc)).tolist()))
    moving = tuple(map(tuple, curves.body_curve.point(_arcs(curves.body_arc)).tolist()))
    methods = () if alone else with_steps(SHIPPED, 1)
    return Take(
        scene,
        methods,
        samples=200,
        traces=COUPLER,
        centre="coupler",
        curves=((None, fixed), ("coupler", moving)),
        start=round(truth.t[0] / (scene.duration / 200)) + 1,
        end=round(truth.t[-1] / (scene.duration / 200)),
    )


def _arcs(arc):
    low, high = float(min(arc)), float(max(arc))
    return [low + (high - low) * index / 120 for index in range(121)]


CENTRODES = Lesson(
    "centrodes",
    "Centrodes: any motion as rolling",
    "centrodes",
    {"rolling": centrode_take(True), "engines": centrode_take(False), "whole": FOUR_BAR.takes["driven"]},
    (
        Step("whole", frozenset({"centre"})),
        Step("rolling", frozenset({"centre"}), ("centrodes", "The coupler of the four-bar")),
        Step("rolling", frozenset({"centre", "paths"})),
        Step("engines", frozenset({"centre"}), ("centrodes", "The centre as a measure of an engine")),
        Step("engines", frozenset({"gaps"}), ("centrodes", "Shapes of your own")),
    ),
    live=scenes.FOUR_BAR[:1],
)
