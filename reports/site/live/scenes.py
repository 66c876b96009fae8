"""The scenes of the lessons, with their sliders and methods. A lesson names a scene by its key."""

from __future__ import annotations

from dataclasses import replace

from engines import Engine, pymunk
from engines.pymunk.joints.roll import ContactSettings
from engines.pymunk.methods import ROLL_POLYGON, SKATE_CENTRE, SKATE_PROJECTED
from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.scenes.person import SEGMENT_NAMES, OneFoot, TwoFeet
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingCam, RollingDisc, RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank, FreeSliderCrank
from reference.scenes.wheels.vehicles import CarAndTrailer
from reports.pages.centrodes.page import exact
from reports.site.animated import Take
from reports.site.live.sliders import DOCUMENTED, SHIPPED, Live, Point, Slider

# The four-bar
DENSITIES = (1.0, (1.0, 10.0, 1.0), (1.0, 100.0, 1.0))  # of crank, coupler and rocker
DENSITY = Slider("density", "the coupler's density to that of the others", DENSITIES, ("1", "10", "100"))
COUPLER = FreeFourBar().coupler
DRIVEN = Live(
    "driven",
    DrivenFourBar(),
    (15, 30, 60, 120, 300, 600, 1200),
    60,
    3,
    (
        Slider("crank", "crank [m]", (0.2, 0.4, 0.45)),
        Slider("coupler", "coupler [m]", (0.53, COUPLER, 0.65, 0.9), ("0.53", f"{COUPLER:.3f}", "0.65", "0.9")),
        DENSITY,
    ),
    traces=(("coupler", (0.0, 0.0)),),
    centre="coupler",
)
FREE = replace(
    DRIVEN,
    word="let go",
    scene=FreeFourBar(),
    steps=(25, 50, 100, 200, 500, 1000, 2000),
    frames=50,
    sliders=(
        Slider("crank", "crank [m]", (0.3, 0.4, 0.45)),
        replace(DENSITY, values=((1.0, 0.01, 1.0), 1.0, (1.0, 100.0, 1.0)), texts=("0.01", "1", "100")),
    ),
    centre=None,
)
FOUR_BARS = (
    DRIVEN,
    FREE,
    replace(DRIVEN, word="two assemblies", sliders=(Slider("branch", "place of C", (1, -1), ("above", "below")),)),
    replace(DRIVEN, word="whole", sliders=()),
)


def rolling_centrodes() -> Live:
    """Return the four-bar with both centrodes of its coupler, for the arc on which it turns in one direction."""
    truth, curves = exact()
    frames = 240
    first, last = (round(t / DRIVEN.scene.duration * frames) for t in (truth.t[0], truth.t[-1]))

    def drawn(curve, arc) -> tuple[Point, ...]:
        low, high = float(min(arc)), float(max(arc))
        return tuple(map(tuple, curve.point([low + (high - low) * index / 120 for index in range(121)]).tolist()))

    fixed, moving = drawn(curves.space_curve, curves.space_arc), drawn(curves.body_curve, curves.body_arc)
    return replace(
        DRIVEN,
        word="rolling",
        steps=(60, 120, 240, 480, 1200),
        frames=frames,
        start=2,
        sliders=(),
        curves=((None, fixed), ("coupler", moving)),
        window=(first + 1, last - 1),
    )


# The slider-crank
CRANK = Slider("crank", "crank [m]", (0.15, 0.3, 0.45, 0.6))
MASS = Slider("slider_mass", "mass of the slider [kg]", (0.05, 0.5, 5.0, 50.0))
SLIDER_CRANK = Live(
    "driven",
    DrivenSliderCrank(),
    DRIVEN.steps,
    60,
    3,
    (CRANK, MASS),
    traces=(("rod", (0.0, 0.0)),),
    centre="rod",
)
SLIDER_CRANKS = (
    SLIDER_CRANK,
    replace(
        SLIDER_CRANK,
        word="let go",
        scene=FreeSliderCrank(),
        steps=(50, 100, 200, 400, 1000, 2000, 4000),
        frames=50,
        sliders=(CRANK, replace(MASS, values=MASS.values[:3])),
    ),
)

