"""Drake under test: a MultibodyPlant has a tree in reduced coordinates, and the solver SAP closes loops.

`engines.tree` makes the tree. In the tree a Pin is a revolute joint about z, a Weld is a weld joint, and a free body
has a planar joint. A Slot is a prismatic joint. If the body in the slot turns, a body of zero mass and a revolute joint
follow. A Pin that closes a loop is a ball constraint, and a Weld that closes a loop is a weld constraint. A Rod is a
distance constraint, and a Gear is a coupler constraint between two revolute joints. A Drive is an actuator with
`PdControllerGains`, which SAP treats implicitly. Our code computes the force elements and passes them as external
spatial forces.

*default* is a plant in discrete time with the solver SAP (Castro, Permenter and Han, "An Unconstrained Convex
Formulation of Compliant Contact", 2022). SAP integrates by semi-implicit Euler. SAP regularises a constraint
(`sap_holonomic_constraint.cc`): a step closes half of a gap, and the compliance is (0.1 / 2 pi)^2 of the row's inverse
inertia. So gaps are of second order in the step, and the integrator determines the error of the angles. The source code
fixes the factor 0.1. The settings for contacts, `set_sap_near_rigid_threshold` and the contact approximation, have no
effect on these mechanisms. *extended* extrapolates runs of *default*.

*tuned* is a plant in continuous time with Drake's integrator `runge_kutta5` in fixed-step mode. A plant in continuous
time has no constraints and no PD gains, so the adapter refuses mechanisms with a loop, a gear or a drive.

*cenic* is a plant in continuous time with Drake's CenicIntegrator in fixed-step mode, which is of first order too.
For CENIC, Drake 1.51 accepts weld and coupler constraints, and Drake 1.58 also accepts ball constraints. A step of the
free four-bar then takes 7 us instead of 50 us, and the error is nearly that of SAP. The adapter keeps forces constant
during a step, since CENIC would differentiate them with an increment that depends on the unit. The adapter passes on
Drake's refusal of a constraint. The adapter also refuses drives, since CENIC turns joints against the desired rate
(1.51 and 1.58), and bodies of zero mass in slots, since CENIC then returns NaN.

A constraint with the world's body ends the process by a segmentation fault (1.51 and 1.58). Therefore the ground is a
body that is welded to the world.

The plant computes the accelerations of *tuned*. In the other variants accelerations are changes of velocity over the
last step and unknown at t = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability, Lack
from engines.contract import EXACT, ConvergenceOrder, Enforcement, NotDeclared, Size, Unsupported
from engines.extrapolated import Extrapolated
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.sampling import sampled, sampled_with_differences
from engines.single_run import ExtraEngine, Recorded
from engines.tree import TREE_FORCES_COST, Link, Tree, pushes, spanning_tree, world_ends
from reference.checks import Name, Positive, validated
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

Array = NDArray[np.float64]
Scheme = Literal["discrete", "runge_kutta5", "cenic"]
# CPU time [s] of a step of three bodies, and number of evaluations of the force elements in a step, by scheme.
DRAKE_STEP_COSTS = {"discrete": (50e-6, 1), "runge_kutta5": (25e-6, 6), "cenic": (10e-6, 1)}
# Rate gain of a drive, relative to the largest inertia divided by the step. The gain is far above SAP's near-rigid
# limit. Drake refuses an angle gain of zero, so ANGLE_GAIN is so small that it has no effect.
STIFF_RATE = 1e12
ANGLE_GAIN = 1e-200
# Limit of the integrator's step relative to dt. A continuous plant then takes exactly one step per dt.
STEP_LIMIT = 1.5


@dataclass(frozen=True)
class Drake(ExtraEngine):
    """scheme: "discrete" (SAP), or the integrator of a plant in continuous time."""

    name = "drake"
    packages = ("drake",)
    modules: ClassVar[tuple[str, ...]] = ("pydrake",)
    forces_by: ClassVar[Enforcement] = "ours"
    capability: ClassVar[Capability] = Capability(
        "drake",
        (Pin, Slot, Drive, Rod, Gear, Weld),
        lacks={
            Skate: Lack("drake stops slip by friction at a contact, and our adapter builds no contact"),
            Roll: Lack("in drake a body rolls by contact and friction, and our adapter builds no contact"),
        },
        lacks_in_loops={Slot: Lack("our adapter of drake builds no slot that closes a loop")},
    )

    variant: Name
    scheme: Scheme = "discrete"

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The order of the integrator; joints of the tree are exact, and gaps of constraints have order 2."""
        tree = spanning_tree(mechanism)
        differences = 0 if self.scheme == "runge_kutta5" else 1
        if tree.closed and is_prescribed(mechanism):
            return ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1, differences=differences)
        if tree.closed:
            return ConvergenceOrder(1, gap=2, differences=differences)
        if turns_steadily(mechanism):
            return ConvergenceOrder(EXACT, reaction=1 if differences else None, differences=differences)
        return ConvergenceOrder(1 if differences else 5, gap=EXACT, slip=EXACT, differences=differences)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        step, evaluations = DRAKE_STEP_COSTS[self.scheme]
        return step * over_three(mechanism) + (evaluations * TREE_FORCES_COST if mechanism.forces else 0.0)

    def model(self, mechanism: Mechanism, dt: Positive) -> DrakePlant:
        tree = spanning_tree(mechanism)
        if self.scheme != "discrete":
            refuse_in_continuous_time(tree, self.scheme)
        return DrakePlant(tree, dt, self.scheme)


