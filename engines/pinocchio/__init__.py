"""Pinocchio under test: a tree in reduced coordinates whose loops are closed by exact contact constraints.

Pinocchio (the package is called `pin`) computes accelerations and integrates nothing: the integrators here are ours,
semi-implicit Euler and the classical Runge-Kutta method of fourth order, as its own examples are written.

The tree is that of `engines.tree`: revolute joints about z, prismatic ones along a slot, for a body that hangs on
nothing two prismatic ones and a revolute one, and for a welded one none: its inertia is added to the other's. A Pin
that closes a loop is a RigidConstraintModel of the type CONTACT_3D, a Weld one of CONTACT_6D: `constraintDynamics`
holds their accelerations exactly, and what opens is the integrator's error. Their rows out of the plane are empty; the
proximal solver takes care of that. A Drive has no counterpart: the torque that keeps its rate is worked out in every
evaluation from the engine's own answer to a unit torque. Neither have springs, dampers and the like: what they do to
bodies is worked out by our code, as users do, and given to the engine as external forces. Accelerations are the
engine's at the sampled instant, so reactions are too. A Slot that closes a loop, a Rod, a Gear, a Skate and a Roll
would need a constraint of a kind that the engine does not have.

As shipped nothing pulls an open loop back. With a `correction` c [1/s] the engine's corrector gains are c^2 and 2 c.
They change the errors of both integrators by a factor, up or down with the motion and the step, so no variant sets
them. The free four-bar at a step of 1e-3 s: 5.6e-9 rad (rk4) and 0.070 rad (euler) without, 1.5e-9 and 0.051 with the
gains 100 and 20 (c = 10). Which pin is taken as the loop changes none of these.
"""

from __future__ import annotations

from engines.pinocchio.engine import DEFAULT, TUNED, VARIANTS, Pinocchio

__all__ = ["DEFAULT", "TUNED", "VARIANTS", "Pinocchio"]
