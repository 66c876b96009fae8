"""Exudyn under test: planar rigid bodies in maximal coordinates, joints as algebraic equations, implicit integrators.

A body is a NodeRigidBody2D with an ObjectRigidBody2D, a Pin an ObjectJointRevolute2D, a Slot an ObjectJointPrismatic2D
that leaves the rotation free, a Rod an ObjectConnectorDistance. An ObjectConnectorCoordinate couples two rotations: a
Drive at velocity level, a Gear, and, beside a revolute joint, a Weld. A Skate is the engine's rolling disc
(ObjectJointRollingDisc), of which only the velocity along the axle is held, as users build wheels with it; its disc
stands on edge in the plane, so the radius does not matter. A Roll of a circle on a straight line is the same joint
lying in the plane, with the rolling velocity and the velocity along the line's normal held; the engine has no contact
of other shapes that is an equation. Springs, dampers, forces and torques are the engine's own too.
`timeIntegration.adaptiveStep`, which halves a step in which Newton's method fails, is off in every variant.

The joints are exact up to the tolerance of Newton's method. "GeneralizedAlpha" holds them in positions (index 3),
"TrapezoidalIndex2" in velocities (index 2); both are of second order. The engine's explicit integrators take only
equations between single coordinates and the ground, which no joint of ours is.

Accelerations are the engine's own, so that reactions belong to the sampled instant. Both integrators carry them from
step to step, and those that the engine computes for the start ignore constraints between velocities (skates, rolling,
drives). This error leaves poses and twists alone. In the accelerations GeneralizedAlpha removes about a tenth of it
every step, the trapezoidal rule nothing. So as shipped, reactions are NaN where there are such constraints; the other
variants give the engine consistent accelerations for the start, by its public settings.

As shipped, Newton's norm is one over the residuals of forces, torques and constraints, so that a tolerance depends on
units and on masses: a body of 2e-11 kg m^2 beside one of 0.8 was off by 6e-7 of the motion at every step, and no
estimate saw it. So all other variants use the engine's other norm, `residualMode` 1, of the increment of an iteration,
in the mechanism's own length. An increment d of a pose changes its rate by 2 d / dt for the rest of the motion, and
`absolute` is a tolerance of that.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from engines.capability import Capability
from engines.contract import EXACT, ConvergenceOrder, NotDeclared, Size, Unsupported, unresolved
from engines.extrapolated import Extrapolated
from engines.lagrange.dynamics import Dynamics
from engines.motions import is_prescribed, over_three
from engines.single_run import ExtraEngine, Recorded, quiet
from engines.units import counted_in, power_of_two
from reference.checks import Name, Positive, validated
from reference.couplings import Coupling
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

Integrator = Literal["GeneralizedAlpha", "TrapezoidalIndex2"]
AXIS = [0.0, 0.0, 1.0]  # out of the plane
DISC = 0.1  # the radius of a skate's disc, which stands on edge
BELOW_TOLERANCE = unresolved(0.0, "a light body's forces are below what is resolved of the largest")
GAVE_UP = RunWarning("exudyn: the solver gave up before the end, as Newton's method did not converge", "lost")
NO_REACTIONS = RunWarning(
    "ours: reactions are not told, as the start's accelerations ignore velocity constraints", "reactions", "adapter"
)
STEP_COST = 19e-6  # s, with three bodies


@dataclass(frozen=True)
class Exudyn(ExtraEngine):
    """An engine in the sense of `engines.Engine`.

    `relative` and `absolute` are the tolerances of Newton's method, 1e-8 and 1e-10 as shipped; `damping`: the spectral
    radius of GeneralizedAlpha at infinite frequency, 0.9 as shipped (1 damps nothing). `consistent`: the start's
    accelerations are given to the engine, and not computed by it. `sparse`: Newton's matrix is factored as sparse.
    `own_units`: the model is counted in the mechanism's own length, mass and time, and so are `absolute` and the
    engine's least times: it ends a step below 1e-8 and resolves a sensor's instants to 1e-10. Newton's method then ends
    by the increment of an iteration: `relative` is a part of the first one, and `absolute` a rate.
    """

    name = "exudyn"
    packages = ("exudyn",)
    modules: ClassVar[tuple[str, ...]] = ("exudyn",)
    library: ClassVar[tuple[str, str] | None] = ("libGL.so.1", "libgl1")  # its window's, which is never opened here
    capability: ClassVar[Capability] = Capability(
        "exudyn",
        frozenset({Pin, Weld, Gear, Rod, Slot, Drive, Skate, Roll}),
        frozenset({Spring, Damper, TorsionSpring, TorsionDamper, Torque, Force}),
    )

    variant: Name
    integrator: Integrator = "GeneralizedAlpha"
    relative: Positive = 1e-8
    absolute: Positive = 1e-10
    damping: Positive = 0.9
    consistent: bool = False
    sparse: bool = False
    own_units: bool = False

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """Second. Reactions are unknown where velocities are held and the start's accelerations are not consistent."""
        velocities = holds_velocities(mechanism)
        reaction = math.nan if velocities and not self.consistent else None
        if self.integrator == "TrapezoidalIndex2":
            return ConvergenceOrder(2, slip=EXACT, reaction=reaction)
        held = velocities or is_prescribed(mechanism)
        return ConvergenceOrder(2, reaction=reaction) if held else ConvergenceOrder(2, gap=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About the time of a step [s]: the cube of many bodies where Newton's matrix is dense."""
        size = over_three(mechanism)
        return STEP_COST * size * (1.0 if self.sparse else max(1.0, size / 5) ** 2)

    def stricter(self, mechanism: Mechanism) -> Exudyn | None:
        """With a thousandth of Newton's tolerances, where they are not of the mechanism's own units."""
        if self.own_units:
            return None
        return replace(self, relative=1e-3 * self.relative, absolute=1e-3 * self.absolute)

    def model(self, mechanism: Mechanism, dt: float) -> System:
        return System(self, mechanism, dt)


def resolved_ratio(mechanism: Mechanism) -> float:
    """How many times as much as the heaviest body a force, or a torque at the mechanism's length, moves the lightest.

    Newton's tolerance is a part of the forces on the heaviest, in one norm of all forces and torques. Where its product
    with this ratio is above 1, the lightest body may accelerate by as much as anything does, whatever acts on it.
    """
    lightest = max(max(1 / body.mass, mechanism.length_scale**2 / body.inertia) for body in mechanism.bodies)
    return max(body.mass for body in mechanism.bodies) * lightest


def holds_velocities(mechanism: Mechanism) -> bool:
    """Whether some joint is held as an equation between velocities."""
    return any(isinstance(joint, Skate | Roll | Drive) for joint in mechanism.joints)


class System:
    """The engine's objects for one mechanism, in its own units or in SI: a length of `length` m counts as one."""

    def __init__(self, engine: Exudyn, mechanism: Mechanism, dt: float) -> None:
        import exudyn
        from exudyn import itemInterface

        length, mass, seconds = 1.0, 1.0, 1.0
        if engine.own_units:
            length, seconds = power_of_two(mechanism.length_scale), power_of_two(mechanism.time_scale)
            mass = power_of_two(max(body.mass for body in mechanism.bodies))
        self.engine, self.original = engine, mechanism
        self.length, self.seconds, self.dt = length, seconds, dt / seconds
        self.mechanism = counted_in(mechanism, mass, seconds)
        self.exudyn, self.items, self.unit = exudyn, itemInterface, np.array([length, length, 1.0])
        self.container = exudyn.SystemContainer()  # owns the system, so it has to stay
        self.system: Any = self.container.AddSystem()
        self.nodes: dict[str, int] = {}
        self.bodies: dict[str | None, int] = {None: self.system.AddObject(itemInterface.ObjectGround())}
        self.point_ground: int = self.system.AddNode(itemInterface.NodePointGround())
        for body in self.mechanism.bodies:
            self._add(body)
        equations = sum(self._join(joint) for joint in self.mechanism.joints)
        for force in self.mechanism.forces:
            self._apply(force)
        kinds, sensor = exudyn.OutputVariableType, itemInterface.SensorNode
        self.sensors = [
            [
                self.system.AddSensor(sensor(nodeNumber=node, storeInternal=True, outputVariableType=kind))
                for node in self.nodes.values()
            ]
            for kind in (kinds.Coordinates, kinds.Coordinates_t, kinds.Coordinates_tt)
        ]
        self.system.Assemble()
        count = len(mechanism.bodies)
        self.size = Size(count, 3 * count, mechanism.row_count, equations)

    def _object(self, kind: str, **settings: Any) -> int:
        return self.system.AddObject(getattr(self.items, kind)(**settings))

    def _marker(self, kind: str, **settings: Any) -> int:
        return self.system.AddMarker(getattr(self.items, kind)(**settings))

    def _load(self, kind: str, marker: int, **settings: Any) -> None:
        self.system.AddLoad(getattr(self.items, kind)(markerNumber=marker, **settings))

    def _add(self, body: Body) -> None:
        start, velocities = list(body.pose / self.unit), list(body.twist / self.unit)
        node = self.system.AddNode(self.items.NodeRigidBody2D(referenceCoordinates=start, initialVelocities=velocities))
        masses = {"mass": body.mass, "inertia": body.inertia / self.length**2}
        made = self._object("ObjectRigidBody2D", nodeNumber=node, **masses)
        marker = self._marker("MarkerBodyMass", bodyNumber=made)
        self._load("LoadMassProportional", marker, loadVector=self._vector(self.mechanism.gravity))
        self.nodes[body.name], self.bodies[body.name] = node, made

    def _vector(self, plane: tuple[float, float]) -> list[float]:
        return [value / self.length for value in (*plane, 0.0)]

    def _point(self, name: str | None, point: tuple[float, float], rigid: bool = False) -> int:
        kind = "MarkerBodyRigid" if rigid else "MarkerBodyPosition"
        return self._marker(kind, bodyNumber=self.bodies[name], localPosition=self._vector(point))

    def _ends(self, pair: Any, rigid: bool = False) -> list[int]:
        points = (pair.first, pair.first_point), (pair.second, pair.second_point)
        return [self._point(name, point, rigid) for name, point in points]

    def _rotations(self, *names: str | None) -> list[int]:
        places = [(self.point_ground, 0) if name is None else (self.nodes[name], 2) for name in names]
        return [self._marker("MarkerNodeCoordinate", nodeNumber=node, coordinate=column) for node, column in places]

    def _start(self, name: str | None) -> float:
        """A body's angle at the start [rad], from which the engine's coordinate counts; the ground's is zero."""
        return 0.0 if name is None else self.mechanism.bodies[self.mechanism.body_index(name)].pose[2]

    def _couple(self, *names: str | None, **law: Any) -> None:
        """factor1 times the second rotation minus the first is the offset."""
        self._object("ObjectConnectorCoordinate", markerNumbers=self._rotations(*names), **law)

    def _join(self, joint: Joint) -> int:
        """Add what stands for a joint; returns the number of its equations."""
        match joint:
            case Pin() | Weld():
                self._object("ObjectJointRevolute2D", markerNumbers=self._ends(joint))
                if isinstance(joint, Weld):
                    turned = joint.angle - self._start(joint.second) + self._start(joint.first)
                    self._couple(joint.first, joint.second, offset=turned)
                return joint.size
            case Gear():
                turned = self._start(joint.second) - joint.ratio * self._start(joint.first) - joint.phase
                self._couple(joint.second, joint.first, factor1=joint.ratio, offset=turned)
                return 1
            case Rod():
                distance = joint.length / self.length
                self._object("ObjectConnectorDistance", markerNumbers=self._ends(joint), distance=distance)
                return 1
            case Slot():
                ends = self._ends(joint, rigid=True)[::-1]  # the line belongs to the engine's second marker
                normal = [-math.sin(joint.line_angle), math.cos(joint.line_angle), 0.0]
                settings = {"normalMarker1": normal, "constrainRotation": False}
                self._object("ObjectJointPrismatic2D", markerNumbers=ends, **settings)
                return 2
            case Drive():
                law = {"offset": joint.turning_rate, "velocityLevel": True}
                self._couple(joint.first, joint.second, **law)
                return 1
            case Skate():
                ends = [self._point(joint.first, (0.0, 0.0), True), self._point(joint.second, joint.second_point, True)]
                axle = [-math.sin(joint.angle), math.cos(joint.angle), 0.0]
                self._disc(ends, [1, 0, 0], DISC, axle, AXIS)
                return 3
            case Roll():
                return self._roll(joint)
            case Coupling():
                raise Unsupported(f"joint {joint.name!r}: our adapter of exudyn builds no coupling")

    def _apply(self, force: ForceElement) -> None:
        """Add the engine's own element for a spring, a damper, a force or a torque."""
        match force:
            case Spring() if force.rest_length == 0:  # two springs along x and y, which need no direction
                law = {"stiffness": [force.stiffness, force.stiffness, 0.0]}
                self._object("ObjectConnectorCartesianSpringDamper", markerNumbers=self._ends(force), **law)
            case Spring():
                law = {"stiffness": force.stiffness, "referenceLength": force.rest_length / self.length}
                self._object("ObjectConnectorSpringDamper", markerNumbers=self._ends(force), **law)
            case Damper():
                self._object("ObjectConnectorSpringDamper", markerNumbers=self._ends(force), damping=force.damping)
            case TorsionSpring() | TorsionDamper():
                if isinstance(force, TorsionSpring):
                    law = {"stiffness": force.stiffness / self.length**2}
                    law["offset"] = force.rest_angle - self._start(force.second) + self._start(force.first)
                else:
                    law = {"damping": force.damping / self.length**2}
                ends = self._rotations(force.first, force.second)
                self._object("ObjectConnectorCoordinateSpringDamper", markerNumbers=ends, **law)
            case Torque():
                for name, torque in ((force.first, -force.torque), (force.second, force.torque)):
                    if name is not None:
                        self._load("LoadCoordinate", *self._rotations(name), load=torque / self.length**2)
            case Force():
                marker = self._point(force.second, force.second_point)
                self._load("LoadForceVector", marker, loadVector=self._vector(force.force))

    def _disc(self, ends: list[int], held: list[int], radius: float, axle: list[float], normal: list[float]) -> None:
        """A disc of the second marker on the plane of the first; held: along the axle, forwards, along the normal."""
        plane = {"discRadius": radius, "discAxis": axle, "planeNormal": normal}
        self._object("ObjectJointRollingDisc", markerNumbers=ends, constrainedAxes=held, **plane)

    def _roll(self, joint: Roll) -> int:
        ground, body, arc = joint.rolling.ground, joint.rolling.body, joint.rolling.body_arc
        low, high = body.curvature_range
        if ground.curvature_range != (0.0, 0.0) or not 0 < low == high:
            raise Unsupported(
                f"joint {joint.name!r}: exudyn's rolling joint is a disc on a plane, and our adapter builds no other"
            )
        # The material lies to the left of a boundary: the disc rolls on the line's other side, its centre on its left.
        heading, inward = float(ground.angle(joint.rolling.ground_arc)), float(body.angle(arc)) + math.pi / 2
        (x, y), radius = joint.second_point, 1 / low
        centre = (x + radius * math.cos(inward), y + radius * math.sin(inward))
        # As velocities alone are held, the plane's place does not matter; in a body the engine takes no other one.
        ends = [self._point(joint.first, (0.0, 0.0), True), self._point(joint.second, centre, True)]
        self._disc(ends, [0, 1, 1], radius / self.length, AXIS, [math.sin(heading), -math.cos(heading), 0.0])
        return 3

    def _settings(self, samples: int, every: int) -> Any:
        engine, settings = self.engine, self.exudyn.SimulationSettings()
        steps = settings.timeIntegration
        steps.endTime, steps.numberOfSteps = samples * every * self.dt, samples * every
        steps.adaptiveStep = False
        steps.newton.relativeTolerance, steps.newton.absoluteTolerance = engine.relative, engine.absolute
        if engine.own_units:
            steps.newton.residualMode, steps.newton.absoluteTolerance = 1, engine.absolute * self.dt / 2
        if engine.sparse:
            settings.linearSolver.solverType = self.exudyn.LinearSolverType.EigenSparse
        steps.generalizedAlpha.spectralRadius = engine.damping
        steps.generalizedAlpha.computeInitialAccelerations = not engine.consistent
        settings.solution.sensors.writePeriod, settings.solution.file.write = every * self.dt, False
        return settings

    def record(self, samples: int, every: int) -> Recorded:
        engine, settings = self.engine, self._settings(samples, every)
        if engine.consistent:
            start = Dynamics(self.mechanism).acceleration(self.mechanism.pose, self.mechanism.twist, 0.0)
            initial = {"configuration": self.exudyn.ConfigurationType.Initial}
            self.system.systemData.SetODE2Coordinates_tt((start / self.unit).reshape(-1).tolist(), **initial)
        resolved = float(np.finfo(float).eps) if engine.own_units else engine.relative
        warnings = [BELOW_TOLERANCE] if resolved * resolved_ratio(self.original) > 1 else []
        solver = getattr(self.exudyn.DynamicSolverType, engine.integrator)
        gave_up = False
        begin = time.process_time()
        try:
            with quiet():
                self.system.SolveDynamic(settings, solverType=solver)
        except Exception:  # its own report of a Newton iteration that failed is pages long
            gave_up = True
            warnings.append(GAVE_UP)
        stepping = time.process_time() - begin
        states, last = np.full((3, samples + 1, len(self.nodes), 3), np.nan), 0
        for kind, sensors in enumerate(self.sensors):
            for body, sensor in enumerate(sensors):
                stored = np.array(self.system.GetSensorStoredData(sensor)).reshape(-1, 4)[: samples + 1, 1:]
                states[kind, : len(stored), body], last = stored, len(stored) - 1
        states *= self.unit
        states[0] += self.mechanism.pose  # coordinates count from where a node stands at the start
        if gave_up:
            states[:, max(1, last) :] = np.nan
        if holds_velocities(self.mechanism) and not engine.consistent:
            states[2] = np.nan
            warnings.append(NO_REACTIONS)
        rates, loads = (states[1] / self.seconds, states[2] / self.seconds**2), self.original
        return Recorded(states[0], *rates, stepping, loads.inertias, np.array(loads.gravity), tuple(warnings))


DEFAULT = Exudyn("default")
# A rate of 1e-13 is 450 units of rounding, which constraints leave of it. What Newton's method leaves is the same in
# all levels, so that no estimate sees it: in 1e4 steps it adds up to a rate of 1e-9, a hundredth of the claim.
TUNED = Exudyn(
    "tuned", "TrapezoidalIndex2", relative=1e-10, absolute=1e-13, consistent=True, sparse=True, own_units=True
)
EXTENDED = Extrapolated(replace(TUNED, relative=1e-12), "extended", levels=(1, 2, 3, 4), powers=(2, 4, 6))
VARIANTS = (DEFAULT, TUNED, EXTENDED)
