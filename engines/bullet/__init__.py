"""Bullet under test, by its binding PyBullet: a tree in reduced coordinates, loops closed by impulses at points.

PyBullet and not ODE: it is what people use (the binding alone is asked about more than ODE is), and pip installs it
whole, while ode-python needs a library of the system. It costs 290 MB, and there is a wheel for Python 3.11 alone.

The tree is that of `engines.tree`, written as a URDF file, because nothing else takes a link's inertia, and read back:
continuous joints, prismatic ones for slots whose angle is kept, fixed ones for welds. A Pin that closes a loop is a
JOINT_POINT2POINT of enough force, a Weld a JOINT_FIXED, a Drive the velocity motor of a joint, a Gear a JOINT_GEAR
between two joints of the tree. No link without a mass stands between two joints, so a body that slides and turns, or
that hangs on nothing, is refused, as are slots in loops, rods, skates and rolling contact. There are no springs: what
force elements do to bodies is worked out by our code before every step, as users do, and given to the engine as
external forces. All damping and the limit on joint velocities are off; the wheel is built in double precision.

One step (btMultiBodyDynamicsWorld) kicks with the forces at the old positions, corrects the velocities by impulses with
a push against the gap (erp, 0.2 of it a step as shipped), and drifts with the new ones: semi-implicit Euler of first
order. Accelerations are changes of velocity over the last step, so nothing is told at t = 0.
"""

from __future__ import annotations

from engines.bullet.engine import DEFAULT, EXTENDED, TUNED, VARIANTS, Bullet

__all__ = ["DEFAULT", "EXTENDED", "TUNED", "VARIANTS", "Bullet"]
