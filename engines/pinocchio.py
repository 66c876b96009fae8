"""Pinocchio under test: a tree in reduced coordinates whose loops are closed by exact contact constraints.

Pinocchio (the package `pin`) computes accelerations and has no time stepping; its `integrate` only adds a displacement
to a configuration. Our code integrates by semi-implicit Euler or the classical Runge-Kutta method of order 4, as
Pinocchio's examples do.

`engines.tree` makes the tree. A Pin is a revolute joint about z, and a Slot is a prismatic joint. A free body has two
prismatic joints and a revolute joint. A welded body has no joint, and its inertia is added to the other body. A
RigidConstraintModel closes a loop, of the type CONTACT_3D for a Pin and CONTACT_6D for a Weld. `constraintDynamics`
satisfies the constraints for accelerations exactly, so gaps are errors of the integrator. The proximal solver permits
rows out of the plane, which are empty.

The engine has no counterpart of a Drive. In every evaluation our code computes the torque that keeps the rate of a
drive, from the accelerations due to a unit torque at rest without gravity. The engine has no force elements either, so
our code evaluates them and passes them as external forces. Accelerations and reactions belong to the sampled instant.
The engine has the gear JointModelMimic, which `constraintDynamics` refuses.

`constraintDynamics` sums forces, and torques about the world's origin, along the tree. Rounding is therefore large for
a light body that carries a heavy body, and for a mechanism far from the origin.

As shipped the engine does not reduce the gap of a loop. Depending on the motion and the step, Baumgarte gains of the
constraints increase or reduce the errors of both integrators. Therefore the adapter sets no gains.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability, Lack
from engines.contract import EXACT, ConvergenceOrder, Enforcement, NotDeclared, Size
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.sampling import sampled
from engines.single_run import ExtraEngine, Recorded
from engines.tree import TREE_FORCES_COST, Link, Tree, pushes, spanning_tree, world_ends
from reference.checks import Name, validated
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Array = NDArray[np.float64]
Integrator = Literal["euler", "rk4"]
# Regularisation of the proximal solver. The value is far above rounding because the rows out of the plane are empty.
PROXIMAL_REGULARISATION = 1e-10
PROXIMAL_TOLERANCE = 1e-14  # Tolerance of the proximal solver's residual.
PROXIMAL_ITERATIONS = 20  # Iteration limit of the proximal solver; a four-bar linkage needs two.
# CPU time [s] of an evaluation of three bodies.
PINOCCHIO_EVALUATION_COST = 6e-6
# The engine's constraint for a joint that closes a loop. A joint with "" closes no loop.
PINOCCHIO_JOINTS = {Pin: "CONTACT_3D", Weld: "CONTACT_6D", Slot: "", Drive: ""}


@dataclass(frozen=True)
class Pinocchio(ExtraEngine):
    """integrator: "euler" (semi-implicit, order 1) or "rk4" (order 4)."""

    name = "pinocchio"
    packages = ("pin",)
    modules: ClassVar[tuple[str, ...]] = ("pinocchio",)
    forces_by: ClassVar[Enforcement] = "ours"
    capability: ClassVar[Capability] = Capability(
        "pinocchio",
        PINOCCHIO_JOINTS,
        lacks={
            Rod: Lack("our adapter of pinocchio holds points and frames together, and no distance between points"),
            Gear: Lack("our adapter calls constraintDynamics, which refuses pinocchio's JointModelMimic"),
            Skate: Lack("our adapter of pinocchio holds whole points, and no velocity across a blade"),
            Roll: Lack("our adapter of pinocchio builds no contact"),
        },
        lacks_in_loops={Slot: Lack("our adapter of pinocchio builds no slot that closes a loop")},
    )

    variant: Name
    integrator: Integrator = "euler"

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        tree = spanning_tree(mechanism)
        order = 4 if self.integrator == "rk4" else 1
        if tree.loops:
            return ConvergenceOrder(order)
        if turns_steadily(mechanism) or is_prescribed(mechanism):
            return ConvergenceOrder(EXACT)
        return ConvergenceOrder(order, gap=EXACT, slip=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """Approximate CPU time of a step [s]; each drive needs a further evaluation."""
        drives = sum(isinstance(joint, Drive) for joint in mechanism.joints)
        stages = 4 if self.integrator == "rk4" else 1
        evaluation = PINOCCHIO_EVALUATION_COST * (1 + drives) * over_three(mechanism)
        return stages * (evaluation + (TREE_FORCES_COST if mechanism.forces else 0.0))

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return "ours" if joint in spanning_tree(mechanism).drives else "engine"

    def model(self, mechanism: Mechanism, dt: float) -> PinocchioModel:
        return PinocchioModel(spanning_tree(mechanism), dt, self.integrator)


class PinocchioModel:
    def __init__(self, tree: Tree, dt: float, integrator: Integrator) -> None:
        import pinocchio

        self.pin, self.mechanism, self.tree, self.dt = pinocchio, tree.mechanism, tree, dt
        self.step = runge_kutta_step if integrator == "rk4" else euler_step
        mechanism = self.mechanism
        self.model = pinocchio.Model()
        self.model.gravity.linear = np.array([*mechanism.gravity, 0.0])
        self.joints: dict[int | None, int] = {None: 0}  # The last joint of each body; joint 0 is the universe.
        self.anchors: dict[int | None, Array] = {None: np.zeros(2)}  # From the centre of mass to the last joint [m].
        self.address: list[int] = [0] * tree.coordinates  # Index of each tree coordinate in the engine's vectors.
        self._add_links()
        self.data = self.model.createData()
        self.loops = pinocchio.StdVec_RigidConstraintModel()
        self.loop_data = pinocchio.StdVec_RigidConstraintData()
        for joint in tree.loops:
            self.loops.append(self._loop(joint))
            self.loop_data.append(self.loops[-1].createData())
        pinocchio.initConstraintDynamics(self.model, self.data, self.loops, self.loop_data)
        self.proximal = pinocchio.ProximalSettings(PROXIMAL_TOLERANCE, PROXIMAL_REGULARISATION, PROXIMAL_ITERATIONS)
        self.driven = np.zeros((len(tree.drives), tree.coordinates))
        for row, drive in zip(self.driven, tree.drives, strict=True):
            for column, sign in tree.turning(drive.first, drive.second).items():
                row[self.address[column]] = sign
        self.joint_of = [self.joints[body] for body in range(len(mechanism.bodies))]
        rows = sum(joint.size for joint in tree.loops) + len(tree.drives)
        spatial = sum(6 if isinstance(joint, Weld) else 3 for joint in tree.loops)
        self.size = Size(len(mechanism.bodies), tree.coordinates, rows, spatial)

    def _placed(self, offset: Any) -> Any:
        return self.pin.SE3(np.eye(3), np.array([offset[0], offset[1], 0.0]))

    def _add_links(self) -> None:
        """Add the bodies depth first, since the engine's sparse factorisation requires this order."""
        children: dict[int | None, list[Link]] = {}
        for link in self.tree.links:
            children.setdefault(link.parent, []).append(link)
        waiting = children.get(None, [])[::-1]
        while waiting:  # a recursion would be too deep for a chain of a thousand bodies
            link = waiting.pop()
            self._add(link)
            waiting += children.get(link.body, [])[::-1]

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
        if not kinds:  # a welded body uses the joint of its parent
            anchor, at = anchor - at, (0.0, 0.0)
        for number, (kind, column) in enumerate(zip(kinds, link.columns, strict=True)):
            self.address[column] = self.model.nv
            joint = self.model.addJoint(joint, kind, self._placed(at), f"body {link.body} joint {number}")
            at = (0.0, 0.0)
        # Inertias about the axes x and y have no effect but must be positive.
        inertia = pin.Inertia(body.mass, -np.array([*anchor, 0.0]), body.inertia * np.eye(3))
        self.model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
        self.joints[link.body], self.anchors[link.body] = joint, anchor

    def _loop(self, joint: Any) -> Any:
        ends: list[Any] = []
        for body, offset in world_ends(self.mechanism, joint):
            ends += [self.joints[body], self._placed(np.array(offset) - self.anchors[body])]
        kind = getattr(self.pin.ContactType, PINOCCHIO_JOINTS[type(joint)])
        return self.pin.RigidConstraintModel(kind, self.model, *ends, self.pin.ReferenceFrame.LOCAL)

    def _constrained(self, position: Array, velocity: Array, torque: Array) -> Array:
        acceleration = self.pin.constraintDynamics(
            self.model, self.data, position, velocity, torque, self.loops, self.loop_data, self.proximal
        )
        return np.array(acceleration)

    def acceleration(self, position: Array, velocity: Array) -> Array:
        """The accelerations (coordinates,) of the tree coordinates, with torques that keep the rates of drives."""
        applied = self._torques(position, velocity)
        free = self._constrained(position, velocity, applied)
        if not len(self.driven):
            return free
        responses = self._responses(position)
        if not np.isfinite(responses).all():
            return np.full_like(free, np.nan)
        torques, *_ = np.linalg.lstsq(self.driven @ responses.T, -self.driven @ free, rcond=None)
        return free + torques @ responses

    def _responses(self, position: Array) -> Array:
        rest, weight = np.zeros(self.tree.coordinates), self.model.gravity.linear.copy()
        self.model.gravity.linear = np.zeros(3)
        responses = np.array([self._constrained(position, rest, row) for row in self.driven])
        self.model.gravity.linear = weight
        return responses

    def _torques(self, position: Array, velocity: Array) -> Array:
        """Generalised forces of the force elements: the change of the engine's static torques."""
        if not self.mechanism.forces:
            return np.zeros(self.tree.coordinates)
        pin = self.pin
        pose, forces = pushes(self.tree, position[self.address], velocity[self.address])
        pin.forwardKinematics(self.model, self.data, position)
        external = pin.StdVec_Force()
        external.extend([pin.Force.Zero() for _ in range(self.model.njoints)])
        for joint, (arm_x, arm_y, _), (x, y, torque) in zip(self.joint_of, pose.tolist(), forces.tolist(), strict=True):
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
        """The model's inertias by body, or NaN for welded bodies, since the model combines their inertias."""
        inertias = [self.model.inertias[joint] for joint in self.joint_of]
        by_body = np.array([(inertia.mass, inertia.mass, inertia.inertia[2, 2]) for inertia in inertias])
        by_body[[self.joint_of.count(joint) > 1 or joint == 0 for joint in self.joint_of]] = np.nan
        return by_body


Acceleration = Callable[[Array, Array], Array]


def euler_step(acceleration: Acceleration, q: Array, v: Array, dt: float) -> tuple[Array, Array]:
    v = v + dt * acceleration(q, v)
    return q + dt * v, v


def runge_kutta_step(acceleration: Acceleration, q: Array, v: Array, dt: float) -> tuple[Array, Array]:
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
