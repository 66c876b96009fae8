"""Exudyn under test: planar rigid bodies in maximal coordinates, joints as algebraic equations, implicit integrators.

A body is a NodeRigidBody2D with an ObjectRigidBody2D, a Pin an ObjectJointRevolute2D, a Slot an ObjectJointPrismatic2D
that leaves the rotation free, a Rod an ObjectConnectorDistance. What is held between two rotations is an
ObjectConnectorCoordinate: a Drive at velocity level, a Gear, and, beside a revolute joint, a Weld. A Skate is the
engine's own rolling disc (ObjectJointRollingDisc), of which only the velocity along the axle is held: a real velocity
constraint, as users build wheels with it. Its disc stands on edge in the plane, so the radius does not matter. A Roll
of a circle on a straight line is the same joint lying in the plane, with the rolling velocity and the velocity along
the line's normal held; the engine has no contact of other shapes that is an equation. Springs, dampers, forces and
torques are the engine's own too.

Every variant has steps of one length, the one as shipped too: Exudyn's own `timeIntegration.adaptiveStep` is True, and
halves a step in which Newton's method fails.

The joints are exact up to the tolerance of Newton's method. "GeneralizedAlpha" holds them in positions (index 3),
"TrapezoidalIndex2" in velocities (index 2); both are of second order. The engine's explicit integrators take only
equations between single coordinates and the ground, which no joint of ours is.

Accelerations are the engine's own, so that reactions belong to the sampled instant. Both integrators carry them from
step to step, and those that the engine computes for the start know nothing of constraints between velocities (skates,
rolling, drives). This error leaves poses and twists alone. In the accelerations GeneralizedAlpha takes about a tenth of
it back every step, the trapezoidal rule nothing. So as shipped, reactions are NaN where there are such constraints; the
other variants give the engine consistent accelerations for the start, by its public settings.

As shipped, Newton's norm is one over what is left of forces, torques and what holds. What a tolerance means then
depends on units and on masses: a body of 2e-11 kg m^2 beside one of 0.8 went on to be pushed by what was below 1e-14 of
that norm, and was off by 6e-7 of the motion at every step, so that no estimate saw it (found by `crosscheck search`).
So all variants but the one as shipped take the engine's other norm, `residualMode` 1, of what an iteration still moves,
in the mechanism's own length. An iteration's move d of a pose changes its rate by 2 d / dt, and that is what `absolute`
is a tolerance of: it stays for the rest of the motion.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from engines.capability import Capability
from engines.contract import EXACT, Holder, Promise, Size, Unpromised, Unsupported
from engines.extrapolated import Extrapolated
from engines.lagrange.dynamics import Dynamics
from engines.motions import is_prescribed, over_three
from engines.single_run import Optional, Recorded, SingleRun, quiet
from engines.units import counted_in, power_of_two
from reference.checks import Name, Positive, validated
from reference.couplings import Coupling
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Integrator = Literal["GeneralizedAlpha", "TrapezoidalIndex2"]
AXIS = [0.0, 0.0, 1.0]  # out of the plane
DISC = 0.1  # the radius of a skate's disc, which stands on edge
BELOW = "ours: unresolved from 0 s on, a light body's forces are below what is resolved of the largest"
STEP_COST = 19e-6  # s, with three bodies
CAPABILITY = Capability(
    "exudyn",
    frozenset({Pin, Weld, Gear, Rod, Slot, Drive, Skate, Roll}),
    frozenset({Spring, Damper, TorsionSpring, TorsionDamper, Torque, Force}),
)


@dataclass(frozen=True)
class Exudyn(Optional):
    """An engine in the sense of `engines.Engine`.

    `relative` and `absolute` are the tolerances of Newton's method, 1e-8 and 1e-10 as shipped; `damping`: the spectral
    radius of GeneralizedAlpha at infinite frequency, 0.9 as shipped (1 damps nothing). `consistent`: the start's
    accelerations are given to the engine, and not computed by it. `sparse`: Newton's matrix is factored as sparse.
    `own_units`: the model is counted in the mechanism's own length, mass and time, and so are `absolute`, and what the
    engine takes for no time at all: it ends a step below 1e-8 and tells a sensor's instants to 1e-10. Newton's method
    then ends by what an iteration moves: `relative` is a part of what the first one does, and `absolute` a rate.
    """

    name = "exudyn"
    packages = ("exudyn",)
    modules: ClassVar[tuple[str, ...]] = ("exudyn",)
    library: ClassVar[tuple[str, str] | None] = ("libGL.so.1", "libgl1")  # its window's, which is never opened here

    variant: Name
    integrator: Integrator = "GeneralizedAlpha"
    relative: Positive = 1e-8
    absolute: Positive = 1e-10
    damping: Positive = 0.9
    consistent: bool = False
    sparse: bool = False
    own_units: bool = False

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """Second, both; what is held as an equation is exact up to Newton's tolerance. Without consistent accelerations
        at the start no reactions are told where velocities are held."""
        velocities = holds_velocities(mechanism)
        reaction = math.nan if velocities and not self.consistent else None
        if self.integrator == "TrapezoidalIndex2":
            return Promise(2, slip=EXACT, reaction=reaction)
        held = velocities or is_prescribed(mechanism)
        return Promise(2, reaction=reaction) if held else Promise(2, gap=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]: the cube of many bodies where Newton's matrix is dense."""
        size = over_three(mechanism)
        if self.sparse:
            return STEP_COST * size
        return STEP_COST * size * max(1.0, size / 5) ** 2

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """Every joint is the engine's own."""
        return "engine"

    def alike(self, mechanism: Mechanism) -> Exudyn | None:
        """With a thousandth of Newton's tolerances, where they are not of the mechanism's own units."""
        if self.own_units:
            return None
        return replace(self, relative=1e-3 * self.relative, absolute=1e-3 * self.absolute)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> SingleRun:
        """A system for steps of dt [s]; raises Unsupported, and ValueError for a bad dt."""
        CAPABILITY.require(mechanism)
        self.require()
        length, mass, seconds = 1.0, 1.0, 1.0
        if self.own_units:
            length, seconds = power_of_two(mechanism.length_scale), power_of_two(mechanism.time_scale)
            mass = power_of_two(max(body.mass for body in mechanism.bodies))
        system = System(counted_in(mechanism, mass, seconds), length)
        resolved = float(np.finfo(float).eps) if self.own_units else self.relative
        warnings = (BELOW,) if resolved * _largest_ratio(mechanism) > 1 else ()

        def record(samples: int, every: int) -> Recorded:
            found = system.record(self, dt / seconds, samples, every)
            return replace(
                found,
                warnings=(*warnings, *found.warnings),
                twist=found.twist / seconds,
                acceleration=found.acceleration / seconds**2,
                inertias=mechanism.inertias,
                gravity=np.array(mechanism.gravity),
            )

        return SingleRun(mechanism, dt, system.size, record)


