"""A mechanism as a system of Exudyn, and the run of this system."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from engines.contract import Size, Unsupported, unresolved
from engines.lagrange.dynamics import Dynamics
from engines.single_run import Recorded, quiet
from engines.units import counted_in, power_of_two
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

if TYPE_CHECKING:
    from engines.exudyn import Exudyn

PLANE_NORMAL = [0.0, 0.0, 1.0]
# Radius [m] of a skate's disc.
DISC_RADIUS = 0.1
BELOW_TOLERANCE = unresolved(0.0, "a light body's forces are below what is resolved of the largest")
GAVE_UP = RunWarning("exudyn: the solver gave up before the end, as Newton's method did not converge", "lost")
NO_REACTIONS = RunWarning(
    "ours: reactions are not told, as the start's accelerations ignore velocity constraints", "reactions", "adapter"
)


def resolved_ratio(mechanism: Mechanism) -> float:
    """The largest mass divided by the smallest mass or inertia / length^2, with the mechanism's length.

    Newton's tolerance is relative to the forces on the heaviest body. If this ratio exceeds 1 / tolerance, the error of
    the lightest body's acceleration may be as large as the largest acceleration.
    """
    lightest = max(max(1 / body.mass, mechanism.length_scale**2 / body.inertia) for body in mechanism.bodies)
    return max(body.mass for body in mechanism.bodies) * lightest


def holds_velocities(mechanism: Mechanism) -> bool:
    return any(isinstance(joint, Skate | Roll | Drive) for joint in mechanism.joints)


class ExudynSystem:
    """A mechanism as a system of Exudyn, whose units are `length` [m] and `seconds` [s]."""

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
        self.container = exudyn.SystemContainer()  # the container owns the system
        self.system: Any = self.container.AddSystem()
        self.nodes: dict[str, int] = {}
        self.bodies: dict[str | None, int] = {None: self.system.AddObject(itemInterface.ObjectGround())}
        self.point_ground: int = self.system.AddNode(itemInterface.NodePointGround())
        for body in self.mechanism.bodies:
            self._add(body)
        equations = sum(EXUDYN_JOINTS[type(joint)](self, joint) for joint in self.mechanism.joints)
        for force in self.mechanism.forces:
            EXUDYN_FORCES[type(force)](self, force)
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
        number = self._object("ObjectRigidBody2D", nodeNumber=node, **masses)
        marker = self._marker("MarkerBodyMass", bodyNumber=number)
        self._load("LoadMassProportional", marker, loadVector=self._vector(self.mechanism.gravity))
        self.nodes[body.name], self.bodies[body.name] = node, number

    def _vector(self, plane: tuple[float, float]) -> list[float]:
        return [value / self.length for value in (*plane, 0.0)]

    def _point(self, name: str | None, point: tuple[float, float], rigid: bool = False) -> int:
        kind = "MarkerBodyRigid" if rigid else "MarkerBodyPosition"
        return self._marker(kind, bodyNumber=self.bodies[name], localPosition=self._vector(point))

    def _ends(self, pair: Any, rigid: bool = False) -> list[int]:
        return [self._point(name, point, rigid) for name, point in pair.points]

    def _rotations(self, *names: str | None) -> list[int]:
        angles = [(self.point_ground, 0) if name is None else (self.nodes[name], 2) for name in names]
        return [self._marker("MarkerNodeCoordinate", nodeNumber=node, coordinate=column) for node, column in angles]

    def _start(self, name: str | None) -> float:
        """The angle [rad] of a body at t = 0, at which the engine's coordinate is zero; 0 for the ground."""
        return 0.0 if name is None else self.mechanism.bodies[self.mechanism.body_index(name)].pose[2]

    def _couple(self, *names: str | None, **law: Any) -> None:
        self._object("ObjectConnectorCoordinate", markerNumbers=self._rotations(*names), **law)

    def add_pin(self, joint: Pin | Weld) -> int:
        self._object("ObjectJointRevolute2D", markerNumbers=self._ends(joint))
        return 2

    def add_weld(self, joint: Weld) -> int:
        equations = self.add_pin(joint)
        angle = joint.angle - self._start(joint.second) + self._start(joint.first)
        self._couple(joint.first, joint.second, offset=angle)
        return equations + 1

    def add_gear(self, joint: Gear) -> int:
        angle = self._start(joint.second) - joint.ratio * self._start(joint.first) - joint.phase
        self._couple(joint.second, joint.first, factor1=joint.ratio, offset=angle)
        return 1

    def add_rod(self, joint: Rod) -> int:
        distance = joint.length / self.length
        self._object("ObjectConnectorDistance", markerNumbers=self._ends(joint), distance=distance)
        return 1

    def add_slot(self, joint: Slot) -> int:
        ends = self._ends(joint, rigid=True)[::-1]  # the engine expects the line at the second marker
        normal = [-math.sin(joint.line_angle), math.cos(joint.line_angle), 0.0]
        settings = {"normalMarker1": normal, "constrainRotation": False}
        self._object("ObjectJointPrismatic2D", markerNumbers=ends, **settings)
        return 2

    def add_drive(self, joint: Drive) -> int:
        self._couple(joint.first, joint.second, offset=joint.turning_rate, velocityLevel=True)
        return 1

    def add_skate(self, joint: Skate) -> int:
        ends = [self._point(joint.first, (0.0, 0.0), True), self._point(joint.second, joint.second_point, True)]
        axle = [-math.sin(joint.angle), math.cos(joint.angle), 0.0]
        self._disc(ends, [1, 0, 0], DISC_RADIUS, axle, PLANE_NORMAL)
        return 3

    def add_spring(self, force: Spring) -> None:
        if force.rest_length == 0:  # springs along x and y need no direction
            law = {"stiffness": [force.stiffness, force.stiffness, 0.0]}
            self._object("ObjectConnectorCartesianSpringDamper", markerNumbers=self._ends(force), **law)
        else:
            law = {"stiffness": force.stiffness, "referenceLength": force.rest_length / self.length}
            self._object("ObjectConnectorSpringDamper", markerNumbers=self._ends(force), **law)

    def add_damper(self, force: Damper) -> None:
        self._object("ObjectConnectorSpringDamper", markerNumbers=self._ends(force), damping=force.damping)

    def add_torsion_spring(self, force: TorsionSpring) -> None:
        angle = force.rest_angle - self._start(force.second) + self._start(force.first)
        self._add_torsion(force, stiffness=force.stiffness / self.length**2, offset=angle)

    def add_torsion_damper(self, force: TorsionDamper) -> None:
        self._add_torsion(force, damping=force.damping / self.length**2)

    def _add_torsion(self, force: TorsionSpring | TorsionDamper, **law: float) -> None:
        ends = self._rotations(force.first, force.second)
        self._object("ObjectConnectorCoordinateSpringDamper", markerNumbers=ends, **law)

    def add_torque(self, force: Torque) -> None:
        for name, torque in ((force.first, -force.torque), (force.second, force.torque)):
            if name is not None:
                self._load("LoadCoordinate", *self._rotations(name), load=torque / self.length**2)

    def add_force(self, force: Force) -> None:
        marker = self._point(force.second, force.second_point)
        self._load("LoadForceVector", marker, loadVector=self._vector(force.force))

    def _disc(
        self, ends: list[int], constrained: list[int], radius: float, axle: list[float], normal: list[float]
    ) -> None:
        """Add a disc at the second marker on a plane at the first marker.

        `constrained`: 1 for a constrained velocity along the axle, along the path, and along the normal.
        """
        plane = {"discRadius": radius, "discAxis": axle, "planeNormal": normal}
        self._object("ObjectJointRollingDisc", markerNumbers=ends, constrainedAxes=constrained, **plane)

    def add_roll(self, joint: Roll) -> int:
        ground, body, arc = joint.rolling.ground, joint.rolling.body, joint.rolling.body_arc
        low, high = body.curvature_range
        if ground.curvature_range != (0.0, 0.0) or not 0 < low == high:
            raise Unsupported(
                f"joint {joint.name!r}: exudyn's rolling joint is a disc on a plane, and our adapter builds no other"
            )
        # Material is on the left of a boundary, so the disc's centre is on the left of the disc's boundary.
        heading, inward = float(ground.angle(joint.rolling.ground_arc)), float(body.angle(arc)) + math.pi / 2
        (x, y), radius = joint.second_point, 1 / low
        centre = (x + radius * math.cos(inward), y + radius * math.sin(inward))
        # Only velocities are constrained, so the marker can be at any point of the plane. In a body it must be at (0,
        # 0).
        ends = [self._point(joint.first, (0.0, 0.0), True), self._point(joint.second, centre, True)]
        self._disc(ends, [0, 1, 1], radius / self.length, PLANE_NORMAL, [math.sin(heading), -math.cos(heading), 0.0])
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
        except Exception:  # a message of the engine has many lines
            gave_up = True
            warnings.append(GAVE_UP)
        stepping = time.process_time() - begin
        states, last = np.full((3, samples + 1, len(self.nodes), 3), np.nan), 0
        for kind, sensors in enumerate(self.sensors):
            for body, sensor in enumerate(sensors):
                stored = np.array(self.system.GetSensorStoredData(sensor)).reshape(-1, 4)[: samples + 1, 1:]
                states[kind, : len(stored), body], last = stored, len(stored) - 1
        states *= self.unit
        states[0] += self.mechanism.pose  # the engine's coordinates are zero at t = 0
        if gave_up:
            states[:, max(1, last) :] = np.nan
        if holds_velocities(self.mechanism) and not engine.consistent:
            states[2] = np.nan
            warnings.append(NO_REACTIONS)
        rates, loads = (states[1] / self.seconds, states[2] / self.seconds**2), self.original
        return Recorded(states[0], *rates, stepping, loads.inertias, np.array(loads.gravity), tuple(warnings))


# Functions that create joints and return the number of equations, and functions that create force elements.
EXUDYN_JOINTS: Mapping[type, Callable[[ExudynSystem, Any], int]] = {
    Pin: ExudynSystem.add_pin,
    Weld: ExudynSystem.add_weld,
    Gear: ExudynSystem.add_gear,
    Rod: ExudynSystem.add_rod,
    Slot: ExudynSystem.add_slot,
    Drive: ExudynSystem.add_drive,
    Skate: ExudynSystem.add_skate,
    Roll: ExudynSystem.add_roll,
}
EXUDYN_FORCES: Mapping[type, Callable[[ExudynSystem, Any], None]] = {
    Spring: ExudynSystem.add_spring,
    Damper: ExudynSystem.add_damper,
    TorsionSpring: ExudynSystem.add_torsion_spring,
    TorsionDamper: ExudynSystem.add_torsion_damper,
    Torque: ExudynSystem.add_torque,
    Force: ExudynSystem.add_force,
}
