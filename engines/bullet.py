"""Bullet under test, by its binding PyBullet: a tree in reduced coordinates, loops closed by impulses at points.

PyBullet and not ODE: it is what people use, and pip installs it whole, while ode-python needs a library of the system.
Its wheels end with Python 3.11; the wheel is built in double precision.

The tree is that of `engines.tree`, written as a URDF file, because nothing else takes a link's inertia, and read back:
continuous joints, prismatic ones for slots whose angle is kept, fixed ones for welds. A Pin that closes a loop is a
JOINT_POINT2POINT of enough force, a Weld a JOINT_FIXED, a Drive the velocity motor of a joint, a Gear a JOINT_GEAR
between two joints of the tree. This adapter makes no link of mass zero, so a body that slides and turns, or that hangs
on nothing, is refused; Bullet itself would take one. Our code works out what force elements do to bodies before every
step, as users do, and passes it to the engine as external forces. All damping and the limit on joint velocities are
off.

One step (btMultiBodyDynamicsWorld) kicks with the forces at the old positions, corrects the velocities by impulses with
a push against the gap (erp, 0.2 of it a step as shipped), and drifts with the new ones: semi-implicit Euler of first
order. Accelerations are changes of velocity over the last step, so there are none at t = 0.

A joint that moves less inertia than 2.2e-16 (SIMD_EPSILON) in the model's units, a millimetre's body in metres, say,
feels no force (btMultiBody.cpp); it goes on as it began, with a warning. So does one for a motor of a joint that
moves more than 1 / SIMD_EPSILON = 4.5e15, to which it does nothing (btMultiBodyConstraint.cpp).
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from engines.capability import Capability
from engines.contract import EXACT, ConvergenceOrder, Enforcement, NotDeclared, Size, Unsupported, unresolved
from engines.extrapolated import Extrapolated
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.sampling import sampled_with_differences
from engines.single_run import ExtraEngine, Recorded, quiet
from engines.tree import Link, Tree, pushes, refuse_slots_in_loops, spanning_tree, world_offset
from reference.checks import Count, Fraction, Name, validated
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

ENOUGH = 1e30  # N or N m, of a point that closes a loop and of a motor: what a mechanism of any unit asks for is less
FAST = 1e9  # rad/s, beyond what a joint reaches
STEP_COST = 9e-6  # s of a step of three bodies, as shipped
FORCES_COST = 250e-6  # s, of force elements, which are worked out by numpy
ITERATION_COST = 0.1e-6  # s, of an iteration for each row of a loop
SHIPPED_ITERATIONS, SHIPPED_ERP = 50, 0.2
NOTHING = float(np.finfo(float).eps)  # kg or kg m^2: SIMD_EPSILON, below which the inverse of an inertia is zero
UNMOVED = unresolved(0.0, "bullet takes an inertia below 2.2e-16 for none and moves it by no force")
UNTURNED = unresolved(0.0, "a motor of bullet does nothing to an inertia above 4.5e15")
NOWHERE = [0.0, 0.0, 0.0]


@dataclass(frozen=True)
class Bullet(ExtraEngine):
    """An engine in the sense of `engines.Engine`.

    `iterations` of the solver over its rows, which end early below `residual`; `erp`: the share of a gap that a step
    closes.
    """

    name = "bullet"
    packages = ("pybullet",)
    modules: ClassVar[tuple[str, ...]] = ("pybullet",)
    forces_by: ClassVar[Enforcement] = "ours"
    capability: ClassVar[Capability] = Capability(
        "bullet",
        frozenset({Pin, Slot, Drive, Gear, Weld}),
        lacks={
            Rod: "our adapter of bullet builds no distance between points",
            Skate: "bullet stops slip by friction at a contact, and our adapter builds no contact",
            Roll: "in bullet a disc rolls by contact and friction, and our adapter builds no contact",
        },
    )

    variant: Name
    iterations: Count = SHIPPED_ITERATIONS
    residual: Fraction = 1e-7
    erp: Fraction = SHIPPED_ERP

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """First, of semi-implicit Euler; what the tree holds is exact.

        Iterations end where the square of the slip, in m/s or rad/s, is below `residual`, at whatever step. Where
        nothing is left to be integrated that is the whole error of a loop.
        """
        loops = spanning_tree(mechanism).loops
        if loops and is_prescribed(mechanism) and self.residual:
            return NotDeclared(
                f"iterations of bullet end at a residual of {self.residual:g}, however short the step is"
            )
        if loops or any(isinstance(joint, Gear) for joint in mechanism.joints):
            return ConvergenceOrder(1, differences=1)
        if turns_steadily(mechanism) or is_prescribed(mechanism):
            return ConvergenceOrder(EXACT, reaction=1, differences=1)
        return ConvergenceOrder(1, gap=EXACT, slip=EXACT, differences=1)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]."""
        rows = 3 * len(spanning_tree(mechanism).loops)
        forces = FORCES_COST if mechanism.forces else 0.0
        return STEP_COST * over_three(mechanism) + ITERATION_COST * self.iterations * rows + forces

    def stricter(self, mechanism: Mechanism) -> Bullet | None:
        """With twenty times as many iterations, where there are loops, whose rows they solve."""
        if not spanning_tree(mechanism).loops and not any(isinstance(joint, Drive) for joint in mechanism.joints):
            return None
        return replace(self, iterations=20 * self.iterations, residual=0.0)

    def model(self, mechanism: Mechanism, dt: float) -> BulletWorld:
        parameters = {"numSolverIterations": self.iterations, "solverResidualThreshold": self.residual, "erp": self.erp}
        tree = spanning_tree(mechanism)
        return BulletWorld(tree, motor_rates(tree), dt, parameters)


