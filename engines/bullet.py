"""Bullet under test, by its binding PyBullet: a tree in reduced coordinates, with loops closed by impulses at points.

PyBullet has wheels up to Python 3.11, which compute in double precision.

`engines.tree` makes the tree, and PyBullet loads it from a URDF file, since it has no other way to set a link's
inertia. In the tree a Pin is a continuous joint, a Slot with a fixed angle is a prismatic joint, and a Weld is a fixed
joint. A Pin that closes a loop is a JOINT_POINT2POINT, and a Weld that closes a loop is a JOINT_FIXED. A Drive is the
velocity motor of a joint. A Gear is a JOINT_GEAR between two joints of the tree. The adapter refuses a body that slides
and turns, and a body without joints, since they need links of mass zero. Our code evaluates force elements before each
step and passes them to the engine as external forces. The engine's damping is off.

One step (btMultiBodyDynamicsWorld) applies the forces at the old positions and corrects the velocities by impulses. In
a step the impulses also close the share `erp` of a gap, 0.2 as shipped. Then the engine integrates the positions with
the new velocities. A step is therefore one of the semi-implicit Euler method, which has order 1. Accelerations are
changes of velocity over the last step, so they are unknown at t = 0.

No force accelerates a joint whose articulated inertia in the model's units is below SIMD_EPSILON = 2.2e-16
(btMultiBody.cpp). A motor has no effect on a joint whose inertia is above 1 / SIMD_EPSILON = 4.5e15
(btMultiBodyConstraint.cpp). The adapter warns about inertias that are too small or too large.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from engines.capability import Capability, Lack
from engines.contract import EXACT, ConvergenceOrder, Enforcement, NotDeclared, Size, Unsupported, unresolved
from engines.extrapolated import Extrapolated
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.sampling import sampled_with_differences
from engines.single_run import ExtraEngine, Recorded, quiet
from engines.tree import TREE_FORCES_COST, Link, Tree, pushes, spanning_tree, world_ends
from reference.checks import Count, Fraction, Name, validated
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

# The force limit [N, N m] of loop-closing constraints and motors.
MAX_FORCE = 1e30
# The engine's limit on the rate of a joint [rad/s].
RATE_LIMIT = 1e9
# CPU time [s] of a step of three bodies with the settings as shipped. ITERATION_COST is for one iteration over one row.
BULLET_STEP_COST = 9e-6
ITERATION_COST = 0.1e-6
SHIPPED_ITERATIONS = 50
SHIPPED_ERP = 0.2
# SIMD_EPSILON of the engine [kg, kg m^2]. The engine replaces the inverse of an inertia below SIMD_EPSILON by zero.
SMALLEST_INERTIA = float(np.finfo(float).eps)
UNMOVED = unresolved(0.0, "bullet takes an inertia below 2.2e-16 for none and moves it by no force")
UNTURNED = unresolved(0.0, "a motor of bullet does nothing to an inertia above 4.5e15")
ORIGIN = [0.0, 0.0, 0.0]
# The engine's constraint for a joint that closes a loop. A joint with "" closes no loop.
BULLET_JOINTS = {Pin: "JOINT_POINT2POINT", Weld: "JOINT_FIXED", Slot: "", Drive: "", Gear: ""}


@dataclass(frozen=True)
class Bullet(ExtraEngine):
    """iterations: largest number of the solver's iterations over the rows.
    residual: tolerance of the solver's residual.
    erp: share of a gap that a step closes.
    """

    name = "bullet"
    packages = ("pybullet",)
    modules: ClassVar[tuple[str, ...]] = ("pybullet",)
    forces_by: ClassVar[Enforcement] = "ours"
    capability: ClassVar[Capability] = Capability(
        "bullet",
        BULLET_JOINTS,
        lacks={
            Rod: Lack("our adapter of bullet builds no distance between points"),
            Skate: Lack("bullet stops slip by friction at a contact, and our adapter builds no contact"),
            Roll: Lack("in bullet a disc rolls by contact and friction, and our adapter builds no contact"),
        },
        lacks_in_loops={Slot: Lack("our adapter of bullet builds no slot that closes a loop")},
    )

    variant: Name
    iterations: Count = SHIPPED_ITERATIONS
    residual: Fraction = 1e-7
    erp: Fraction = SHIPPED_ERP

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """Order 1, since the method is semi-implicit Euler; joints of the tree have no gap.

        No order is declared for loops in a prescribed motion: their only error is the slip at which iterations end.
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
        rows = 3 * len(spanning_tree(mechanism).loops)
        forces = TREE_FORCES_COST if mechanism.forces else 0.0
        return BULLET_STEP_COST * over_three(mechanism) + ITERATION_COST * self.iterations * rows + forces

    def stricter(self, mechanism: Mechanism) -> Bullet | None:
        """The method with twenty times as many iterations, or None if no joint is a row of the solver."""
        if not spanning_tree(mechanism).loops and not any(isinstance(joint, Drive) for joint in mechanism.joints):
            return None
        return replace(self, iterations=20 * self.iterations, residual=0.0)

    def model(self, mechanism: Mechanism, dt: float) -> BulletWorld:
        parameters = {"numSolverIterations": self.iterations, "solverResidualThreshold": self.residual, "erp": self.erp}
        tree = spanning_tree(mechanism)
        return BulletWorld(tree, motor_rates(tree), dt, parameters)


