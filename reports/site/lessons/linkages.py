"""Lessons on the four-bar, the slider-crank, pendulums and centrodes."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.scenes.slider_crank import DrivenSliderCrank, FreeSliderCrank
from reports.pages.centrodes.page import exact
from reports.site.lesson import BOTH, CENTRE, FORCES, Claim, Experiment, Guess, Lesson, LessonQuantity
from reports.site.live.sliders import Live, Point, Slider

JOINTS_OPEN = LessonQuantity("gap", "widest gap of a joint")
ENERGY = LessonQuantity("energy", "the energy changes by")
RATIOS = (0.01, 0.1, 1.0, 10.0, 100.0)
DENSITIES = tuple(1.0 if ratio == 1 else (1.0, ratio, 1.0) for ratio in RATIOS)
DENSITY = Slider("density", "the coupler's density to that of the others", DENSITIES, tuple(map("{:g}".format, RATIOS)))
HEAVY = DENSITIES[-1]
COUPLER = FreeFourBar().coupler
COUPLERS = Slider("coupler", "coupler [m]", (0.53, COUPLER, 0.65, 0.9), ("0.53", f"{COUPLER:.3f}", "0.65", "0.9"))
REVOLUTION = (15, 30, 60, 120, 300, 600, 1200)
DRIVEN = Live(
    "driven",
    DrivenFourBar(),
    REVOLUTION,
    60,
    3,
    (
        Slider("crank", "crank [m]", (0.2, 0.4, 0.45)),
        COUPLERS,
        replace(DENSITY, values=DENSITIES[2:], texts=("1", "10", "100")),
    ),
    traces=(("coupler", (0.0, 0.0)),),
    centre="coupler",
)
FREE = Live(
    "let go",
    FreeFourBar(),
    (25, 50, 100, 200, 500, 1000, 2000),
    50,
    3,
    (
        Slider("crank", "crank [m]", (0.3, 0.4, 0.45)),
        replace(DENSITY, values=DENSITIES[::2], texts=("0.01", "1", "100")),
    ),
    traces=(("coupler", (0.0, 0.0)),),
)

ASSEMBLIES = replace(
    DRIVEN, word="two assemblies", sliders=(Slider("branch", "place of C", (1, -1), ("above", "below")),)
)

FOUR_BAR = Lesson(
    "four_bar",
    "The four-bar linkage",
    "four_bar",
    (DRIVEN, FREE, ASSEMBLIES),
    (
        Experiment("driven", section="Nine configurations"),
        Experiment(
            "driven",
            after={"bias": 0.0},
            claims=(Claim("munk", most=0.1),),
            causes=(({"bias": None, "iterations": 100}, Claim("munk", least=10)),),
            section="Why the engine's pin is not the ideal one",
            guesses=(
                Guess({"iterations": 100}, claims=(Claim("munk", 0.9, 1.1),)),
                Guess({"steps": 600}, claims=(Claim("munk", 0.1, 0.5),)),
                Guess(),
            ),
        ),
        Experiment(
            "let go",
            {"integrator": 1},
            {"steps": 2000},
            (Claim("mujoco", 0.8, 1.2),),
            (({"timeConstant": 0.002, "impedance": 0.9999}, Claim("mujoco", most=0.1)),),
            guesses=(Guess(times={"mujoco": 0.1}), Guess(times={"mujoco": 1e-4}), Guess(times={"mujoco": 1.0})),
        ),
        Experiment(
            "let go",
            after=BOTH,
            claims=(Claim("munk", most=0.2), Claim("mujoco", most=0.001)),
            section="Which step for which mechanism",
            guesses=(
                Guess(times={"munk": 1 / 3, "mujoco": 1 / 3}),
                Guess(times={"mujoco": 1 / 3}),
                Guess(times={"mujoco": 1e-4}),
            ),
        ),
        Experiment(
            "let go",
            {"bias": 0.0, "steps": 1000},
            {"iterations": 1},
            (Claim("munk", least=10),),
            (({"iterations": 2}, Claim("munk", most=0.1)), ({"steps": 500}, Claim("munk", most=1.0))),
            guesses=(Guess(times={"munk": 2.0}), Guess(times={"munk": 3000.0}), Guess(times={"munk": 1.0})),
        ),
        Experiment(
            "let go",
            {"density": HEAVY, **BOTH},
            {"iterations": 10},
            (Claim("munk", least=10), Claim("mujoco", 1.0, 1.0)),
            (({"iterations": 100}, Claim("munk", most=0.1)), ({"density": 1.0}, Claim("munk", most=0.1))),
            FORCES,
            section="Where methods fail",
            guesses=(
                Guess(times={"munk": 1.0}),
                Guess({"iterations": 10, "steps": 2000}, claims=(Claim("munk", least=100),)),
                Guess(),
            ),
        ),
        Experiment(
            "two assemblies",
            after={"branch": -1},
            claims=(Claim("exact", 0.999, 1.001, "rates"),),
            overlays=CENTRE,
            widget="errata",
            guesses=(Guess(), Guess(), Guess()),
            quantities=(LessonQuantity("rates", "the rocker turns at", ("rocker",)),),
        ),
    ),
)

ROD = (("rod", (0.0, 0.0)),)
SLIDER_CRANK = Lesson(
    "slider_crank",
    "The slider-crank",
    "slider_crank",
    (
        Live(
            "driven",
            DrivenSliderCrank(),
            REVOLUTION,
            60,
            3,
            (
                Slider("crank", "crank [m]", (0.15, 0.3, 0.45, 0.6)),
                Slider("slider_mass", "mass of the slider [kg]", (0.05, 0.5, 5.0, 50.0)),
            ),
            traces=ROD,
            centre="rod",
        ),
        Live(
            "let go",
            FreeSliderCrank(),
            (50, 100, 200, 400, 1000, 2000, 4000),
            50,
            3,
            (
                Slider("crank", "crank [m]", (0.15, 0.3, 0.45, 0.6)),
                Slider("slider_mass", "mass of the slider [kg]", (0.05, 0.5, 5.0)),
            ),
            traces=ROD,
            centre="rod",
        ),
    ),
    (
        Experiment("driven", overlays=CENTRE, section="In motion"),
        Experiment(
            "let go",
            after=BOTH,
            claims=(
                Claim("munk", most=0.1),
                Claim("mujoco", most=0.1),
                Claim("munk", 1e-4, 5e-3, "gap", is_value=True),
                Claim("munk", -0.1, 0.1, "energy"),
            ),
            guesses=(
                Guess({}, {"munk": 0.01}),
                Guess({}, claims=(Claim("munk", 1.0, is_value=True), Claim("munk", 0, 0.01, "gap", is_value=True))),
                Guess({"iterations": 100}, claims=(Claim("munk", 0.9, 1.1),)),
            ),
            quantities=(JOINTS_OPEN, ENERGY),
        ),
        Experiment(
            "driven",
            {"slider_mass": 50.0, **BOTH},
            {"iterations": 10},
            (Claim("munk", least=10),),
            (
                ({"iterations": 100}, Claim("munk", most=0.1)),
                ({"slider_mass": 0.5}, Claim("munk", most=0.1)),
                ({"iterations": None}, Claim("munk", most=1e-3, is_value=True)),
                ({"iterations": None}, Claim("mujoco", most=1e-3, is_value=True)),
            ),
            FORCES,
            section="Where methods fail",
            guesses=(Guess(times={"munk": 1.0}), Guess(times={"munk": 10.0}), Guess(times={"munk": 7000.0})),
        ),
    ),
)

TIP = ((0.5, 0.0), (-0.5, 0.0))
PENDULUM = Lesson(
    "pendulum",
    "Pendulums",
    "pendulum",
    (
        Live(
            "one link",
            BarPendulum(duration=4.0),
            (50, 100, 200, 400, 1000, 2000, 4000),
            100,
            3,
            (
                Slider("angle", "start angle [rad]", (0.5, 1.0, 2.0, 3.0)),
                Slider("length", "length [m]", (0.5, 1.0, 2.0)),
            ),
            ends={"link 1": TIP},
        ),
        Live(
            "two links",
            LinkPendulum(),
            (25, 125, 250, 500, 1250, 2500, 5000),
            125,
            3,
            (
                Slider("tip", "mass of the last link to the other's", (0.1, 1.0, 10.0, 100.0)),
                Slider("angle", "start angle [rad]", (0.5, 1.0, LinkPendulum().angle)),
            ),
            ends={"link 2": TIP},
            traces=(("link 2", (0.5, 0.0)),),
        ),
        Live("ten links", TenLinks(), (75, 150, 300, 600, 1500, 3000), 75, 3, ends={"link 10": TIP}),
    ),
    (
        Experiment(
            "one link",
            after={"integrator": 1},
            claims=(Claim("mujoco", most=1e-3), Claim("mujoco", most=1e-12, of="gap", is_value=True)),
            overlays=FORCES,
            guesses=(
                Guess({}, claims=(Claim("mujoco", most=1e-12, of="gap", is_value=True),)),
                Guess(),
                Guess({"steps": 4000}, claims=(Claim("mujoco", 0.05, 0.2),)),
            ),
            quantities=(JOINTS_OPEN,),
        ),
        Experiment(
            "one link",
            after={"bias": 0.0},
            claims=(Claim("munk", most=0.1), Claim("munk", 0.05, 0.15, "energy")),
            causes=(({"bias": None, "iterations": 100}, Claim("munk", -math.inf, -1.0, "energy", is_value=True)),),
            section="In motion",
            guesses=(
                Guess({"iterations": 100}, claims=(Claim("munk", 0.9, 1.1),)),
                Guess(),
                Guess(times={"munk": 1.0}),
            ),
            quantities=(ENERGY,),
        ),
        Experiment(
            "two links",
            BOTH,
            {"steps": 5000},
            (Claim("mujoco", 5e-5, 2e-4), Claim("munk", 0.05, 0.2)),
            (({"integrator": 0}, Claim("mujoco", least=1000)),),
            section="Which step for which mechanism",
            guesses=(
                Guess(times={"munk": 0.1, "mujoco": 0.1}),
                Guess(times={"munk": 1e-4, "mujoco": 1e-4}),
                Guess(times={"munk": 0.1, "mujoco": 1e-4}),
            ),
        ),
        Experiment(
            "ten links",
            {"integrator": 1},
            {"bias": 0.0, "iterations": 1},
            (
                Claim("munk", least=10),
                Claim("mujoco", 1.0, 1.0),
                Claim("mujoco", most=1e-3, is_value=True),
                Claim("mujoco", most=1e-12, of="gap", is_value=True),
            ),
            (({"iterations": 100}, Claim("munk", most=0.1)), ({"integrator": 0}, Claim("mujoco", least=1000))),
            guesses=(Guess(times={"munk": 3.0}), Guess(times={"munk": 300.0}), Guess(times={"munk": 1.0})),
            quantities=(JOINTS_OPEN,),
        ),
        Experiment(
            "two links",
            {"tip": 100.0},
            {"iterations": 2},
            (Claim("munk", least=10), Claim("munk", least=10, of="gap"), Claim("mujoco", 1.0, 1.0)),
            (
                ({"iterations": 20}, Claim("munk", most=0.1)),
                ({"tip": 1.0}, Claim("munk", most=0.1, of="gap")),
                ({"steps": 5000}, Claim("munk", most=0.1)),
            ),
            FORCES,
            section="Where methods fail",
            guesses=(
                Guess(times={"munk": 1.0}),
                Guess(),
                Guess({"iterations": 2, "bias": 0.0}, claims=(Claim("munk", least=10),)),
            ),
            quantities=(JOINTS_OPEN,),
        ),
    ),
)


@cache
def rolling_centrodes() -> Live:
    """The four-bar with both centrodes of its coupler, for the arc on which the coupler turns in one direction."""
    truth, curves = exact()
    scene, frames = DrivenFourBar(), 240
    first, last = (round(t / scene.duration * frames) for t in (truth.t[0], truth.t[-1]))
    fixed, moving = curves.space_curve, curves.body_curve

    def drawn(curve, arc) -> tuple[Point, ...]:
        low, high = float(min(arc)), float(max(arc))
        return tuple(map(tuple, curve.point([low + (high - low) * index / 120 for index in range(121)]).tolist()))

    return Live(
        "rolling",
        scene,
        (60, 120, 240, 480, 1200),
        frames,
        2,
        traces=(("coupler", (0.0, 0.0)),),
        centre="coupler",
        curves=((None, drawn(fixed, curves.space_arc)), ("coupler", drawn(moving, curves.body_arc))),
        window=(first + 1, last - 1),
    )


CENTRODES = Lesson(
    "centrodes",
    "Centrodes: any motion as rolling",
    "centrodes",
    (rolling_centrodes(), replace(DRIVEN, word="whole", sliders=())),
    (
        Experiment("whole", overlays=CENTRE),
        Experiment("rolling", overlays=CENTRE, section="The coupler of the four-bar"),
        Experiment(
            "rolling",
            after=BOTH,
            claims=(
                Claim("munk", most=0.1),
                Claim("mujoco", most=0.1),
                Claim("munk", 0.8, 1.25, "centre"),
                Claim("mujoco", most=0.01, of="centre"),
            ),
            causes=(({"steps": 1200}, Claim("munk", 0.15, 0.25, "centre")),),
            overlays=CENTRE,
            section="The centre as a measure of an engine",
            guesses=(
                Guess(times={"munk": 1.0, "mujoco": 1.0}, of="centre"),
                Guess(times={"munk": 0.01, "mujoco": 0.01}, of="centre"),
                Guess(),
            ),
            quantities=(LessonQuantity("centre", "median distance of the centres", ("coupler",)),),
        ),
    ),
)
