"""Newton under test with its solvers Kamino and XPBD, in single precision on a processor or a GPU.

Bodies are free and all joints are constraints. A Pin is a revolute joint about z, and a Weld is a fixed joint. A joint
outside the articulations closes a loop, as in Newton's examples. Our code computes force elements before every step and
passes them as forces on bodies. Accelerations are changes of velocity over the last step.

The following errors are those of the four-bar in README at 1 ms. *default* is Kamino as shipped, with the backend PADMM
and `alpha` 0.01. A step closes 1 % of a gap, and the error is 0.074 rad. *tuned* is Kamino with the backend LOX, which
Newton calls experimental. LOX has an error of 5.7e-3 rad, which falls with the step, and takes a tenth of the time.
*whole gap* is PADMM with `alpha` 1, and its error is 7.1e-3 rad. *xpbd* is XPBD as shipped, with 2 iterations and an
error of 0.73 rad. With 200 iterations and a quarter of the step, its error is 0.50 rad. With larger relaxations the
loop opens.

If a model has no contacts, Kamino allocates matrices for 1000 contacts, and a step takes 50 ms. Our adapter sets the
model's `rigid_contact_max` to 1. The adapter captures a step as a graph (`warp.ScopedCapture`), as Newton's examples do
on a GPU.

The adapter refuses Newton's other solvers. `SolverMuJoCo` is MuJoCo Warp, which is a separate engine here.
`SolverFeatherstone` ignores a joint that closes a loop without a message. The adapter also refuses two joints between
the same two bodies, since Newton warns that their meaning is undefined.

Warp compiles and stores kernels at their first use, which takes one or two minutes on a new computer.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability, Lack
from engines.contract import SINGLE_PRECISION, ConvergenceOrder, Enforcement, NotDeclared, Size, Unsupported
from engines.device import chosen_device
from engines.motions import FORCES_COST, over_three
from engines.mujoco_warp import load_warp
from engines.sampling import sampled_with_differences, unwrapped
from engines.single_run import ExtraEngine, Recorded, quiet
from engines.tree import with_parents
from reference.checks import Count, Fraction, Name, validated
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Array = NDArray[np.float64]
# CPU time [s] of a step of three bodies, by solver and backend.
NEWTON_STEP_COSTS = {"padmm": 1.5e-3, "dvi": 0.2e-3, "lox": 0.16e-3, "xpbd": 5e-6}


@dataclass(frozen=True)
class Newton(ExtraEngine):
    """backend: backend of Kamino.
    alpha: fraction of a gap that a step of Kamino closes; LOX does not use `alpha`.
    iterations: number of iterations of XPBD.
    """

    name = "newton"
    packages = ("newton", "warp-lang")
    modules: ClassVar[tuple[str, ...]] = ("warp", "newton")
    build_time: ClassVar[float] = 5.0
    precision: ClassVar[float] = SINGLE_PRECISION
    forces_by: ClassVar[Enforcement] = "ours"
    capability: ClassVar[Capability] = Capability(
        "newton",
        (Pin, Weld),
        lacks={
            Slot: Lack("our adapter of newton builds no joint that slides and turns"),
            Drive: Lack("our adapter of newton builds no motor"),
            Rod: Lack("our adapter of newton builds no distance between points"),
            Gear: Lack("our adapter of newton builds no gear"),
            Skate: Lack("newton stops slip by friction at a contact, and our adapter builds no contact"),
            Roll: Lack("in newton a disc rolls by contact and friction, and our adapter builds no contact"),
        },
    )

    variant: Name
    solver: Literal["kamino", "xpbd"] = "kamino"
    backend: Literal["padmm", "dvi", "lox"] = "padmm"
    alpha: Fraction = 0.01
    iterations: Count = 2

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return NotDeclared("newton closes gaps by fractions and residuals, in single precision")

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        step = NEWTON_STEP_COSTS[self.backend if self.solver == "kamino" else "xpbd"]
        return step * over_three(mechanism) + (FORCES_COST if mechanism.forces else 0.0)

    def model(self, mechanism: Mechanism, dt: float) -> NewtonModel:
        pairs = [{joint.first, joint.second} for joint in mechanism.joints]
        for joint, pair in zip(mechanism.joints, pairs, strict=True):
            if pairs.count(pair) > 1:
                raise Unsupported(f"joint {joint.name!r}: newton defines no second joint between the same two bodies")
        return NewtonModel(self, mechanism, dt)


@cache
def load_newton(device: str) -> tuple[Any, Any]:
    """Import warp and newton; raises Unsupported if Warp finds no such device."""
    warp = load_warp(device)
    with quiet():
        import newton

    return warp, newton


class NewtonModel:
    """A mechanism as a model of Newton. Two captured steps exchange the two states in turn."""

    def __init__(self, engine: Newton, mechanism: Mechanism, dt: float) -> None:
        self.engine, self.mechanism, self.dt, self.device = engine, mechanism, dt, chosen_device()
        self.warp, self.newton = load_newton(self.device)
        with quiet(), self.warp.ScopedDevice(self.device):
            self.model = self._finalized([self.builder()])
            self.solver, self.control = self._solver(), self.model.control()
        bodies = len(mechanism.bodies)
        rows = sum(5 if isinstance(joint, Pin) else 6 for joint in mechanism.joints)
        self.size = Size(bodies, 3 * bodies, mechanism.row_count, rows)

    def _transform(self, x: float, y: float, angle: float = 0.0) -> Any:
        warp = self.warp
        return warp.transform(warp.vec3(x, y, 0.0), warp.quat_from_axis_angle(warp.vec3(0.0, 0.0, 1.0), angle))

    def _finalized(self, builders: Sequence[Any]) -> Any:
        whole = builders[0]
        if len(builders) > 1:
            whole = self._new_builder()
            for builder in builders:
                whole.add_world(builder)
        model = whole.finalize(device=self.device)
        model.rigid_contact_max = len(builders)  # one for each world; with None, Kamino allocates 1000
        return model

    def _new_builder(self) -> Any:
        gravity = (*self.mechanism.gravity, 0.0)
        builder = self.newton.ModelBuilder(up_axis=self.newton.Axis.Y, gravity=gravity)
        if self.engine.solver == "kamino":
            self.newton.solvers.SolverKamino.register_custom_attributes(builder)
        return builder

    def builder(self) -> Any:
        builder = self._new_builder()
        for body in self.mechanism.bodies:
            inertia = [value for row in np.diag([body.inertia] * 3).tolist() for value in row]
            x, y, angle = map(float, body.pose)
            frame = self._transform(x, y, angle)
            builder.add_link(xform=frame, mass=float(body.mass), inertia=self.warp.mat33(*inertia))
        self._add_joints(builder)
        return builder

    def _add_joints(self, builder: Any) -> None:
        joints = [joint for joint in self.mechanism.joints if isinstance(joint, Pin | Weld)]
        trees: list[list[tuple[str, str | None, Pin | Weld | None]]] = []
        of_body: dict[str, list[tuple[str, str | None, Pin | Weld | None]]] = {}
        for child, parent, joint in with_parents(self.mechanism, joints):
            if parent is None:
                trees.append([])
            of_body[child] = trees[-1] if parent is None else of_body[parent]
            of_body[child].append((child, parent, joint))
        for tree in trees:  # an articulation needs consecutive numbers of joints
            numbers = []
            for child, parent, joint in tree:
                if joint is None:
                    numbers.append(builder.add_joint_free(child=self.mechanism.body_index(child)))
                else:
                    numbers.append(self._add_joint(builder, joint, parent))
                    joints.remove(joint)
            builder.add_articulation(numbers)
        for joint in joints:
            self._add_joint(builder, joint, joint.first)

    def _add_joint(self, builder: Any, joint: Pin | Weld, parent: str | None) -> int:
        """Add a joint to its parent, which is the ground if the joint connects to the ground."""
        ends = [*joint.points]
        if joint.second is None or (joint.first is not None and joint.first != parent):
            ends.reverse()
        places: list[tuple[int, tuple[float, float], float]] = []
        for name, point in ends:
            body = -1 if name is None else self.mechanism.body_index(name)
            places.append((body, point, 0.0 if body < 0 else float(self.mechanism.pose[body, 2])))
        (first, point, angle), (second, other_point, other_angle) = places
        # The two frames of a fixed joint must coincide, so the parent's frame has the angle between the bodies.
        turned = other_angle - angle if isinstance(joint, Weld) else 0.0
        frames = {"parent_xform": self._transform(*point, turned), "child_xform": self._transform(*other_point)}
        if isinstance(joint, Weld):
            return builder.add_joint_fixed(first, second, **frames)
        return builder.add_joint_revolute(first, second, axis=self.warp.vec3(0.0, 0.0, 1.0), **frames)

    def _solver(self) -> Any:
        solvers = self.newton.solvers
        if self.engine.solver == "xpbd":
            return solvers.SolverXPBD(self.model, iterations=self.engine.iterations)
        config = solvers.SolverKamino.Config(dynamics_solver=self.engine.backend)
        if self.engine.backend != "lox":
            config.constraints.alpha = self.engine.alpha
        return solvers.SolverKamino(self.model, config=config)

    def _start(self) -> Any:
        state = self.model.state()
        twist = np.zeros((len(self.mechanism.bodies), 6), dtype=np.float32)
        twist[:, [0, 1, 5]] = self.mechanism.twist
        state.body_qd.assign(twist)
        return state

    def record(self, samples: int, every: int) -> Recorded:
        with quiet(), self.warp.ScopedDevice(self.device):
            return self._record(samples, every)

    def _record(self, samples: int, every: int) -> Recorded:
        warp, states, last = self.warp, [self._start(), self._start()], self.mechanism.pose[:, 2].copy()
        self.solver.step(self._start(), self._start(), self.control, None, self.dt)  # compiles or loads the kernels.
        self.solver = self._solver()  # the new solver has no forces of that step.
        graphs = []
        for now, then in ((states[0], states[1]), (states[1], states[0])):
            with warp.ScopedCapture() as capture:
                self.solver.step(now, then, self.control, None, self.dt)
            graphs.append(capture.graph)

        def advance(count: int) -> None:
            for _ in range(count):
                if self.mechanism.forces:
                    pose, twist = self._state(states[0])
                    last[:] = pose[:, 2] + 2 * np.pi * np.round((last - pose[:, 2]) / (2 * np.pi))
                    pose[:, 2] = last  # a torsion spring needs unwrapped angles
                    states[0].body_f.assign(self._forces(pose, twist))
                warp.capture_launch(graphs[0])
                states.reverse()
                graphs.reverse()

        *recorded, stepping = sampled_with_differences(
            (samples, every), self.dt, advance, lambda: self._state(states[0]), lambda: self._state(states[0])[1]
        )
        pose, twist, acceleration = recorded
        pose[..., 2] = unwrapped(pose[..., 2], twist[..., 2], self.mechanism.pose[:, 2], every * self.dt)
        mass, inertia = self.model.body_mass.numpy(), self.model.body_inertia.numpy()[:, 2, 2]
        inertias = np.stack([mass, mass, inertia], axis=-1).astype(float)
        gravity = np.array(self.model.gravity.numpy()).reshape(-1)[:2].astype(float)
        return Recorded(pose, twist, acceleration, stepping, inertias, gravity)

    def _state(self, state: Any) -> tuple[Array, Array]:
        place, twist = state.body_q.numpy().astype(float), state.body_qd.numpy().astype(float)
        angle = 2 * np.arctan2(place[:, 5], place[:, 6])
        return np.column_stack([place[:, :2], angle]), twist[:, [0, 1, 5]]

    def _forces(self, pose: Array, twist: Array) -> NDArray[np.float32]:
        pushed = np.zeros((len(pose), 6), dtype=np.float32)
        pushed[:, [0, 1, 5]] = self.mechanism.applied.on(pose, twist)
        return pushed


def run_worlds(engine: Newton, mechanisms: Sequence[Mechanism], dt: float, steps: int) -> tuple[Array, float]:
    """The same as `engines.mujoco_warp.run_worlds`, for mechanisms at rest at t = 0 and an even number of steps."""
    models = [NewtonModel(engine, mechanism, dt) for mechanism in mechanisms]
    first = models[0]
    warp = first.warp
    with quiet(), warp.ScopedDevice(first.device):
        first.model = first._finalized([model.builder() for model in models])
        solver = first._solver()
        now, then, control = first.model.state(), first.model.state(), first.model.control()
        solver.step(first.model.state(), first.model.state(), control, None, dt)  # compiles or loads the kernels
        solver = first._solver()
        with warp.ScopedCapture() as capture:
            solver.step(now, then, control, None, dt)
            solver.step(then, now, control, None, dt)
        begin = time.perf_counter()
        for _ in range(steps // 2):
            warp.capture_launch(capture.graph)
        warp.synchronize()
        elapsed = time.perf_counter() - begin
        pose = first._state(now)[0]
    return pose.reshape(len(models), -1, 3), elapsed


DEFAULT = Newton("default")
TUNED = Newton("tuned", backend="lox")
WHOLE_GAP = Newton("whole gap", alpha=1.0)
XPBD = Newton("xpbd", "xpbd")
VARIANTS = (DEFAULT, TUNED, WHOLE_GAP, XPBD)
