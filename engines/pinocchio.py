"""Pinocchio under test: a tree in reduced coordinates whose loops are closed by exact contact constraints.

Pinocchio (the package is called `pin`) computes accelerations and steps no time (its `integrate` adds a displacement
to a configuration): the integrators here are ours, semi-implicit Euler and the classical Runge-Kutta method of fourth
order, as its own examples are written.

The tree is that of `engines.tree`: revolute joints about z, prismatic ones along a slot, for a body that hangs on
nothing two prismatic ones and a revolute one, and for a welded one none: its inertia is added to the other's. A Pin
that closes a loop is a RigidConstraintModel of the type CONTACT_3D, a Weld one of CONTACT_6D: `constraintDynamics`
holds their accelerations exactly, and gaps are the integrator's error. Their rows out of the plane are empty; the
proximal solver takes care of that. A Drive has no counterpart: our code works out the torque that keeps its rate in
every evaluation from the engine's answer to a unit torque at rest, without weight. Neither have springs, dampers and
the like: our code works out what they do to bodies, as users do, and passes it as external forces. Accelerations are
the engine's at the sampled instant, so reactions are too. A gear would be the engine's JointModelMimic, which `crba`
takes and `constraintDynamics` refuses.

`constraintDynamics` adds up forces, and torques about the world's origin, along the tree: a light body that a heavy one
moves against, or a mechanism far from the origin, loses digits. A body of 2e-7 kg in which 200 kg slide, 144 m away, is
off by 2e-6 of its motion at any step, and turns by 4e-11 rad instead of 2e-7 too far once it stands at the origin.

As shipped nothing pulls an open loop back. With a `correction` c [1/s] the engine's corrector gains are c^2 and 2 c.
They change the errors of both integrators by a factor, up or down with the motion and the step, so no variant sets
them; the page of engines shows them for the free four-bar. Which pin is taken as the loop changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability
from engines.contract import EXACT, ConvergenceOrder, Enforcement, NotDeclared, Size
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.sampling import sampled
from engines.single_run import ExtraEngine, Recorded
from engines.tree import Link, Tree, pushes, refuse_slots_in_loops, spanning_tree, world_offset
from reference.checks import Name, NonNegative, validated
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Array = NDArray[np.float64]
Integrator = Literal["euler", "rk4"]
# Of the proximal solver: its regularisation, when it may stop, and after how many iterations it has to. A loop of four
# bars takes two; the regularisation has to be far above rounding, since the row out of the plane is empty.
REGULARISATION, ACCURACY, ITERATIONS = 1e-10, 1e-14, 20
EVALUATION_COST = 6e-6  # s, with three bodies
FORCES_COST = 250e-6  # s, of force elements, which are worked out by numpy


@dataclass(frozen=True)
class Pinocchio(ExtraEngine):
    """An engine in the sense of `engines.Engine`.

    `integrator`: "euler" (semi-implicit, order 1) or "rk4" (order 4); `correction` of loops [1/s], see above.
    """

    name = "pinocchio"
    packages = ("pin",)
    modules: ClassVar[tuple[str, ...]] = ("pinocchio",)
    forces_by: ClassVar[Enforcement] = "ours"
    capability: ClassVar[Capability] = Capability(
        "pinocchio",
        frozenset({Pin, Slot, Drive, Weld}),
        lacks={
            Rod: "our adapter of pinocchio holds points and frames together, and no distance between points",
            Gear: "our adapter calls constraintDynamics, which refuses pinocchio's JointModelMimic",
            Skate: "our adapter of pinocchio holds whole points, and no velocity across a blade",
            Roll: "our adapter of pinocchio builds no contact",
        },
    )

    variant: Name
    integrator: Integrator = "euler"
    correction: NonNegative = 0.0

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The integrator's; what the tree holds is exact."""
        tree = spanning_tree(mechanism)
        order = 4 if self.integrator == "rk4" else 1
        if tree.loops:
            return ConvergenceOrder(order)
        if turns_steadily(mechanism) or is_prescribed(mechanism):
            return ConvergenceOrder(EXACT)
        return ConvergenceOrder(order, gap=EXACT, slip=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]: its evaluations, and one more for each drive."""
        drives = sum(isinstance(joint, Drive) for joint in mechanism.joints)
        stages = 4 if self.integrator == "rk4" else 1
        evaluation = EVALUATION_COST * (1 + drives) * over_three(mechanism)
        return stages * (evaluation + (FORCES_COST if mechanism.forces else 0.0))

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """Joints are the engine's; the torque of a drive is worked out by our code."""
        return "ours" if isinstance(joint, Drive) and joint not in spanning_tree(mechanism).kept else "engine"

    def model(self, mechanism: Mechanism, dt: float) -> PinocchioModel:
        tree = spanning_tree(mechanism)
        refuse_slots_in_loops(tree, "pinocchio")
        return PinocchioModel(tree, dt, self.integrator, self.correction)