# Pendulums and the person
TIP = ((0.5, 0.0), (-0.5, 0.0))
PENDULUMS = (
    Live(
        "one link",
        BarPendulum(duration=4.0),
        (50, 100, 200, 400, 1000, 2000, 4000),
        100,
        3,
        (Slider("angle", "start angle [rad]", (0.5, 1.0, 2.0, 3.0)), Slider("length", "length [m]", (0.5, 1.0, 2.0))),
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
)
PERSON = OneFoot()
FAR: tuple[Point, ...] = tuple(
    (float(length - behind), 0.0) for length, behind in zip(PERSON.lengths, PERSON._behind, strict=True)
)
ENDS: dict[str, tuple[Point, ...]] = {SEGMENT_NAMES[index]: (FAR[index],) for index in (2, 4)}
TRACES = ((SEGMENT_NAMES[2], FAR[2]),)
PERSONS = (
    Live("on one foot", PERSON, (50, 100, 200, 500, 1000), 50, 0, ends=ENDS, traces=TRACES),
    Live(
        "on two feet",
        TwoFeet(),
        (60, 120, 300, 600, 1200),
        60,
        0,
        ends={SEGMENT_NAMES[2]: (FAR[2],)},
        traces=TRACES,
    ),
)

# Rolling
START_RATE = Slider("start_rate", "turning rate at the start [rad/s]", (2.0, 3.0, 4.0, 5.0))
CORNERS = (
    (SHIPPED, pymunk.DEFAULT),
    (DOCUMENTED, pymunk.TUNED),
    ("a polygon of 8 corners", replace(pymunk.DEFAULT, contact=ContactSettings(vertices=8))),
    ("a polygon of 512 corners", ROLL_POLYGON),
)
CAM = Live(
    "a cam",
    RollingCam(),
    (20, 50, 100, 200, 500, 1000, 2000),
    100,
    3,
    (START_RATE,),
    munk=CORNERS,
    traces=(("roller", (0.0, 0.0)),),
    centre="roller",
)
AXIS = Slider("along_y", "short half axis [m]", (0.2, 0.3, 0.4, 0.5))
BESIDE = Slider("eccentricity", "centre of mass beside the middle [m]", (0.05, 0.15, 0.25))
ROLLERS = (
    CAM,
    replace(CAM, word="an ellipse", scene=RollingEllipse(), sliders=(AXIS, START_RATE)),
    replace(CAM, word="a disc", scene=RollingDisc(), sliders=(BESIDE, START_RATE), munk=CORNERS[:2]),
    Live(
        "two gears",
        EllipticGears(),
        (50, 100, 200, 400, 1000, 2000),
        100,
        5,
        (Slider("eccentricity", "eccentricity [1]", (0.0, 0.2, 0.5, 0.7)),),
        munk=CORNERS,
        centre="second",
    ),
)

# Skates and wheels
BLADES = (
    (SHIPPED, "pymunk as shipped has no joint for a skate"),
    (DOCUMENTED, pymunk.TUNED),
    ("naive: the centre's sideways velocity set to zero", SKATE_CENTRE),
    ("our code: an impulse at the blade", SKATE_PROJECTED),
)
SLEIGH, CAR = ChaplyginSleigh(), CarAndTrailer()
BEND = Slider("bend", "bend of the trailer at the start [rad]", (0.3, 0.8, 1.2))
FORWARDS = Live(
    "forwards",
    CAR,
    (25, 125, 250, 500, 1250, 2500, 5000),
    125,
    3,
    (Slider("steering", "steering [rad]", (0.0, 0.2, 0.4, 0.6)), BEND),
    munk=BLADES,
    centre=CAR.mechanism().bodies[0].name,
    axle=CAR.track / 2,
)
VEHICLES = (
    Live(
        "the sleigh",
        SLEIGH,
        (25, 75, 150, 300, 750, 1500, 3000),
        75,
        3,
        (
            Slider("offset", "centre of mass ahead of the blade [m]", (-0.3, 0.1, 0.3, 0.5, 0.8)),
            Slider("turning_rate", "turning rate at the start [rad/s]", (0.5, 1.0, 2.0, 4.0)),
        ),
        munk=BLADES,
        centre=SLEIGH.mechanism().bodies[0].name,
    ),
    FORWARDS,
    replace(
        FORWARDS,
        word="backwards",
        scene=CarAndTrailer(steering=0.0, hitch=0.0, speed=-1.0, bend=0.05),
        sliders=(replace(BEND, values=(0.0125, 0.025, 0.05, 0.1, 0.2)),),
        centre=None,
    ),
)

SCENES = {
    live.key: live
    for live in (*PENDULUMS, *PERSONS, *SLIDER_CRANKS, *FOUR_BARS, rolling_centrodes(), *ROLLERS, *VEHICLES)
}


def take_like(scene: Scene, methods: tuple[tuple[str, Engine, int], ...]) -> Take:
    """Return a take of a scene with these methods. The take has the look of the scene in a lesson."""
    plain = next((live for live in SCENES.values() if live.scene.name == scene.name), None)
    if plain is None:
        return Take(scene, methods)
    bodies = {body.name for body in scene.mechanism().bodies}
    ends = {body: points for body, points in plain.ends.items() if body in bodies}
    return Take(scene, methods, ends=ends, axle=plain.axle)
