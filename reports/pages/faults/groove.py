"""pymunk's GrooveJoint against the projection that a groove asks for, and against the one that it makes.

At the pose after the step's drift (pymunk moves first and solves then), with K = J M^-1 J^T (2, 2) of the two anchors
held together, n the groove's normal and v the anchors' relative velocity: an ideal groove adds the impulse
-n (n.v) / (n.K n), so that n.v becomes zero; cpGrooveJoint adds -n (n.K^-1 v), so that (K^-1 n).v becomes zero.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reports.model.tasks import Task, Values

Array = NDArray[np.float64]

STEP = 1e-2  # s; any will do, since the formulas take the pose after the drift
# Where a groove is and where its anchor is, of which a user would think no difference.
CASES = ("ground, centre", "ground, off centre", "moving body, centre", "moving body, off centre")
WRONG = 1e-6  # of the velocities: far above rounding, far below any use


def right(stiff: Array, normal: Array, velocity: Array) -> float:
    """The impulse along n [N s] of an ideal groove."""
    return -float(normal @ velocity) / float(normal @ stiff @ normal)


def wrong(stiff: Array, normal: Array, velocity: Array) -> float:
    """The impulse along n [N s] that cpGrooveJoint gives: the normal part of what would stop both directions."""
    return -float(normal @ np.linalg.solve(stiff, velocity))


@dataclass(frozen=True)
class Setup:
    """Masses [kg], inertias [kg m^2], poses and twists (2 bodies, 3), the groove's line in the first body's frame.

    `fixed`: the first body is the ground.
    """

    mass: Array
    inertia: Array
    pose: Array
    twist: Array
    place: Array  # of a point of the groove [m]
    along: Array  # its direction, of length 1
    anchor: Array  # in the second body's frame [m]
    fixed: bool

    def measured(self) -> Array:
        """Twists (2, 3) after one step of pymunk, which closes no gap."""
        import pymunk
        from pymunk.constraints import GrooveJoint

        space = pymunk.Space()
        bodies = [pymunk.Body(mass, inertia) for mass, inertia in zip(self.mass, self.inertia, strict=True)]
        if self.fixed:
            bodies[0] = space.static_body
        for body, pose, twist in zip(bodies, self.pose.tolist(), self.twist.tolist(), strict=True):
            if body is not space.static_body:
                body.position, body.angle = (pose[0], pose[1]), pose[2]
                body.velocity, body.angular_velocity = (twist[0], twist[1]), twist[2]
        ends = [tuple((self.place + side * 100 * self.along).tolist()) for side in (-1, 1)]
        groove = GrooveJoint(bodies[0], bodies[1], ends[0], ends[1], tuple(self.anchor.tolist()))
        groove.error_bias = 1.0
        space.add(*(body for body in bodies if body is not space.static_body), groove)
        space.step(STEP)
        return np.array([[*body.velocity, body.angular_velocity] for body in bodies])

    def predicted(self, impulse: Callable[[Array, Array, Array], float]) -> Array:
        """Twists (2, 3) after a step with an impulse law."""
        pose = self.pose + STEP * self.twist
        turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in pose[:, 2]]
        along = turns[0] @ self.along
        normal = np.array([-along[1], along[0]])
        second = turns[1] @ self.anchor
        place = pose[0, :2] + turns[0] @ self.place
        meeting = place + along * (along @ (pose[1, :2] + second - place))
        rows = np.hstack([-_columns(meeting - pose[0, :2]), _columns(second)])  # (2, 6), of the relative velocity
        inverse = np.concatenate([[1 / m, 1 / m, 1 / i] for m, i in zip(self.mass, self.inertia, strict=True)])
        if self.fixed:
            inverse[:3] = 0
        stiff = (rows * inverse) @ rows.T
        before = self.twist.ravel()
        push = impulse(stiff, normal, rows @ before)
        return (before + inverse * (rows.T @ normal) * push).reshape(2, 3)


def _columns(arm: Array) -> Array:
    """The velocity of a point at an arm [m] by its body's twist (2, 3)."""
    return np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]])


def drawn(rng: np.random.Generator, case: str) -> Setup:
    """A groove that is kept by the positions and by the velocities, or nearly: any will do for a projection."""
    fixed, centred = case.startswith("ground"), case.endswith(" centre") and "off" not in case
    turn = rng.uniform(-np.pi, np.pi)
    pose, twist = rng.normal(size=(2, 3)), rng.normal(size=(2, 3))
    if fixed:
        pose[0], twist[0] = 0, 0
    anchor = np.zeros(2) if centred else rng.normal(size=2)
    along = np.array([np.cos(turn), np.sin(turn)])
    own = np.array([[np.cos(pose[0, 2]), np.sin(pose[0, 2])], [-np.sin(pose[0, 2]), np.cos(pose[0, 2])]])
    other = np.array([[np.cos(pose[1, 2]), -np.sin(pose[1, 2])], [np.sin(pose[1, 2]), np.cos(pose[1, 2])]])
    place = own @ (pose[1, :2] + other @ anchor - pose[0, :2])
    return Setup(10 ** rng.uniform(-1, 1, 2), 10 ** rng.uniform(-1, 1, 2), pose, twist, place, along, anchor, fixed)


def beside(offset: float) -> Setup:
    """The script's body, its anchor at `offset` [m] from the centre of mass, half along and half across the groove."""
    anchor = np.full(2, offset / np.sqrt(2))
    pose, twist = np.zeros((2, 3)), np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    return Setup(np.ones(2), np.ones(2), pose, twist, np.array([0.0, anchor[1]]), np.array([1.0, 0.0]), anchor, True)


def across(setup: Setup, twist: Array) -> float:
    """The anchor's velocity across a groove along x in the ground [m/s]."""
    return float(twist[1, 1] + twist[1, 2] * setup.anchor[0])


@dataclass(frozen=True)
class Grooves(Task):
    """Random grooves of one case: how many are wrong, by how much, and whether the wrong formula says the same."""

    case: str
    models: int = 100

    @property
    def cost(self) -> float:
        return 2e-4 * self.models  # measured

    @property
    def label(self) -> str:
        return f"grooves: {self.case}"

    def run(self) -> Values:
        """`off` (models,), of the largest velocity; `missed`, the largest difference from the wrong formula."""
        rng = np.random.default_rng(CASES.index(self.case))
        off, missed = [], []
        for _ in range(self.models):
            setup = drawn(rng, self.case)
            found, size = setup.measured(), np.abs(setup.twist).max()
            off.append(np.abs(found - setup.predicted(right)).max() / size)
            missed.append(np.abs(found - setup.predicted(wrong)).max() / size)
        return {"off": np.array(off), "missed": np.asarray(max(missed))}


@dataclass(frozen=True)
class Offsets(Task):
    """The velocity across the groove that the joint makes, with the anchor at several offsets."""

    offsets: tuple[float, ...]

    @property
    def cost(self) -> float:
        return 2e-4 * len(self.offsets)

    @property
    def label(self) -> str:
        return "grooves: anchor's offset"

    def run(self) -> Values:
        """`across` (offsets,) [m/s]."""
        setups = [beside(offset) for offset in self.offsets]
        return {"across": np.array([across(setup, setup.measured()) for setup in setups])}
