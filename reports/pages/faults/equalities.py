"""MuJoCo's equality constraints at one instant against the same rows with and without the velocity term J-dot v.

A constraint g(q) = 0 that is kept asks for J a + J-dot v = 0. MuJoCo solves (J M^-1 J^T + R) f = -J a_free - J-dot v
for the forces, with the softness R that it declares (`efc_R`), where the constraint and its rate are zero. M, a_free
and R are read from the engine, so that the only difference left is the velocity term, which is computed here: it is
the second derivative of g along q + t v, by Cauchy's integral in the complex plane.
"""
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.numerics.calculus import derivative
from reports.grid.tasks import Task, Values

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


def drawn(rng: np.random.Generator, kind: str) -> Model:
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


def accelerations(model: Model) -> tuple[Array, Array, Array]:
    """q'' (3,) [rad/s^2] as MuJoCo has it, as it must be with its own softness, and as it is without J-dot v."""
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

    return data.qacc.copy(), with_term(bend), with_term(np.zeros_like(bend))


BEAD = """
<mujoco>
  <option gravity="0 0 0" integrator="RK4" timestep="{step}"/>
  <worldbody>
    <body>
      <joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/><geom size="0.1"/>
    </body>
  </worldbody>
  <equality><joint joint1="y" joint2="x" polycoef="0 0 1 0 0"/></equality>
</mujoco>"""


@dataclass(frozen=True)
class Bead(Task):
    """The bead on the wire y = x^2, from its lowest point at 1 m/s, with every setting as shipped but RK4."""

    step: float  # s

    @property
    def cost(self) -> float:
        return 5e-6 / self.step  # measured

    @property
    def label(self) -> str:
        return f"bead on a wire, {self.step:g} s"

    def run(self) -> Values:
        """`gap`: how far it is beside the wire after a second [m]."""
        import mujoco

        built = mujoco.MjModel.from_xml_string(BEAD.format(step=self.step))
        data = mujoco.MjData(built)
        data.qvel[0] = 1.0
        for _ in range(round(1 / self.step)):
            mujoco.mj_step(built, data)
        return {"gap": np.asarray(abs(data.qpos[1] - data.qpos[0] ** 2))}


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
        """`off` and `missed` (models,), of the largest acceleration: from the right formula, and from the wrong."""
        rng = np.random.default_rng(KINDS.index(self.kind))
        off, missed = [], []
        for _ in range(self.models):
            found, right, wrong = accelerations(drawn(rng, self.kind))
            size = max(np.abs(right).max(), np.abs(wrong).max())
            off.append(np.abs(found - right).max() / size)
            missed.append(np.abs(found - wrong).max() / size)
        return {"off": np.array(off), "missed": np.array(missed)}