class PinocchioModel:
    """The engine's objects for one mechanism."""

    def __init__(self, tree: Tree, dt: float, integrator: Integrator, correction: float) -> None:
        import pinocchio

        self.pin, self.mechanism, self.tree, self.dt, self.correction = pinocchio, tree.mechanism, tree, dt, correction
        self.step = runge_kutta_step if integrator == "rk4" else euler_step
        mechanism = self.mechanism
        self.model = pinocchio.Model()
        self.model.gravity.linear = np.array([*mechanism.gravity, 0.0])
        self.joints: dict[int | None, int] = {None: 0}  # the last joint of each body; the ground is the universe
        self.anchors: dict[int | None, Array] = {None: np.zeros(2)}  # of that joint, from the centre of mass
        self.address: list[int] = [0] * tree.coordinates  # where each tree coordinate stands in the engine's vectors
        self._add_children(None)
        self.data = self.model.createData()
        self.loops = pinocchio.StdVec_RigidConstraintModel()
        self.loop_data = pinocchio.StdVec_RigidConstraintData()
        for joint in tree.loops:
            self.loops.append(self._loop(joint))
            self.loop_data.append(self.loops[-1].createData())
        pinocchio.initConstraintDynamics(self.model, self.data, self.loops, self.loop_data)
        self.proximal = pinocchio.ProximalSettings(ACCURACY, REGULARISATION, ITERATIONS)
        drives = [joint for joint in mechanism.joints if isinstance(joint, Drive) and joint not in tree.kept]
        self.driven = np.zeros((len(drives), tree.coordinates))
        for row, drive in zip(self.driven, drives, strict=True):
            for column, sign in tree.turning(drive.first, drive.second).items():
                row[self.address[column]] = sign
        self._own = [self.joints[body] for body in range(len(mechanism.bodies))]
        rows = sum(joint.size for joint in tree.loops) + len(drives)
        spatial = sum(6 if isinstance(joint, Weld) else 3 for joint in tree.loops)
        self.size = Size(len(mechanism.bodies), tree.coordinates, rows, spatial)

    def _placed(self, offset: Any) -> Any:
        return self.pin.SE3(np.eye(3), np.array([offset[0], offset[1], 0.0]))

    def _add_children(self, parent: int | None) -> None:
        """Depth first: the engine's sparse factorisation of loops takes for granted that subtrees are numbered so."""
        for link in self.tree.links:
            if link.parent == parent:
                self._add(link)
                self._add_children(link.body)

    def _add(self, link: Link) -> None:
        pin, body = self.pin, self.mechanism.bodies[link.body]
        at = body.pose[:2] if link.kind == "free" else np.array(link.arm) - self.anchors[link.parent]
        kinds: list[Any] = []
        if link.kind == "free":
            kinds = [pin.JointModelPX(), pin.JointModelPY()]
        elif link.kind == "slot":
            kinds = [pin.JointModelPrismaticUnaligned(np.array([*link.direction, 0.0]))]
        kinds += [pin.JointModelRZ()] if link.turns else []
        joint, anchor = self.joints[link.parent], np.array(link.anchor)
        if not kinds:  # welded: it belongs to its parent's joint, which stands where it stood
            anchor, at = anchor - at, (0.0, 0.0)
        for number, (kind, column) in enumerate(zip(kinds, link.columns, strict=True)):
            self.address[column] = self.model.nv
            joint = self.model.addJoint(joint, kind, self._placed(at), f"body {link.body} joint {number}")
            at = (0.0, 0.0)
        # Out of the plane nothing turns, but an inertia has to be positive there too.
        inertia = pin.Inertia(body.mass, -np.array([*anchor, 0.0]), body.inertia * np.eye(3))
        self.model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
        self.joints[link.body], self.anchors[link.body] = joint, anchor

    def _loop(self, joint: Pin | Slot | Weld) -> Any:
        ends: list[Any] = []
        for name, point in ((joint.first, joint.first_point), (joint.second, joint.second_point)):
            body = None if name is None else self.mechanism.body_index(name)
            offset = np.array(world_offset(self.mechanism, name, point)) - self.anchors[body]
            ends += [self.joints[body], self._placed(offset)]
        kinds = self.pin.ContactType
        kind = kinds.CONTACT_6D if isinstance(joint, Weld) else kinds.CONTACT_3D
        made = self.pin.RigidConstraintModel(kind, self.model, *ends, self.pin.ReferenceFrame.LOCAL)
        if self.correction:
            gains = self.pin.BaumgarteCorrectorParameters(self.correction**2, 2 * self.correction)
            made.setBaumgarteCorrectorParameters(gains)
        return made

    def _answer(self, position: Array, velocity: Array, torque: Array) -> Array:
        found = self.pin.constraintDynamics(
            self.model, self.data, position, velocity, torque, self.loops, self.loop_data, self.proximal
        )
        return np.array(found)

    def acceleration(self, position: Array, velocity: Array) -> Array:
        """Of the tree coordinates, drives kept at their rates."""
        applied = self._torques(position, velocity)
        free = self._answer(position, velocity, applied)
        if not len(self.driven):
            return free
        answers = self._answers(position)
        if not np.isfinite(answers).all():
            return np.full_like(free, np.nan)
        torques, *_ = np.linalg.lstsq(self.driven @ answers.T, -self.driven @ free, rcond=None)
        return free + torques @ answers

    def _answers(self, position: Array) -> Array:
        """(drives, coordinates) what unit torques of the drives accelerate, at rest and without weight.

        Beside what large forces do their small differences would be rounded away.
        """
        rest, weight = np.zeros(self.tree.coordinates), self.model.gravity.linear.copy()
        self.model.gravity.linear = np.zeros(3)
        pulled = self._answer(position, rest, rest) if self.correction else 0.0
        answers = np.array([self._answer(position, rest, row) - pulled for row in self.driven])
        self.model.gravity.linear = weight
        return answers

    def _torques(self, position: Array, velocity: Array) -> Array:
        """Generalised forces of the force elements: what weight and they need to be held, less what weight needs."""
        if not self.mechanism.forces:
            return np.zeros(self.tree.coordinates)
        pin = self.pin
        pose, pushed = pushes(self.tree, position[self.address], velocity[self.address])
        pin.forwardKinematics(self.model, self.data, position)
        external = pin.StdVec_Force()
        external.extend([pin.Force.Zero() for _ in range(self.model.njoints)])
        for joint, (arm_x, arm_y, _), (x, y, torque) in zip(self._own, pose.tolist(), pushed.tolist(), strict=True):
            about_origin = pin.Force(np.array([x, y, 0.0]), np.array([0.0, 0.0, torque + arm_x * y - arm_y * x]))
            external[joint] = external[joint] + self.data.oMi[joint].actInv(about_origin)
        loaded = pin.computeStaticTorque(self.model, self.data, position, external)
        return np.array(pin.computeGeneralizedGravity(self.model, self.data, position)) - loaded

    def record(self, samples: int, every: int) -> Recorded:
        position, velocity, acceleration = np.full((3, samples + 1, self.tree.coordinates), np.nan)
        q, v = np.zeros(self.tree.coordinates), np.zeros(self.tree.coordinates)
        v[self.address] = self.tree.start_rates()

        def advance(count: int) -> None:
            nonlocal q, v
            for _ in range(count):
                q, v = self.step(self.acceleration, q, v, self.dt)

        def record(sample: int) -> bool:
            is_lost = not (np.isfinite(q).all() and np.isfinite(v).all())
            if not is_lost:
                position[sample], velocity[sample] = q, v
            return is_lost

        with np.errstate(all="ignore"):
            stepping = sampled([every] * samples, advance, record)
        for sample in range(samples + 1):
            if np.isfinite(velocity[sample]).all():
                acceleration[sample] = self.acceleration(position[sample], velocity[sample])
        states = self.tree.motion(*(values[:, self.address] for values in (position, velocity, acceleration)))
        return Recorded(*states, stepping, self._inertias(), np.array(self.model.gravity.linear[:2]))

    def _inertias(self) -> Array:
        """The inertias of the model, in the order of bodies; NaN of welded ones, of which it holds only the sum."""
        inertias = [self.model.inertias[joint] for joint in self._own]
        by_body = np.array([(inertia.mass, inertia.mass, inertia.inertia[2, 2]) for inertia in inertias])
        by_body[[self._own.count(joint) > 1 or joint == 0 for joint in self._own]] = np.nan
        return by_body


Acceleration = Callable[[Array, Array], Array]


def euler_step(acceleration: Acceleration, q: Array, v: Array, dt: float) -> tuple[Array, Array]:
    """Semi-implicit: the new velocity drifts."""
    v = v + dt * acceleration(q, v)
    return q + dt * v, v


def runge_kutta_step(acceleration: Acceleration, q: Array, v: Array, dt: float) -> tuple[Array, Array]:
    """The classical method of fourth order for q'' = acceleration(q, q')."""
    first = acceleration(q, v)
    half = dt / 2
    v2 = v + half * first
    second = acceleration(q + half * v, v2)
    v3 = v + half * second
    third = acceleration(q + half * v2, v3)
    v4 = v + dt * third
    fourth = acceleration(q + dt * v3, v4)
    return q + dt / 6 * (v + 2 * v2 + 2 * v3 + v4), v + dt / 6 * (first + 2 * second + 2 * third + fourth)


DEFAULT = Pinocchio("default")
TUNED = Pinocchio("tuned", "rk4")
VARIANTS = (DEFAULT, TUNED)