def _largest_ratio(mechanism: Mechanism) -> float:
    """How many times as much as the heaviest body a force, or a torque at the mechanism's length, moves the lightest.

    Newton's tolerance is a part of what the heaviest need, in one norm of all forces and torques, and rounding is one
    of each. Where the product of both is above 1, it lets the lightest body accelerate by as much as anything does,
    whatever acts on it.
    """
    lightest = max(max(1 / body.mass, mechanism.length_scale**2 / body.inertia) for body in mechanism.bodies)
    return max(body.mass for body in mechanism.bodies) * lightest


def holds_velocities(mechanism: Mechanism) -> bool:
    """Whether some joint is held as an equation between velocities."""
    return any(isinstance(joint, Skate | Roll | Drive) for joint in mechanism.joints)


class System:
    """The engine's objects for one mechanism, whose lengths are counted in `length` [m]: a force then in `length` N."""

    def __init__(self, mechanism: Mechanism, length: float) -> None:
        import exudyn
        from exudyn import itemInterface

        self.mechanism, self.exudyn, self.items, self.length = mechanism, exudyn, itemInterface, length
        self.unit = np.array([length, length, 1.0])  # of poses, twists and accelerations
        self.container = exudyn.SystemContainer()  # owns the system, so it has to stay
        self.system: Any = self.container.AddSystem()
        self.ground = self.system.AddObject(itemInterface.ObjectGround())
        self.point_ground = self.system.AddNode(itemInterface.NodePointGround())
        self.nodes: dict[str, int] = {}
        self.bodies: dict[str | None, int] = {None: self.ground}
        for body in mechanism.bodies:
            self._add(body)
        equations = sum(self._join(joint) for joint in mechanism.joints)
        for force in mechanism.forces:
            self._apply(force)
        kinds = exudyn.OutputVariableType
        self.sensors = [
            [self._sensor(node, kind) for node in self.nodes.values()]
            for kind in (kinds.Coordinates, kinds.Coordinates_t, kinds.Coordinates_tt)
        ]
        self.system.Assemble()
        count = len(mechanism.bodies)
        self.size = Size(count, 3 * count, mechanism.row_count, equations)

    def _add(self, body: Any) -> None:
        items = self.items
        node = self.system.AddNode(
            items.NodeRigidBody2D(
                referenceCoordinates=list(body.pose / self.unit), initialVelocities=list(body.twist / self.unit)
            )
        )
        made = self.system.AddObject(
            items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia / self.length**2, nodeNumber=node)
        )
        marker = self.system.AddMarker(items.MarkerBodyMass(bodyNumber=made))
        pull = [value / self.length for value in (*self.mechanism.gravity, 0.0)]
        self.system.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=pull))
        self.nodes[body.name], self.bodies[body.name] = node, made

    def _sensor(self, node: int, kind: Any) -> int:
        return self.system.AddSensor(
            self.items.SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind)
        )

    def _point(self, name: str | None, point: tuple[float, float], rigid: bool = False) -> int:
        marker = self.items.MarkerBodyRigid if rigid else self.items.MarkerBodyPosition
        place = [value / self.length for value in (*point, 0.0)]
        return self.system.AddMarker(marker(bodyNumber=self.bodies[name], localPosition=place))

    def _ends(self, parts: Any) -> list[int]:
        return [self._point(parts.first, parts.first_point), self._point(parts.second, parts.second_point)]

    def _rotation(self, name: str | None) -> int:
        node, coordinate = (self.point_ground, 0) if name is None else (self.nodes[name], 2)
        return self.system.AddMarker(self.items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))

    def _start(self, name: str | None) -> float:
        """A body's angle at the start [rad], from which the engine's coordinate counts; the ground's is zero."""
        return 0.0 if name is None else self.mechanism.bodies[self.mechanism.body_index(name)].pose[2]

    def _hold(self, ends: list[int], **what: Any) -> None:
        """factor1 times the second coordinate minus the first is the offset."""
        self.system.AddObject(self.items.ObjectConnectorCoordinate(markerNumbers=ends, **what))

    def _join(self, joint: Joint) -> int:
        """Add what stands for a joint; how many equations it has."""
        items, system = self.items, self.system
        match joint:
            case Pin() | Weld():
                system.AddObject(items.ObjectJointRevolute2D(markerNumbers=self._ends(joint)))
                if isinstance(joint, Weld):
                    turned = joint.angle - self._start(joint.second) + self._start(joint.first)
                    self._hold([self._rotation(joint.first), self._rotation(joint.second)], offset=turned)
                return joint.size
            case Gear():
                turned = self._start(joint.second) - joint.ratio * self._start(joint.first) - joint.phase
                ends = [self._rotation(joint.second), self._rotation(joint.first)]
                self._hold(ends, factor1=joint.ratio, offset=turned)
                return 1
            case Rod():
                system.AddObject(
                    items.ObjectConnectorDistance(markerNumbers=self._ends(joint), distance=joint.length / self.length)
                )
                return 1
            case Slot():
                # The line belongs to the joint's second marker.
                ends = [
                    self._point(joint.second, joint.second_point, rigid=True),
                    self._point(joint.first, joint.first_point, rigid=True),
                ]
                normal = [-math.sin(joint.line_angle), math.cos(joint.line_angle), 0.0]
                system.AddObject(
                    items.ObjectJointPrismatic2D(markerNumbers=ends, normalMarker1=normal, constrainRotation=False)
                )
                return 2
            case Drive():
                ends = [self._rotation(joint.first), self._rotation(joint.second)]
                self._hold(ends, offset=joint.turning_rate, velocityLevel=True)
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
        items, add = self.items, self.system.AddObject
        match force:
            case Spring() if force.rest_length == 0:  # two springs along x and y: no direction is asked for
                stiffness = [force.stiffness, force.stiffness, 0.0]
                add(items.ObjectConnectorCartesianSpringDamper(markerNumbers=self._ends(force), stiffness=stiffness))
            case Spring():
                law = {"stiffness": force.stiffness, "referenceLength": force.rest_length / self.length}
                add(items.ObjectConnectorSpringDamper(markerNumbers=self._ends(force), **law))
            case Damper():
                add(items.ObjectConnectorSpringDamper(markerNumbers=self._ends(force), damping=force.damping))
            case TorsionSpring() | TorsionDamper():
                strength = force.damping if isinstance(force, TorsionDamper) else force.stiffness
                law = {"damping" if isinstance(force, TorsionDamper) else "stiffness": strength / self.length**2}
                if isinstance(force, TorsionSpring):
                    law["offset"] = force.rest_angle - self._start(force.second) + self._start(force.first)
                ends = [self._rotation(force.first), self._rotation(force.second)]
                add(items.ObjectConnectorCoordinateSpringDamper(markerNumbers=ends, **law))
            case Torque():
                for name, torque in ((force.first, -force.torque), (force.second, force.torque)):
                    if name is not None:
                        self.system.AddLoad(
                            items.LoadCoordinate(markerNumber=self._rotation(name), load=torque / self.length**2)
                        )
            case Force():
                marker = self._point(force.second, force.second_point)
                pull = [value / self.length for value in (*force.force, 0.0)]
                self.system.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=pull))

    def _disc(self, ends: list[int], held: list[int], radius: float, axle: list[float], normal: list[float]) -> None:
        """A disc of the second marker on the plane of the first; held: along the axle, forwards, along the normal."""
        self.system.AddObject(
            self.items.ObjectJointRollingDisc(
                markerNumbers=ends, constrainedAxes=held, discRadius=radius, discAxis=axle, planeNormal=normal
            )
        )

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

    def record(self, engine: Exudyn, dt: float, samples: int, every: int) -> Recorded:
        exudyn = self.exudyn
        settings = exudyn.SimulationSettings()
        steps = settings.timeIntegration
        steps.endTime, steps.numberOfSteps = samples * every * dt, samples * every
        steps.adaptiveStep = False
        steps.newton.relativeTolerance, steps.newton.absoluteTolerance = engine.relative, engine.absolute
        if engine.own_units:
            steps.newton.residualMode, steps.newton.absoluteTolerance = 1, engine.absolute * dt / 2
        if engine.sparse:
            settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
        steps.generalizedAlpha.spectralRadius = engine.damping
        if engine.consistent:
            steps.generalizedAlpha.computeInitialAccelerations = False
            start = Dynamics(self.mechanism).acceleration(self.mechanism.pose, self.mechanism.twist, 0.0)
            self.system.systemData.SetODE2Coordinates_tt(
                (start / self.unit).reshape(-1).tolist(), configuration=exudyn.ConfigurationType.Initial
            )
        settings.solution.sensors.writePeriod = every * dt
        settings.solution.file.write = False
        warnings: list[str] = []
        begin = time.process_time()
        try:
            with quiet():
                self.system.SolveDynamic(settings, solverType=getattr(exudyn.DynamicSolverType, engine.integrator))
        except Exception:  # its own report of a Newton iteration that failed is pages long
            warnings.append("exudyn: the solver gave up before the end, as Newton's method did not converge")
        stepping = time.process_time() - begin
        count = len(self.mechanism.bodies)
        states, last = np.full((3, samples + 1, count, 3), np.nan), 0
        for kind, sensors in enumerate(self.sensors):
            for body, sensor in enumerate(sensors):
                told = np.array(self.system.GetSensorStoredData(sensor)).reshape(-1, 4)[: samples + 1, 1:]
                states[kind, : len(told), body], last = told, len(told) - 1
        states *= self.unit
        states[0] += self.mechanism.pose  # coordinates count from where a node stands at the start
        if warnings:
            states[:, max(1, last) :] = np.nan
        if holds_velocities(self.mechanism) and not engine.consistent:
            states[2] = np.nan
            warnings.append("ours: reactions are not told, as the start's accelerations ignore velocity constraints")
        mechanism = self.mechanism
        pose, twist, acceleration = states
        return Recorded(
            pose, twist, acceleration, stepping, mechanism.inertias, np.array(mechanism.gravity), tuple(warnings)
        )


DEFAULT = Exudyn("default")
# A rate of 1e-13 is 450 units of rounding, which constraints leave of it. What Newton's method leaves is the same in
# all levels, so that no estimate sees it: in 1e4 steps it adds up to a rate of 1e-9, a hundredth of the claim.
TUNED = Exudyn(
    "tuned", "TrapezoidalIndex2", relative=1e-10, absolute=1e-13, consistent=True, sparse=True, own_units=True
)
EXTENDED = Extrapolated(replace(TUNED, relative=1e-12), "extended", levels=(1, 2, 3, 4), powers=(2, 4, 6))
VARIANTS = (DEFAULT, TUNED, EXTENDED)
