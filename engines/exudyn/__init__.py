"""Exudyn under test: planar rigid bodies in maximal coordinates, joints as algebraic equations, implicit integrators.

A body is a NodeRigidBody2D with an ObjectRigidBody2D, a Pin an ObjectJointRevolute2D, a Slot an ObjectJointPrismatic2D
that leaves the rotation free, a Rod an ObjectConnectorDistance. What is held between two rotations is an
ObjectConnectorCoordinate: a Drive at velocity level, a Gear, and, beside a revolute joint, a Weld. A Skate is the
engine's own rolling disc (ObjectJointRollingDisc), of which only the velocity along the axle is held: a real velocity
constraint, as users build wheels with it. Its disc stands on edge in the plane, so the radius does not matter. A Roll
of a circle on a straight line is the same joint lying in the plane, with the rolling velocity and the velocity along
the line's normal held; the engine has no contact of other shapes that is an equation. Springs, dampers, forces and
torques are the engine's own too.

The joints are exact up to the tolerance of Newton's method. "GeneralizedAlpha" holds them in positions (index 3),
"TrapezoidalIndex2" in velocities (index 2); both are of second order. The engine's explicit integrators take only
equations between single coordinates and the ground, which no joint of ours is.

Accelerations are the engine's own, so that reactions belong to the sampled instant. Both integrators carry them from
step to step, and those that the engine computes for the start know nothing of constraints between velocities (skates,
rolling, drives). This error leaves poses and twists alone. In the accelerations GeneralizedAlpha takes about a tenth of
it back every step, the trapezoidal rule nothing. So as shipped, reactions are NaN where there are such constraints; the
other variants give the engine consistent accelerations for the start, by its public settings.

Newton's norm is one over forces, torques and what holds, so what a tolerance means depends on the unit of length: in
millimetres torques are a thousandth beside forces, and a light body's rotation was left 2e-6 off, after one iteration
instead of two (found by `crosscheck search`). So all variants but the one as shipped count in the mechanism's own.
"""

from __future__ import annotations

from engines.exudyn.engine import DEFAULT, EXTENDED, TUNED, VARIANTS, Exudyn

__all__ = ["DEFAULT", "EXTENDED", "TUNED", "VARIANTS", "Exudyn"]