def inertia_warnings(tree: Tree, motors: Iterable[int]) -> tuple[RunWarning, ...]:
    """Warnings about inertias at t = 0 that are too small or too large for the engine.

    The inertia of coordinate j is 1 / (M^-1)_jj. For a motor, M is the mass matrix of all coordinates. For a joint, M
    is the mass matrix of the coordinates from the joint outwards, which gives Featherstone's articulated inertia.
    """
    if not tree.coordinates:
        return ()
    masses = (tree.unit_twists * tree.mechanism.inertias.reshape(-1)) @ tree.unit_twists.T
    size = np.sqrt(np.diag(masses))

    def inertia(columns: list[int], column: int) -> float:
        scaled = masses[np.ix_(columns, columns)] / np.outer(size[columns], size[columns])
        index = columns.index(column)
        return float(size[column] ** 2 / np.linalg.pinv(scaled, hermitian=True)[index, index])

    outwards: dict[int, list[int]] = {}
    for link in reversed(tree.links):
        columns = [*link.columns, *outwards.pop(link.body, [])]
        if link.columns and inertia(columns, link.column) < SMALLEST_INERTIA:
            return (UNMOVED,)
        if link.parent is not None:
            outwards.setdefault(link.parent, []).extend(columns)
    columns = [*range(tree.coordinates)]
    return (UNTURNED,) if any(inertia(columns, column) > 1 / SMALLEST_INERTIA for column in motors) else ()


def motor_rates(tree: Tree) -> dict[int, float]:
    """The rates [rad/s] of motors by tree coordinate; raises Unsupported for an element that bullet cannot build."""
    bodies, rates = tree.mechanism.bodies, dict[int, float]()
    for link in tree.links:
        if len(link.columns) > 1:
            raise Unsupported(
                f"body {bodies[link.body].name!r}: it slides and turns, or hangs on nothing; that needs a "
                "link of mass zero in bullet's tree, and our adapter makes none"
            )
    for drive in tree.drives:
        signs = tree.turning(drive.first, drive.second)
        if len(signs) != 1 or next(iter(signs)) in rates:
            raise Unsupported(f"drive {drive.name!r}: a motor of bullet turns one joint, and has one rate")
        ((column, sign),) = signs.items()
        rates[column] = sign * drive.turning_rate
    for joint in tree.mechanism.joints:
        if isinstance(joint, Gear):
            geared_columns(tree, joint)
    return rates


def geared_columns(tree: Tree, gear: Gear) -> tuple[int, int]:
    coordinates = [tree.turning(None, name) for name in (gear.second, gear.first)]
    if any(len(columns) != 1 for columns in coordinates):
        raise Unsupported(
            f"joint {gear.name!r}: a gear of bullet is between two of its joints, "
            "and the angle of a body that does not hang on the ground is a sum of several"
        )
    second, first = (next(iter(columns)) for columns in coordinates)
    return second, first


@cache
def package() -> Any:
    with quiet():
        import pybullet
    return pybullet


