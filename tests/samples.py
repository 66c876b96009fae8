"""One valid instance of every class that checks its fields."""

from __future__ import annotations

from typing import Any

import numpy as np

from engines import Size, registry
from engines.extrapolated import Extrapolated
from engines.lagrange import Judge, Lagrange
from engines.mujoco.joints.roll import RollContact
from engines.mujoco.methods import limited_tendon
from engines.mujoco.stiffness import Hardened, Shipped, TiedToStep
from engines.pymunk.engine import Pymunk, limited_groove
from engines.pymunk.joints.roll import SHIPPED_CONTACT
from engines.single_run import Recorded, SingleRun
from reference.chapter import centrodes, shapes
from reference.chapter.parking import Move
from reference.couplings import Coupling, Term
from reference.forces import CoupledForce, Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Body
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.open_curves import Catenary, LogSpiral, Parabola
from reference.rolling.roll import Roll
from reference.rolling.traced import Traced
from reference.scenes.andrews import Dyad
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.free_motion import CurveMotion
from reference.scenes.four_bar.linkage import FourBar
from reference.scenes.four_bar.scenes import OverdrivenFourBar, Parallelogram
from reference.scenes.many_links import LongPendulum, OpenChain, SpinningRing
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.link import Pendulum
from reference.scenes.person import THIGH
from reference.scenes.rolling.scenes import DiscInHole, RollingDisc, SquareOnCatenaries
from reference.scenes.skates.slopes import HeldBySkates, SkateOnSlope
from reference.scenes.slider_crank.linkage import SliderCrank
from reference.scenes.slider_crank.scenes import RodEndInSlot, SliderAtDeadCentre
from reference.scenes.slider_crank.slotted_lever import SlottedLever
from reference.scenes.wheels.cart import Casters
from reference.scenes.wheels.tractrix import Tow
from reference.scenes.wheels.trailers import CarWithTrailers
from reports.model.cells import Cell
from tests.mechanisms import four_bar

SCENES_OF_LIMITS = (
    *(Parallelogram(), OverdrivenFourBar(), SkateOnSlope(), HeldBySkates(), DiscInHole(), SquareOnCatenaries()),
    *(SpinningRing(links=5), RodEndInSlot(), SliderAtDeadCentre(), LongPendulum(), SlottedLever()),
)
_times = np.linspace(0.0, 1.0, 33)
_table = np.stack([np.cos(_times), np.sin(2 * _times), 0.1 + 2 * _times], axis=-1)
_centrodes = centrodes.from_poses(_times, _table)
_chain = LongPendulum().mechanism()
_crank = SliderCrank(0.3, 1.0)
_curve = CurveMotion(FourBar(1.0, 2.0, 2.0, (2.0, 0.0)), (1.0, 1.0, 1.0), (0.0, -9.81))


def _nothing_recorded(samples: int, every: int) -> Recorded:
    raise AssertionError("a run with arguments that can't be was begun")


# A run of engines that need not be installed.
RUN = SingleRun(four_bar(), 1e-3, Size(3, 9, 8, 8), _nothing_recorded)
# One valid instance of each class that checks its fields.
_terms = (Term(None, "b", 2.0), Term(None, "b", 0.5, True, (0.1, 0.2), 0.3, (0.4, 0.5)))
INSTANCES: tuple[Any, ...] = (
    *(*_terms, Coupling("c", _terms, 0.1), CoupledForce("f", _terms, 1.0, 2.0, 3.0, 0.4)),
    *(*SCENES, *SCENES_OF_LIMITS, *registry.ENGINES, *registry.OTHERS),
    *(Body("b", 1.0, 2.0, (0.0, 0.0, 0.0)), four_bar(), OpenChain(_chain.bodies, _chain.joints, _chain.gravity)),
    *(Pin("p", None, "b", (0.0, 0.5), (1.0, 0.0)), Drive("d", None, "b", 1.0, 0.5)),
    *(Slot("s", None, "b", (0.0, 0.5), 0.5, (1.0, 0.0)), Skate("k", None, "b", (0.5, 0.0), 0.5)),
    Dyad(2.0, 1.0, 1),
    *(Rod("r", None, "b", (0.0, 0.5), (1.0, 0.0), 2.0), Gear("g", "a", "b", 2.0, 0.5)),
    *(Weld("w", "a", "b", (0.0, 0.5), (1.0, 0.0), 0.5), Spring("s", "a", "b", (0.0, 0.5), (1.0, 0.0), 2.0, 1.0)),
    *(Damper("d", "a", "b", (0.0, 0.5), (1.0, 0.0), 2.0), TorsionSpring("s", "a", "b", 2.0, 0.5)),
    *(TorsionDamper("d", "a", "b", 2.0), Torque("t", None, "b", 1.0), Force("f", "b", (0.0, 0.5), (1.0, 2.0))),
    *(Roll("r", None, "b", RollingDisc().motion_law.rolling), RollingDisc().motion_law.rolling),
    *(RollingDisc().motion_law, RollingDisc().motion([0.0, 0.1])),
    *(Cam(1.0, (0.1, 0.05), (0.05, 0.02)), Catenary(1.0), Circle(1.0), Ellipse(2.0, 1.0), Line(), LogSpiral(1.0, 0.5)),
    *(Parabola(1.0), Placed(Circle(1.0), (0.5, 0.0), 0.5), Ring(2.0), Side(1.0)),
    *(Traced(_times, np.stack([_times, _times**2], axis=-1)), _centrodes, shapes.shapes_of(_centrodes, 5)),
    *(
        _curve.four_bar,
        _curve,
        Chain((1.0, 0.5), (1.0, 2.0)),
        Pendulum(2.0, 0.5, 0.5),
        THIGH,
        Move(0.5, 0.5),
    ),
    *(_crank, Casters(((0.5, 0.5),), 0.5), Tow(1.0, 0.5, 2.0)),
    *(CarWithTrailers(1.0, (1.0,), (0.5,)), Extrapolated(Lagrange(), "mine", (1, 2), (1,))),
    *(Pymunk("mine"), SHIPPED_CONTACT, RollContact()),
    *(limited_groove(5.0), limited_tendon(5.0)),
    *(Shipped(), TiedToStep(), Hardened(), Lagrange("dop853", "projection", 1e-9), Judge()),
    Cell(SCENES[0], registry.ENGINES[0], 1, samples=3),
)
