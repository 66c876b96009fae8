"""Invalid values are refused by a sentence that states the value and the reason."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from reference.chapter.centrodes import centrodes, from_poses, poses_from_csv, shapes_of
from reference.chapter.integrability import is_integrable
from reference.chapter.skates import coriolis_factors, sidestep
from reference.forces import Damper, Spring, Torque
from reference.joints import Gear, Joint, Pin, Rod, Skate
from reference.mechanism import Body, Mechanism
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.contact import NEAR_CONFORMAL
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Parabola, Traced
from reference.rolling.roll import Roll
from reference.scenes.andrews import Andrews
from reference.scenes.catalogue import scene
from reference.scenes.four_bar.linkage import FourBar
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar, Parallelogram
from reference.scenes.pendulum.chain import Chain
from reference.scenes.person import TwoFeet
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingCam, RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank
from reference.scenes.wheels.trailers import CarWithTrailers
from reference.scenes.wheels.vehicles import CarAndTrailer
from tests.mechanisms import ALL, WELD, bar, four_bar
from tests.reference.test_chapter import cardan, coupler
from tests.reference.test_scenes import TRIPLE_ROCKER

T = np.arange(40) / 40
HIGH = max(high for _, high in TRIPLE_ROCKER.four_bar.crank_limits() or ())
DISC, TRAIN = Circle(0.5), CarWithTrailers(1.0, (1.0,), (0.0,))


def hung(joint: Joint) -> Mechanism:
    return Mechanism((bar("b", (0, 0), (1, 0)),), (joint,))


def pulled(*forces: Any) -> Mechanism:
    return Mechanism((Body("b", 1.0, 1.0, (0.0, 0.0, 0.0)),), (), (0.0, 0.0), forces)


REFUSED: dict[str, tuple[Any, str]] = {
    "no bodies": (lambda: Mechanism((), ()), "no bodies"),
    "a name twice": (lambda: Mechanism((bar("b", (0, 0), (1, 0)),) * 2, ()), "two bodies are called 'b'"),
    "an unknown name": (lambda: hung(Pin("A", None, "c", (0, 0), (0, 0))), "no body is called 'c'; there are 'b'"),
    "a joint of one body": (lambda: hung(Pin("A", "b", "b", (0, 0), (0, 0))), "with itself"),
    "an open pin": (lambda: hung(Pin("A", None, "b", (0.1, 0), (-0.5, 0))), "'A x' is open by 0.1"),
    "a pose without the direction of a rod": (
        lambda: hung(Rod("R", None, "b", (0, 0), (0.5, 0), 1.0)).degrees_of_freedom(np.array([[-0.5, 0.0, 0.0]])),
        "the row 'R.*' is not finite at this pose",
    ),
    "a rate that no drive has": (lambda: four_bar(crank_rate=10.0, drive=9.0), "'drive torque' is moving apart at 1"),
    "a skate that slides": (
        lambda: Mechanism(
            (Body("b", 1.0, 1.0, (0.0, 0.0, 0.0), (1.0, 0.1, 0.0)),), (Skate("skate", None, "b", (0.0, 0.0)),)
        ),
        "moving apart",
    ),
    "a roll that starts open": (
        lambda: Mechanism(
            (Body("wheel", 1.0, 1.0, (0.0, 0.501, 0.0)),),
            (Roll("roll", None, "wheel", Rolling.at_angle(DISC, Line())),),
        ),
        "roll normal.*open",
    ),
    "an open weld": (
        lambda: replace(ALL, joints=(*ALL.joints[:3], replace(WELD, angle=WELD.angle + 0.1))),
        r"row 'weld torque' is open by 0\.1 rad",
    ),
    "a gear without a ratio": (lambda: Gear("g", "a", "b", 0.0), r"ratio is 0\.0; it must be a finite number other"),
    "a torque on nobody": (lambda: pulled(Torque("t", None, "nobody", 1.0)), "force 't': no body is called 'nobody'"),
    "a torque of one body": (lambda: pulled(Torque("t", "b", "b", 1.0)), "force 't': it joins 'b' with itself"),
    "a force's name twice": (lambda: pulled(*(Torque("t", None, "b", 1.0),) * 2), "two forces are called 't'"),
    "a spring without direction": (lambda: pulled(Spring("s", None, "b", (0, 0), (0, 0), 1.0, 0.5)), "points coincide"),
    "a damper without direction": (lambda: pulled(Damper("s", None, "b", (0, 0), (0, 0), 1.0)), "points coincide"),
    "D on A": (lambda: FourBar(1.0, 1.0, 1.0, (0.0, 0.0)), "other than"),
    "bars too short": (lambda: FourBar(1.0, 1.0, 1.0, (3.1, 0.0)), "can't be assembled"),
    "a bar too long": (lambda: FourBar(5.0, 1.0, 1.0, (1.0, 0.0)), "can't be assembled"),
    "B on D": (lambda: FourBar(1.0, 0.5, 0.5, (1.0, 0.0)).angles([1.0, 0.0]), "B lies on D"),
    "a crank angle beyond": (lambda: TRIPLE_ROCKER.four_bar.angles(np.array([0.2, 3.0])), "crank angle 3 rad"),
    "a start beyond": (lambda: replace(TRIPLE_ROCKER, start=HIGH + 0.1), "possible is"),
    "a rate at the limit": (lambda: replace(TRIPLE_ROCKER, start=HIGH, rate=1.0), "at its limit"),
    "a start in line": (lambda: FreeFourBar(crank=0.4, coupler=1.2, rocker=0.4, start=0.0), "change point"),
    "a drive at rest": (lambda: DrivenFourBar(rate=0.0), "rate is 0"),
    "no parallelogram": (lambda: Parallelogram(rocker=0.5), "must be equal"),
    "a motion through a change point": (
        lambda: FreeFourBar(0.5, 1.2, 0.5, (1.2, 0.0), 1, 1.0, 8.0).motion(1.0),
        "change point, beyond which two motions are possible",
    ),
    "an unknown method": (
        lambda: FourBar(1.0, 2.0, 2.5, (3.0, 0.0)).integrate_rates([0.0, 1.0], method="ode45"),
        "method is 'ode45'",
    ),
    "times that fall": (lambda: FourBar(1.0, 2.0, 2.5, (3.0, 0.0)).integrate_rates([1.0, 0.0]), "increasing"),
    "an offset beyond": (lambda: DrivenSliderCrank(offset=-0.75), "offset is"),
    "bars of Andrews'": (lambda: Andrews(rod=(0.1, 0.0115)), "the bars don't reach from the pivots"),
    "a chain without links": (lambda: Chain((), ()), "0 links"),
    "unequal numbers of links": (lambda: Chain((1.0,), (1.0, 1.0)), "1 lengths and 2 masses"),
    "a state of another chain": (lambda: Chain((1.0,), (1.0,)).forces([0.4, 0.1], [0.0, 0.0]), "number for each link"),
    "feet too far apart": (lambda: TwoFeet(stance=1.8), r"stance is 1\.8 m"),
    "a right leg too short": (lambda: TwoFeet(stance=1.2, hip_x=0.3), "from the right ankle"),
    "a left leg too short": (lambda: TwoFeet(hip_y=1.0), "from the left ankle"),
    "a sleigh that nothing turns": (lambda: ChaplyginSleigh(inertia=0.0, offset=0.0), "nothing resists turning"),
    "a sleigh without inertia": (lambda: ChaplyginSleigh(inertia=0.0).mechanism(), "inertia"),
    "a car steered across": (lambda: CarAndTrailer(steering=math.pi / 2), "right angle"),
    "trailers without hitches": (lambda: CarWithTrailers(1.0, (1.0,), ()), "every trailer has one of each"),
    "too few joint angles": (lambda: TRAIN.drive(1.0, 0.0, (0, 0, 0), (), [1.0]), "joint angles"),
    "a steering that is no number": (lambda: TRAIN.drive(1.0, math.nan, (0, 0, 0), (0.0,), [1.0]), "steering"),
    "no room to a side": (lambda: sidestep(1.0, 0.0, 1.0), "room"),
    "no sliding": (lambda: coriolis_factors(0.0, 1.0, 0.0), "neither may be zero"),
    "a rank that changes": (
        lambda: is_integrable(lambda place: place[..., None, :] * np.array([1.0, 0.0, 0.0]), np.zeros(3)),
        "singular position",
    ),
    "a cam that isn't convex for a scene": (lambda: RollingCam(cosines=(0.0, 0.0, 0.1)).mechanism(), "not convex"),
    "gears that are parabolas": (lambda: EllipticGears(eccentricity=1.0), "eccentricity"),
    "a rest on a top": (lambda: RollingEllipse().motion_law.small_frequency(math.pi / 2), "equilibrium is unstable"),
    "an unknown scene": (lambda: scene("fre_fourbar"), "did you mean 'free_four_bar'"),
    "a cam that isn't convex": (lambda: Cam(0.4, (0.0, 0.0, 0.06)), "not convex"),
    "a corner of a square": (lambda: Side(1.0).point(0.6), "corners of infinite curvature"),
    "a needle of an ellipse": (lambda: Ellipse(1.0, 1e-4), "infinite curvature"),
    "the place of a straight line's direction": (lambda: Line().arc(1.0), "straight"),
    "a parabola standing upright": (lambda: Parabola(0.3).arc(1.6), "within"),
    "too few points": (lambda: Traced(np.arange(5.0), np.zeros((5, 2))), "at least 16"),
    "a point instead of a curve": (lambda: Traced(np.arange(20.0), np.ones((20, 2))), "stands still"),
    "a cusp": (lambda: Traced(np.linspace(-1, 1, 41), np.linspace(-1, 1, 41)[:, None] ** [2, 3]), "cusp"),
    "parameters that go back": (lambda: Traced(np.zeros(20), np.ones((20, 2))), "not greater"),
    "beyond the last point": (
        lambda: Traced(np.arange(20.0), np.arange(20.0)[:, None] * [1, 2]).point(99.0),
        "where its points end",
    ),
    "a ring smaller than its roller": (lambda: Rolling.at_arcs(Circle(0.5), Ring(0.3)), "sum must be positive"),
    "a ring of its roller's size": (lambda: Rolling.at_arcs(Circle(1.0), Ring(1 + NEAR_CONFORMAL / 4)), "so closely"),
    "flat on flat": (lambda: Rolling.at_arcs(Side(1.0), Line()), "sum must be positive"),
    "an ellipse too long for its ring": (lambda: Rolling.at_angle(Ellipse(0.5, 0.3), Ring(0.45), 0.0), "beyond it"),
    "an ellipse too long for a ring that was moved": (
        lambda: Rolling.at_angle(Ellipse(0.5, 0.3), Placed(Ring(0.45, (0.2, 0.1)), (1.0, -2.0), 0.7), 0.7),
        "beyond it",
    ),
    "a ring too narrow to roll about an ellipse": (lambda: Rolling.at_arcs(Ring(0.45), Ellipse(0.5, 0.3)), "beyond it"),
    "an ellipse that fits at the tip only": (
        lambda: Rolling.at_angle(Ellipse(0.5, 0.3), Ring(0.7)).contact(2.0),
        "can't turn to 2.0 rad",
    ),
    "curves that cross": (lambda: Rolling(Circle(0.5), Line(), 0.0, 0.0, 0.1), "cross at an angle"),
    "a start not finite": (lambda: Rolling.at_angle(Circle(0.5), Line(), math.nan), "finite"),
    "a rotation not finite": (lambda: Rolling.at_angle(Circle(0.5), Line()).pose(math.inf), "finite"),
    "poses that don't rotate": (lambda: from_poses(T, np.column_stack([T, T**2, 0 * T])), "doesn't rotate"),
    "a rate that changes its sign": (
        lambda: from_poses(*coupler(0.6, 5.0, 401)[:2]),
        "changes its sign between t = 0.2",
    ),
    "a rate that vanishes at a sample": (lambda: from_poses(T, np.column_stack([T, T, T**2])), "vanishes at t = 0 s"),
    "a pure rotation": (lambda: from_poses(T, np.column_stack([np.cos(T), np.sin(T), T])), "only rotates about it"),
    "too few poses": (lambda: from_poses(T[:9], np.column_stack([T, T, T])[:9]), "too few"),
    "times that go back": (lambda: from_poses(-T, np.column_stack([T, T, T])), "not after"),
    "twists of another length": (lambda: centrodes(T, np.column_stack([T, T, T]), np.ones((3, 3))), "one for each"),
    "pairs instead of poses": (lambda: from_poses(T, np.column_stack([T, T])), "of shape"),
    "a missing column": (lambda: poses_from_csv("t,x,y\n1,2,3\n"), "no column 'angle'"),
    "a word in a number's place": (lambda: poses_from_csv("t,x,y,angle\n0,1,2,3\n1,2,3,left\n"), "line 3"),
    "an empty table": (lambda: poses_from_csv(""), "no column"),
    "a curve of one point": (lambda: shapes_of(from_poses(*cardan()), points=1), "from 2 to"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_invalid_arguments_are_refused_with_a_reason(case: str) -> None:
    make, words = REFUSED[case]
    with pytest.raises(ValueError, match=words):
        make()
