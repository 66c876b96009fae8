"""Two faults against the laws that explain them: pymunk's GrooveJoint, and equality constraints of MuJoCo.

A groove: at the pose after the step's drift (pymunk moves first and solves then), with K = J M^-1 J^T (2, 2) of the two
anchors held together, n the groove's normal and v the anchors' relative velocity: an ideal groove adds the impulse
-n (n.v) / (n.K n), so that n.v becomes zero; cpGrooveJoint adds -n (n.K^-1 v), so that (K^-1 n).v becomes zero.

An equality: a constraint g(q) = 0 that is kept asks for J a + J-dot v = 0. MuJoCo solves
(J M^-1 J^T + R) f = -J a_free - J-dot v for the forces, with the softness R that it declares (`efc_R`), where the
constraint and its rate are zero. M, a_free and R are read from the engine, so that the only difference left is the
velocity term, which is computed here: it is the second derivative of g along q + t v, by Cauchy's integral in the
complex plane.
"""
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.numerics.calculus import derivative
from reports.model.tasks import Task, Values

Array = NDArray[np.float64]
Gap = Callable[[Any], Any]  # q (dofs,) -> g (rows,), analytic

KINDS = ("joint, straight", "joint, curved", "tendon", "connect")
NEAR = 0.1  # radius of the circle [1], well within the nearest root of a length

ARMS = """
<mujoco>
  <option gravity="0 -9.81 0" jacobian="dense" tolerance="0" iterations="100"><flag contact="disable"/></option>
  <worldbody>
    <site name="wall" pos="{x} {y} 0"/>
    <body name="first"><joint name="one" axis="0 0 1"/><geom type="capsule" fromto="0 0 0 {a} 0 0" size="0.05"/>
      <body name="second" pos="{a} 0 0"><joint name="two" axis="0 0 1"/>
        <geom type="capsule" fromto="0 0 0 {b} 0 0" size="0.05"/>
        <body name="third" pos="{b} 0 0"><joint name="three" axis="0 0 1"/>
          <geom type="capsule" fromto="0 0 0 {c} 0 0" size="0.05"/><site name="tip" pos="{c} 0 0"/>
        </body>
      </body>
    </body>
  </worldbody>
  {tendon}
  <equality>{equality}</equality>
</mujoco>"""


@dataclass(frozen=True)
class Model:
    """Three arms in a row, with one equality that is kept, moving as it allows."""

    text: str
    pose: Array  # q (3,) [rad]
    motion: Array  # v (3,) [rad/s], before what the equality forbids is taken out of it
    gap: Gap


def _tip(q: Any, lengths: Array) -> tuple[Any, Any]:
    angles = np.cumsum(q)
    return np.sum(lengths * np.cos(angles)), np.sum(lengths * np.sin(angles))


def drawn_model(rng: np.random.Generator, kind: str) -> Model:
    """Lengths of half to two metres, any pose, rates of about a radian a second."""
    a, b, c = lengths = rng.uniform(0.5, 2, 3)
    x, y = rng.uniform(-3, 3, 2)
    pose, motion = rng.uniform(-np.pi, np.pi, 3), rng.normal(size=3)
    tendon = ""
    if kind.startswith("joint"):
        factors = rng.normal(size=5)
        if kind.endswith("straight"):
            factors[2:] = 0
        polynomial = np.polynomial.Polynomial(factors)
        pose[0] = rng.uniform(-1, 1)
        pose[2] = polynomial(pose[0])
        words = " ".join(repr(float(factor)) for factor in factors)
        equality = f'<joint joint1="three" joint2="one" polycoef="{words}"/>'

        def gap(q: Any) -> Any:
            return np.array([q[2] - sum(factor * q[0] ** k for k, factor in enumerate(factors))])
    elif kind == "tendon":
        tendon = '<tendon><spatial name="string"><site site="wall"/><site site="tip"/></spatial></tendon>'
        equality = '<tendon tendon1="string"/>'

        def gap(q: Any) -> Any:
            tip = _tip(q, lengths)
            return np.array([np.sqrt((tip[0] - x) ** 2 + (tip[1] - y) ** 2)])
    else:
        x, y = (float(value) for value in _tip(pose, lengths))
        equality = '<connect site1="tip" site2="wall"/>'

        def gap(q: Any) -> Any:
            tip = _tip(q, lengths)
            return np.array([tip[0] - x, tip[1] - y, 0 * tip[0]])

    text = ARMS.format(a=a, b=b, c=c, x=x, y=y, tendon=tendon, equality=equality)
    return Model(text, pose, motion, gap)


def accelerations(model: Model) -> tuple[Array, Array, Array, Array]:
    """q'' (3,) [rad/s^2] as MuJoCo has it, as it must be with its own softness, as it is without J-dot v; and as MuJoCo
    has it when a callback writes that term for it."""
    import mujoco

    built = mujoco.MjModel.from_xml_string(model.text)
    data = mujoco.MjData(built)
    data.qpos[:] = model.pose
    mujoco.mj_forward(built, data)
    if built.ntendon:
        built.tendon_length0[:] = data.ten_length  # the string is as long as it is now
        mujoco.mj_forward(built, data)
    rows = data.efc_J.reshape(-1, built.nv).copy()
    data.qvel[:] = model.motion - np.linalg.pinv(rows) @ (rows @ model.motion)
    mujoco.mj_forward(built, data)
    inertia = np.zeros((built.nv, built.nv))
    mujoco.mj_fullM(built, data, inertia)
    softness, free, speed = np.diag(data.efc_R), data.qacc_smooth.copy(), data.qvel.copy()
    bend = derivative(lambda t: model.gap(model.pose + t * speed), 0.0, 2, NEAR)
    weighted = np.linalg.solve(inertia, rows.T)

    def with_term(term: Array) -> Array:
        return free - weighted @ np.linalg.solve(rows @ weighted + softness, rows @ free + term)

    found = data.qacc.copy()

    def write(model: Any, data: Any) -> None:
        data.efc_aref[: len(bend)] -= bend

    mujoco.set_mjcb_control(write)
    try:
        mujoco.mj_forward(built, data)
    finally:
        mujoco.set_mjcb_control(None)
    return found, with_term(bend), with_term(np.zeros_like(bend)), data.qacc.copy()


@dataclass(frozen=True)
class Equalities(Task):
    """Random models with one kind of equality: how far the engine is from both formulas."""

    kind: str
    models: int = 120

    @property
    def cost(self) -> float:
        return 3e-3 * self.models  # measured

    @property
    def label(self) -> str:
        return f"equalities: {self.kind}"

    def run(self) -> Values:
        """Differences (models,), of the largest acceleration: `off` from the right formula, `missed` from the wrong
        one, and `mended` from the right one when a callback adds the term."""
        rng = np.random.default_rng(KINDS.index(self.kind))
        off, missed, mended = [], [], []
        for _ in range(self.models):
            found, right, wrong, helped = accelerations(drawn_model(rng, self.kind))
            size = max(np.abs(right).max(), np.abs(wrong).max())
            off.append(np.abs(found - right).max() / size)
            missed.append(np.abs(found - wrong).max() / size)
            mended.append(np.abs(helped - right).max() / size)
        return {"off": np.array(off), "missed": np.array(missed), "mended": np.array(mended)}


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


def drawn_setup(rng: np.random.Generator, case: str) -> Setup:
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
            setup = drawn_setup(rng, self.case)
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
