"""Rolling by MuJoCo's own contact: as a user would build it, and with the velocity term that its contacts lack.

A contact's rows obey J a = -b J v - k gap, without the -(dJ/dt) v of a curved or moving contact: rolling then lags by
about a time constant times the missing acceleration, and converges with the first power of the step at best. (So in
4.0.1: tests in `tests/test_mujoco_rolls.py` find order 4 with the term added, and an error a million times as large
without it.)
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from cmath import rect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import mujoco

from engines import Unsupported
from engines.mujoco.construction import Building, Callback, Hooks
from engines.mujoco.joints.roll.shapes import RoundShape, add_shapes
from engines.mujoco.stiffness import STIFFEST, Shipped
from engines.rolling_table import rolled
from reference.checks import InvalidMechanism, Positive, Valid
from reference.rolling.roll import Roll

Cone = Literal["pyramidal", "elliptic"]
# A pair that just touches must collide whatever its distance is rounded to: this part of the mechanism's length.
TOUCH = 1e-12
# The contact of convex on convex is searched to MuJoCo's tolerance. The shipped 1e-6 leaves an ellipse on a hill 7e-7
# rad in half a second however small the step, and anything finer ends at 2e-9 by itself.
CONVEX = 1e-14


@dataclass(frozen=True)
class RollContact(Valid):
    """Collision and friction: public settings only, the shipped ones unless said otherwise.

    `friction`: the coefficient. `steps`: the contact's time constant in steps (clamped as `engines.mujoco.stiffness`
    says) with its impedance at the limit; None for the shipped 0.02 s. `stick`: slip dies as fast as the integrator
    allows, at the rate 1/dt, and 2/dt for Runge-Kutta's; MuJoCo reads `solreffriction` with the elliptic cone only (a
    test in `tests/test_mujoco_rolls.py` asks it). `round_shape`: what a circle is.
    """

    friction: Positive = 1.0
    steps: Positive | None = None
    stick: bool = False
    cone: Cone = "pyramidal"
    round_shape: RoundShape = "sphere"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.stick and self.cone != "elliptic":
            raise InvalidMechanism(
                f"rolling by contact: stick is {self.stick!r}, but MuJoCo has that in the elliptic cone only"
            )

    def add(self, building: Building, rolls: Sequence[Roll]) -> None:
        """Add shapes and the pair that collides. Raises Unsupported for curves that MuJoCo has no shape for."""
        shipped = Shipped()
        reference = shipped.reference(building.mechanism, building.dt)
        impedance = shipped.impedance
        if self.steps is not None:
            reference, impedance = (self.steps * building.dt, 1.0), STIFFEST
        runge_kutta = building.spec.option.integrator == mujoco.mjtIntegrator.mjINT_RK4
        slip = (-1e-9, -(2.0 if runge_kutta else 1.0) / building.dt) if self.stick else None
        for roll in rolls:
            margin = TOUCH * building.mechanism.length_scale
            _add_pair(building, roll, self.round_shape, self.friction, reference, impedance, slip, margin)
        building.spec.option.cone = getattr(mujoco.mjtCone, f"mjCONE_{self.cone.upper()}")


@dataclass(frozen=True)
class CompletedContact(Valid):
    """Real contact, of which a callback completes the rows in every stage: the missing velocity term is added.

    `margin`: within this part of the mechanism's length the rows are alive, so that rounding can't switch the contact
    off; the push that MuJoCo gives for it is taken back. The contact can still slip at `friction`, and open: then it is
    lost when the normal force should pull.
    """

    friction: Positive = 10.0
    margin: Positive = 0.01

    def add(self, building: Building, rolls: Sequence[Roll]) -> None:
        """Add shapes, pairs and the callback. Raises Unsupported for curves without a shape, and for hinged bodies."""
        mechanism = building.mechanism
        spring, damper = building.stiffness.gains(mechanism, building.dt)
        links = {link.body: link for link in building.tree.links}
        margin = self.margin * mechanism.length_scale
        pairs = []
        for roll in rolls:
            for name in (roll.first, roll.second):
                if name is not None and links[mechanism.body_index(name)].kind != "free":
                    raise Unsupported(
                        f"roll {roll.name!r}: {name!r} hangs on another body in MuJoCo's tree, and the missing term of "
                        "a contact is only added between free bodies and the ground; build it with free coordinates"
                    )
            reference, slip = (-spring, -damper), (-1e-9, -damper)
            geoms = _add_pair(building, roll, "sphere", self.friction, reference, STIFFEST, slip, margin)
            pairs.append((roll, geoms))
        building.spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        building.spec.option.ccd_tolerance = CONVEX
        # MuJoCo divides the stiffness of a direct solref by d^2 and multiplies it by d, its impedance.
        push = spring / STIFFEST[0] * margin

        def bind(compiled: Any, address: Sequence[int]) -> Hooks:
            laws = {}
            for roll, names in pairs:
                first, second = (compiled.geom(name).id for name in names)
                law = _missing(building, roll, address)
                laws[first, second], laws[second, first] = (law, 1.0), (law, -1.0)
            return Hooks(control=(_completing(laws, push),))

        building.binders.append(bind)


def _add_pair(
    building: Building,
    roll: Roll,
    round_shape: RoundShape,
    friction: float,
    reference: tuple[float, float],
    impedance: Sequence[float],
    slip: tuple[float, float] | None,
    margin: float,
) -> tuple[str, str]:
    geoms = add_shapes(building, roll, round_shape)
    pair = building.spec.add_pair(
        geomname1=geoms[0],
        geomname2=geoms[1],
        condim=3,
        friction=[friction, friction, 0.005, 0.0001, 0.0001],  # the last three are no friction of three rows
        solref=list(reference),
        solimp=list(impedance),
        margin=margin,
    )
    if slip is not None:
        pair.solreffriction = list(slip)
    building.contact = True
    building.size += roll.size
    return geoms


def _missing(building: Building, roll: Roll, address: Sequence[int]) -> Callable[[Any, Any], complex]:
    """-(dJ/dt) v of rolling as a function of (qpos, qvel): what J a should be in the world, x + i y [m/s^2]."""
    table = rolled(roll.rolling)
    links = {link.body: link for link in building.tree.links}
    angles = []
    for name in (roll.first, roll.second):
        index = building.index(name)
        link = None if index is None else links[index]
        if index is not None and link is not None and link.rotation is not None:
            angles.append((address[link.rotation], building.mechanism.bodies[index].pose[2]))
    second, start = angles[-1]
    if len(angles) == 1:

        def over_ground(position: Any, velocity: Any) -> complex:
            return table.place(start + position[second])[2] * velocity[second] ** 2

        return over_ground
    first, base = angles[0]

    def over_body(position: Any, velocity: Any) -> complex:
        turned, omega = base + position[first], velocity[first]
        rate = velocity[second] - omega
        place, once, twice = table.place(start + position[second] - turned)
        way = rect(1.0, turned)
        return way * (twice * rate**2 + 2j * omega * rate * once - omega**2 * place)

    return over_body


def _completing(laws: dict[tuple[int, int], tuple[Callable[[Any, Any], complex], float]], push: float) -> Callback:
    def complete(_model: Any, data: Any) -> None:
        if not data.ncon:
            return
        position, velocity = data.qpos.tolist(), data.qvel.tolist()
        wanted = data.efc_aref
        contacts = data.contact
        for index in range(data.ncon):  # iterating over the list itself is ten times as slow
            contact = contacts[index]
            law, sign = laws[contact.geom1, contact.geom2]
            row, frame = contact.efc_address, contact.frame.tolist()
            value = sign * law(position, velocity)
            x, y = value.real, value.imag
            wanted[row] += x * frame[0] + y * frame[1] - push
            wanted[row + 1] += x * frame[3] + y * frame[4]
            wanted[row + 2] += x * frame[6] + y * frame[7]

    return complete