def constraints_of(tree: Tree) -> list[Joint]:
    return [*tree.loops, *(joint for joint in tree.mechanism.joints if isinstance(joint, Rod | Gear))]


def refuse_in_continuous_time(tree: Tree, scheme: Scheme) -> None:
    """Raise Unsupported for elements that Drake's integrators do not accept or compute wrongly."""
    for joint in (*constraints_of(tree), *tree.drives) if scheme == "runge_kutta5" else ():
        raise Unsupported(
            f"joint {joint.name!r}: a plant of drake in continuous time has no constraints and no PD gains"
        )
    for drive in tree.drives:
        raise Unsupported(f"drive {drive.name!r}: CENIC turns a joint with PD gains against the desired rate")
    for link in tree.links if scheme == "cenic" else ():
        if link.kind == "slot" and link.turns:
            name = tree.mechanism.bodies[link.body].name
            raise Unsupported(f"body {name!r}: it slides and turns, and CENIC has no numbers for a body of zero mass")


class DrakePlant:
    def __init__(self, tree: Tree, dt: float, scheme: Scheme) -> None:
        import pydrake.all

        self.drake, self.tree, self.mechanism, self.dt, self.scheme = pydrake.all, tree, tree.mechanism, dt, scheme
        self.plant = self.drake.MultibodyPlant(dt if scheme == "discrete" else 0.0)
        self.plant.set_name("plant")  # CENIC finds the plant by this name
        self.plant.mutable_gravity_field().set_gravity_vector([*self.mechanism.gravity, 0.0])
        self.bodies: dict[int | None, Any] = {None: self._add_body("ground", 1.0, 1.0)}
        self.plant.AddJoint(self._weld("ground", self.plant.world_frame(), self.bodies[None].body_frame()))
        self.joints: list[tuple[Any, range]] = []  # joints of Drake and their tree coordinates
        for link in tree.links:
            self._add(link)
        for joint in constraints_of(tree):
            self._constrain(joint)
        rates = [self._actuate(drive) for drive in tree.drives]
        self.plant.Finalize()
        self.address = np.empty(tree.coordinates, dtype=int)  # index in Drake's velocities by tree coordinate
        for joint, columns in self.joints:
            self.address[list(columns)] = joint.velocity_start() + np.arange(len(columns))
        self._simulate()
        velocity = np.zeros(self.plant.num_velocities())
        velocity[self.address] = tree.start_rates()
        self.plant.SetVelocities(self.context, velocity)  # positions are zero at t = 0
        if rates:
            port = self.plant.get_desired_state_input_port(self.drake.default_model_instance())
            port.FixValue(self.context, np.array([0.0] * len(rates) + rates))
        self.steps, self.warnings = 0, ()
        rows = sum(joint.size for joint in self.mechanism.joints if tree.closes_by(joint))
        self.size = Size(len(self.mechanism.bodies), tree.coordinates, rows, rows + len(tree.loops))

    def _simulate(self) -> None:
        drake, builder = self.drake, self.drake.DiagramBuilder()
        if self.scheme == "cenic":  # Drake 1.51 requires a scene graph
            drake.AddMultibodyPlantSceneGraph(builder, self.plant)
        else:
            builder.AddSystem(self.plant)
        if self.mechanism.forces and self.scheme != "cenic":
            forces = builder.AddSystem(_force_elements(self))
            builder.Connect(self.plant.get_state_output_port(), forces.get_input_port())
            builder.Connect(forces.get_output_port(), self.plant.get_applied_spatial_force_input_port())
        diagram = builder.Build()
        self.simulator = drake.Simulator(diagram, diagram.CreateDefaultContext())
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        if self.scheme != "discrete":
            integrator = drake.ResetIntegratorFromFlags(self.simulator, self.scheme, STEP_LIMIT * self.dt)
            integrator.set_fixed_step_mode(True)
            if self.scheme == "cenic":
                parameters = integrator.get_solver_parameters()
                parameters.min_tolerance = parameters.linesearch_tolerance = 1e-14
                integrator.SetSolverParameters(parameters)
        try:
            self.simulator.Initialize()
        except RuntimeError as reason:
            names = ", ".join(f"joint {joint.name!r}" for joint in constraints_of(self.tree))
            raise Unsupported(f"{names}: {' '.join(str(reason).split())}") from None

    def _frame(self, body: Any, at: Sequence[float]) -> Any:
        name = f"frame {self.plant.num_frames()}"
        offset = self.drake.RigidTransform([float(at[0]), float(at[1]), 0.0])
        return self.plant.AddFrame(self.drake.FixedOffsetFrame(name, body, offset))

    def _add(self, link: Link) -> None:
        drake, name, described = self.drake, f"body {link.body}", self.mechanism.bodies[link.body]
        body = self.bodies[link.body] = self._add_body(name, described.mass, described.inertia)
        parent = self._frame(self.bodies[link.parent], described.pose if link.kind == "free" else link.arm)
        child = self._frame(body, link.anchor)
        if link.kind == "free":
            self._join(drake.PlanarJoint(name, parent, child, np.zeros(3)), link.columns)
            return
        if link.kind == "slot":
            between = child
            if link.turns:
                carriage = self.plant.AddRigidBody(f"carriage {link.body}", drake.SpatialInertia.Zero())
                between = carriage.body_frame()
            direction = np.array([*link.direction, 0.0])
            self._join(drake.PrismaticJoint(f"{name} slides", parent, between, direction), link.columns[:1])
            parent = between
        if link.turns:
            self._join(drake.RevoluteJoint(name, parent, child, [0.0, 0.0, 1.0]), link.columns[-1:])
        elif link.kind == "hinge":
            self.plant.AddJoint(self._weld(name, parent, child))

    def _add_body(self, name: str, mass: float, inertia: float) -> Any:
        square = inertia / mass  # the motion is planar, so the other axes have no effect
        unit = self.drake.UnitInertia(square, square, square)
        return self.plant.AddRigidBody(name, self.drake.SpatialInertia(mass, np.zeros(3), unit))

    def _weld(self, name: str, parent: Any, child: Any) -> Any:
        return self.drake.WeldJoint(name, parent, child, self.drake.RigidTransform())

    def _join(self, joint: Any, columns: range) -> None:
        self.joints.append((self.plant.AddJoint(joint), columns))

    def _revolute(self, element: Joint, first: str | None, second: str | None) -> tuple[Any, float]:
        """The revolute joint whose angle, times the sign, turns the second body relative to the first."""
        ((column, sign), *others) = self.tree.turning(first, second).items() or ((None, 0.0),)
        for joint, columns in self.joints:
            if not others and len(columns) == 1 and columns[0] == column:
                return joint, sign
        raise Unsupported(f"joint {element.name!r}: its angle is not that of a single revolute joint of drake's tree")

    def _constrain(self, joint: Any) -> None:
        if isinstance(joint, Gear):
            (second, sign), (first, other) = (self._revolute(joint, None, name) for name in (joint.second, joint.first))
            self.plant.AddCouplerConstraint(second, first, joint.ratio * other / sign)
            return
        ends = [(self.bodies[body], [*offset, 0.0]) for body, offset in world_ends(self.mechanism, joint)]
        if isinstance(joint, Rod):
            self.plant.AddDistanceConstraint(*ends[0], *ends[1], joint.length)
        elif isinstance(joint, Weld):
            framed = [(body, self.drake.RigidTransform(point)) for body, point in ends]
            self.plant.AddWeldConstraint(*framed[0], *framed[1])
        else:
            self.plant.AddBallConstraint(*ends[0], *ends[1])

    def _actuate(self, drive: Drive) -> float:
        """Add the actuator of a drive and return its rate [rad/s], with the sign of its joint."""
        joint, sign = self._revolute(drive, drive.first, drive.second)
        actuator = self.plant.AddJointActuator(f"drive {drive.name}", joint)
        largest = float((self.mechanism.inertias[:, 0] * self.mechanism.length_scale**2).max())
        gain = STIFF_RATE * max(largest, float(self.mechanism.inertias[:, 2].max())) / self.dt
        actuator.set_controller_gains(self.drake.PdControllerGains(p=ANGLE_GAIN, d=gain))
        return sign * drive.turning_rate

    def _state(self) -> tuple[Array, Array]:
        return self.plant.GetPositions(self.context)[self.address], self._velocity()

    def _velocity(self) -> Array:
        return self.plant.GetVelocities(self.context)[self.address]

    def forces(self, position: Array, velocity: Array) -> list[Any]:
        _, pushed = pushes(self.tree, position[self.address], velocity[self.address])
        applied = []
        for index, (x, y, torque) in enumerate(pushed.tolist()):
            force = self.drake.ExternallyAppliedSpatialForce()
            force.body_index = self.bodies[index].index()
            force.F_Bq_W = self.drake.SpatialForce(tau=[0.0, 0.0, torque], f=[x, y, 0.0])
            applied.append(force)
        return applied

    def _step(self) -> None:
        self.steps += 1
        if self.scheme == "discrete":
            self.plant.ExecuteForcedEvents(self.context, publish=False)
            return
        if self.mechanism.forces and self.scheme == "cenic":
            state = self.plant.GetPositions(self.context), self.plant.GetVelocities(self.context)
            self.plant.get_applied_spatial_force_input_port().FixValue(self.context, self.forces(*state))
        self.simulator.AdvanceTo(self.steps * self.dt)

    def _advance(self, count: int) -> bool:
        try:
            for _ in range(count):
                self._step()
        except RuntimeError as reason:
            self.warnings = (RunWarning(f"drake: {str(reason).splitlines()[0].partition('. ')[0]}", "lost"),)
            return True
        return False

    def _state_and_acceleration(self) -> tuple[Array, Array, Array]:
        acceleration = self.plant.get_generalized_acceleration_output_port().Eval(self.context)
        return *self._state(), acceleration[self.address]

    def record(self, samples: int, every: int) -> Recorded:
        if self.scheme == "runge_kutta5":
            recorded: list[tuple[Array, Array, Array]] = []
            stepping = sampled(
                [every] * samples, self._advance, lambda _: recorded.append(self._state_and_acceleration())
            )
            states = [np.array(values) for values in zip(*recorded, strict=True)]
        else:
            *states, stepping = sampled_with_differences(
                (samples, every), self.dt, self._advance, self._state, self._velocity
            )
        states = [np.pad(v, ((0, samples + 1 - len(v)), (0, 0)), constant_values=math.nan) for v in states]
        motion, gravity = self.tree.motion(*states), np.array(self.mechanism.gravity)
        return Recorded(*motion, stepping, self.mechanism.inertias, gravity, self.warnings)


def _force_elements(model: DrakePlant) -> Any:
    drake, plant = model.drake, model.plant

    class ForceElements(drake.LeafSystem):
        def __init__(self) -> None:
            super().__init__()
            self.DeclareVectorInputPort("state", plant.num_multibody_states())
            value = drake.Value([drake.ExternallyAppliedSpatialForce()])
            self.DeclareAbstractOutputPort("forces", value.Clone, self._compute)

        def _compute(self, context: Any, output: Any) -> None:
            output.set_value(model.forces(*np.split(self.get_input_port().Eval(context), [plant.num_positions()])))

    return ForceElements()


DEFAULT = Drake("default")
TUNED, CENIC = Drake("tuned", "runge_kutta5"), Drake("cenic", "cenic")
EXTENDED = Extrapolated(DEFAULT, "extended", levels=(1, 2, 3, 4), powers=(1, 2, 3))
VARIANTS = (DEFAULT, TUNED, CENIC, EXTENDED)