def unmoved(tree: Tree, motors: Iterable[int]) -> tuple[RunWarning, ...]:
    """Warnings of inertias that the engine takes for none or for infinite ones, in the pose of the start.

    A joint moves what hangs on it, whose own joints are free: 1 / (M^-1)_jj, M of the coordinates from it outwards
    (Featherstone's articulated inertia). A motor moves all of the tree, which is the same of all coordinates.
    """
    if not tree.coordinates:
        return ()
    still = np.zeros(tree.coordinates)
    rest, units = tree.instant(still, still)[1], np.eye(tree.coordinates)
    twists = np.array([(tree.instant(still, unit)[1] - rest).reshape(-1) for unit in units])
    masses = (twists * tree.mechanism.inertias.reshape(-1)) @ twists.T
    size = np.sqrt(np.diag(masses))

    def moved(columns: list[int], column: int) -> float:
        scaled = masses[np.ix_(columns, columns)] / np.outer(size[columns], size[columns])
        index = columns.index(column)
        return float(size[column] ** 2 / np.linalg.pinv(scaled, hermitian=True)[index, index])

    outwards: dict[int, list[int]] = {}
    for link in reversed(tree.links):
        columns = [*link.columns, *outwards.pop(link.body, [])]
        if link.columns and moved(columns, link.column) < NOTHING:
            return (UNMOVED,)
        if link.parent is not None:
            outwards.setdefault(link.parent, []).extend(columns)
    every = [*range(tree.coordinates)]
    return (UNTURNED,) if any(moved(every, column) > 1 / NOTHING for column in motors) else ()


def motor_rates(tree: Tree) -> dict[int, float]:
    """The rates [rad/s] of the tree coordinates that motors turn; raises Unsupported for what bullet can't hold."""
    refuse_slots_in_loops(tree, "bullet")
    bodies, rates = tree.mechanism.bodies, dict[int, float]()
    for link in tree.links:
        if len(link.columns) > 1:
            raise Unsupported(
                f"body {bodies[link.body].name!r}: it slides and turns, or hangs on nothing; that needs a "
                "link of mass zero in bullet's tree, and our adapter makes none"
            )
    for joint in tree.mechanism.joints:
        if isinstance(joint, Drive) and joint not in tree.kept:
            turned = tree.turning(joint.first, joint.second)
            if len(turned) != 1 or next(iter(turned)) in rates:
                raise Unsupported(f"drive {joint.name!r}: a motor of bullet turns one joint, and has one rate")
            ((column, sign),) = turned.items()
            rates[column] = sign * joint.turning_rate
        if isinstance(joint, Gear):
            geared_columns(tree, joint)
    return rates