class BulletWorld:
    def __init__(self, tree: Tree, motors: dict[int, float], dt: float, parameters: dict[str, float]) -> None:
        """`motors`: rates [rad/s] by tree coordinate; `parameters`: parameters of the engine by name."""
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
        # Each moving link has one coordinate, so the list is in the order of the coordinates.
        self.moving = [index for link, index in zip(tree.links, self.links, strict=True) if link.columns]
        self._start()
        for loop in tree.loops:
            self._close(loop)
        gears = [joint for joint in self.mechanism.joints if isinstance(joint, Gear)]
        for gear in gears:  # second rate - ratio * first rate = 0
            second, first = (self.moving[column] for column in geared_columns(tree, gear))
            self._constrain(second, first, self.bullet.JOINT_GEAR, ORIGIN, ORIGIN, gearRatio=-gear.ratio)
        rows, single = sum(loop.size for loop in tree.loops), len(motors) + len(gears)
        spatial = sum(6 if isinstance(loop, Weld) else 3 for loop in tree.loops)
        self.size = Size(len(self.mechanism.bodies), tree.coordinates, rows + single, spatial + single)

    def __del__(self) -> None:
        if getattr(self, "server", -1) >= 0:
            self.bullet.disconnect(self.server)

    def _call(self, function: str, *arguments: Any, **named: Any) -> Any:
        return getattr(self.bullet, function)(*arguments, **named, physicsClientId=self.server)

    def _start(self) -> None:
        rates = self.tree.start_rates()
        self._call("changeDynamics", self.body, -1, linearDamping=0.0, angularDamping=0.0)
        for link, index in zip(self.tree.links, self.links, strict=True):
            free = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0, "maxJointVelocity": RATE_LIMIT}
            self._call("changeDynamics", self.body, index, **free)
            if link.columns:
                rate = self.motors.get(link.column, float(rates[link.column]))
                self._call("resetJointState", self.body, index, 0.0, rate)
                motor = {"targetVelocity": rate, "force": MAX_FORCE if link.column in self.motors else 0.0}
                self._call("setJointMotorControl2", self.body, index, self.bullet.VELOCITY_CONTROL, **motor)

    def _urdf(self) -> str:
        links = map(self._link, self.tree.links)
        return "\n".join(['<robot name="mechanism"><link name="ground"/>', *links, "</robot>"])

    def _link(self, link: Link) -> str:
        """The URDF of a link; its frame has its origin at the joint and is parallel to the world's frame at t = 0."""
        body = self.mechanism.bodies[link.body]
        parent = "ground" if link.parent is None else f"body {link.parent}"
        x, y = np.array(link.arm) - (0.0 if link.parent is None else self.anchors[link.parent])
        kind, axis = ("continuous", (0.0, 0.0, 1.0)) if link.turns else ("prismatic", (*link.direction, 0.0))
        kind = kind if link.columns else "fixed"
        inertia = " ".join(f'i{axes}="{body.inertia!r}"' for axes in ("xx", "yy", "zz"))
        limit = '<limit lower="1" upper="-1" effort="0" velocity="0"/>' if kind == "prismatic" else ""  # no limit
        return (
            f'<link name="body {link.body}"><inertial><origin xyz="{-link.anchor[0]!r} {-link.anchor[1]!r} 0"/>'
            f'<mass value="{body.mass!r}"/><inertia {inertia} ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="joint {link.body}" type="{kind}"><parent link="{parent}"/><child link="body {link.body}"/>'
            f'<origin xyz="{float(x)!r} {float(y)!r} 0"/><axis xyz="{" ".join(map(repr, axis))}"/>{limit}</joint>'
        )

    def _close(self, loop: Any) -> None:
        numbers: dict[int | None, int] = {None: -1}
        numbers |= {link.body: index for link, index in zip(self.tree.links, self.links, strict=True)}
        ends = [(numbers[body], [*offset, 0.0]) for body, offset in world_ends(self.mechanism, loop)]
        ends.sort(key=lambda end: end[0] < 0)  # the engine accepts the ground only as the second body
        (first, first_point), (second, second_point) = ends
        kind = getattr(self.bullet, BULLET_JOINTS[type(loop)])
        self._constrain(first, second, kind, first_point, second_point)

    def _constrain(
        self, first: int, second: int, kind: int, first_point: Any, second_point: Any, **settings: float
    ) -> None:
        other, axis = self.body if second >= 0 else -1, [0, 0, 1]
        number = self._call("createConstraint", self.body, first, other, second, kind, axis, first_point, second_point)
        self._call("changeConstraint", number, maxForce=MAX_FORCE, **settings)

    def _push(self) -> None:
        _, forces = pushes(self.tree, *map(np.array, self._state()))
        for link, index in zip(self.tree.links, self.links, strict=True):
            x, y, torque = forces[link.body]
            centre = self._call("getLinkState", self.body, index, computeForwardKinematics=True)[0]
            self._call("applyExternalForce", self.body, index, [x, y, 0.0], centre, self.bullet.WORLD_FRAME)
            self._call("applyExternalTorque", self.body, index, [0.0, 0.0, torque], self.bullet.WORLD_FRAME)

    def _state(self) -> tuple[list[float], list[float]]:
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
        warnings = inertia_warnings(self.tree, self.motors)
        return Recorded(*motion, stepping, mechanism.inertias, np.array(mechanism.gravity), warnings)


DEFAULT = Bullet("default")
TUNED = Bullet("tuned", iterations=200, residual=0.0, erp=1.0)
# With erp = 1 a step closes the whole gap. With a smaller erp, the remaining gap is no power series in the step.
EXTENDED = Extrapolated(TUNED, "extended", levels=(1, 2, 3, 4), powers=(1, 2, 3))
VARIANTS = (DEFAULT, TUNED, EXTENDED)