def geared_columns(tree: Tree, gear: Gear) -> tuple[int, int]:
    """The tree coordinates of the second and of the first body's angle; raises Unsupported."""
    turned = [tree.turning(None, name) for name in (gear.second, gear.first)]
    if any(len(columns) != 1 for columns in turned):
        raise Unsupported(
            f"joint {gear.name!r}: a gear of bullet is between two of its joints, "
            "and the angle of a body that does not hang on the ground is a sum of several"
        )
    second, first = (next(iter(columns)) for columns in turned)
    return second, first


@cache
def package() -> Any:
    """The package, which prints a line when it is imported."""
    with quiet():
        import pybullet
    return pybullet


class BulletWorld:
    """The engine's objects for one mechanism, in a server of its own within this process."""

    def __init__(self, tree: Tree, motors: dict[int, float], dt: float, parameters: dict[str, float]) -> None:
        """`motors`: rates [rad/s] of tree coordinates that a motor turns; `parameters`: the engine's own, by name."""
        self.mechanism, self.tree, self.dt, self.motors, self.bullet = tree.mechanism, tree, dt, motors, package()
        self.server: int = self.bullet.connect(self.bullet.DIRECT)
        self._call("setGravity", *self.mechanism.gravity, 0.0)
        self._call("setPhysicsEngineParameter", fixedTimeStep=dt, **parameters)
        self.anchors = {link.body: np.array(link.anchor) for link in tree.links}
        with tempfile.TemporaryDirectory(prefix="crosscheck-") as folder, quiet():
            file = Path(folder, "mechanism.urdf")
            file.write_text(self._urdf(), encoding="utf-8")
            flags = self.bullet.URDF_USE_INERTIA_FROM_FILE
            self.body: int = self._call("loadURDF", str(file), useFixedBase=True, flags=flags)
        infos = [self._call("getJointInfo", self.body, index) for index in range(self._call("getNumJoints", self.body))]
        names = [info[1].decode() for info in infos]
        self.links = [names.index(f"joint {link.body}") for link in tree.links]
        # All links with a coordinate have one, so they stand in the order of the coordinates.
        self.moving = [index for link, index in zip(tree.links, self.links, strict=True) if link.columns]
        self._start()
        for loop in tree.loops:
            self._close(loop)
        gears = [joint for joint in self.mechanism.joints if isinstance(joint, Gear)]
        for gear in gears:  # the rate of the second body's joint less `ratio` times that of the first's is zero
            second, first = (self.moving[column] for column in geared_columns(tree, gear))
            self._constrain(second, first, self.bullet.JOINT_GEAR, NOWHERE, NOWHERE, gearRatio=-gear.ratio)
        rows, single = sum(loop.size for loop in tree.loops), len(motors) + len(gears)
        spatial = sum(6 if isinstance(loop, Weld) else 3 for loop in tree.loops)
        self.size = Size(len(self.mechanism.bodies), tree.coordinates, rows + single, spatial + single)

    def __del__(self) -> None:
        if getattr(self, "server", -1) >= 0:
            self.bullet.disconnect(self.server)

    def _call(self, function: str, *arguments: Any, **named: Any) -> Any:
        """A function of the engine in our server."""
        return getattr(self.bullet, function)(*arguments, **named, physicsClientId=self.server)

    def _start(self) -> None:
        """Switch damping off and set rates and motors."""
        rates = self.tree.start_rates()
        self._call("changeDynamics", self.body, -1, linearDamping=0.0, angularDamping=0.0)
        for link, index in zip(self.tree.links, self.links, strict=True):
            free = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0, "maxJointVelocity": FAST}
            self._call("changeDynamics", self.body, index, **free)
            if link.columns:
                rate = self.motors.get(link.column, float(rates[link.column]))
                self._call("resetJointState", self.body, index, 0.0, rate)
                motor = {"targetVelocity": rate, "force": ENOUGH if link.column in self.motors else 0.0}
                self._call("setJointMotorControl2", self.body, index, self.bullet.VELOCITY_CONTROL, **motor)

    def _urdf(self) -> str:
        links = map(self._link, self.tree.links)
        return "\n".join(['<robot name="mechanism"><link name="ground"/>', *links, "</robot>"])

    def _link(self, link: Link) -> str:
        """A link whose frame stands at its joint, parallel to the world's at the start."""
        body = self.mechanism.bodies[link.body]
        parent = "ground" if link.parent is None else f"body {link.parent}"
        x, y = np.array(link.arm) - (0.0 if link.parent is None else self.anchors[link.parent])
        kind, axis = ("continuous", (0.0, 0.0, 1.0)) if link.turns else ("prismatic", (*link.direction, 0.0))
        kind = kind if link.columns else "fixed"
        inertia = " ".join(f'i{axes}="{body.inertia!r}"' for axes in ("xx", "yy", "zz"))
        reach = '<limit lower="1" upper="-1" effort="0" velocity="0"/>' if kind == "prismatic" else ""  # no limit
        return (
            f'<link name="body {link.body}"><inertial><origin xyz="{-link.anchor[0]!r} {-link.anchor[1]!r} 0"/>'
            f'<mass value="{body.mass!r}"/><inertia {inertia} ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="joint {link.body}" type="{kind}"><parent link="{parent}"/><child link="body {link.body}"/>'
            f'<origin xyz="{float(x)!r} {float(y)!r} 0"/><axis xyz="{" ".join(map(repr, axis))}"/>{reach}</joint>'
        )

    def _close(self, loop: Pin | Slot | Weld) -> None:
        """A point of two links, or both altogether: each from the link's centre of mass, the ground's in the world."""
        numbers = {link.body: index for link, index in zip(self.tree.links, self.links, strict=True)}
        ends = [
            (
                -1 if name is None else numbers[self.mechanism.body_index(name)],
                [*world_offset(self.mechanism, name, point), 0.0],
            )
            for name, point in ((loop.first, loop.first_point), (loop.second, loop.second_point))
        ]
        ends.sort(key=lambda end: end[0] < 0)  # the ground can only be the second
        (first, at), (second, there) = ends
        kind = self.bullet.JOINT_FIXED if isinstance(loop, Weld) else self.bullet.JOINT_POINT2POINT
        self._constrain(first, second, kind, at, there)

    def _constrain(self, first: int, second: int, kind: int, at: Any, there: Any, **settings: float) -> None:
        other = self.body if second >= 0 else -1
        made = self._call("createConstraint", self.body, first, other, second, kind, [0, 0, 1], at, there)
        self._call("changeConstraint", made, maxForce=ENOUGH, **settings)

    def _push(self) -> None:
        """Give the engine what force elements do now: it forgets them after a step."""
        _, pushed = pushes(self.tree, *map(np.array, self._state()))
        for link, index in zip(self.tree.links, self.links, strict=True):
            x, y, torque = pushed[link.body]
            at = self._call("getLinkState", self.body, index, computeForwardKinematics=True)[0]
            self._call("applyExternalForce", self.body, index, [x, y, 0.0], at, self.bullet.WORLD_FRAME)
            self._call("applyExternalTorque", self.body, index, [0.0, 0.0, torque], self.bullet.WORLD_FRAME)

    def _state(self) -> tuple[list[float], list[float]]:
        """The tree coordinates and their rates."""
        states = self.bullet.getJointStates(self.body, self.moving, self.server)
        return [state[0] for state in states], [state[1] for state in states]

    def _advance(self, count: int) -> None:
        step = partial(self.bullet.stepSimulation, self.server)
        for _ in range(count):
            if self.mechanism.forces:
                self._push()
            step()

    def record(self, samples: int, every: int) -> Recorded:
        mechanism = self.mechanism
        *states, stepping = sampled_with_differences(
            (samples, every), self.dt, self._advance, self._state, lambda: self._state()[1]
        )
        motion = self.tree.motion(*states)
        warnings = unmoved(self.tree, self.motors)
        return Recorded(*motion, stepping, mechanism.inertias, np.array(mechanism.gravity), warnings)


DEFAULT = Bullet("default")
TUNED = Bullet("tuned", iterations=200, residual=0.0, erp=1.0)
# All of a gap is closed in every step: with less, what a few steps leave behind is no series in the step.
EXTENDED = Extrapolated(TUNED, "extended", levels=(1, 2, 3, 4), powers=(1, 2, 3))
VARIANTS = (DEFAULT, TUNED, EXTENDED)
