"""The methods of MuJoCo. METHODS are for all scenes, and the other methods compare constructions of a joint."""

from __future__ import annotations

from dataclasses import replace

from engines.mujoco.engine import MuJoCo
from engines.mujoco.joints.roll import RollContact
from engines.mujoco.stiffness import Hardened, Shipped, TiedToStep

DEFAULT = MuJoCo("default")
CONTACT = RollContact(friction=10.0, steps=2.0, stick=True, cone="elliptic")
TUNED = MuJoCo(
    "tuned",
    "RK4",
    TiedToStep(),
    # With MuJoCo's default, 1e-8, accelerations may have an error of 1e-4 m/s^2, which is 100 % in a slow motion.
    tolerance=1e-15,
    jacobian="dense",
    islands=False,
    skates="predicted tendon",
    rolls=CONTACT,
)
EXTENDED = replace(
    TUNED,
    variant="extended",
    stiffness=Hardened(eased=True),
    armature=1e12,
    solvers=("Newton", "PGS", "CG"),
    tolerance=1e-28,
    slots="rows",
    skates="rows",
    rolls="rows",
    estimates=True,
    rods="rows",
)
VARIANTS = (DEFAULT, TUNED, EXTENDED)
METHODS = (
    *VARIANTS,
    replace(TUNED, variant="stiff Euler", integrator="Euler"),
    replace(TUNED, variant="stiff implicitfast", integrator="implicitfast"),
    replace(TUNED, variant="stiff discrete", integrator="discrete"),
    replace(TUNED, variant="RK4 alone", stiffness=Shipped(), rolls=RollContact()),
    replace(EXTENDED, variant="extended, free coordinates", coordinates="free"),
)

# The blade of DEFAULT, with the integrator Euler and the largest damping that the step allows.
SKATES = (replace(TUNED, variant="friction blade", skates="blade", integrator="Euler"),)
ROLLS = (replace(TUNED, variant="contact, stiff Euler", integrator="Euler"),)
# A slot with a moving line is a user row in this method. TUNED has no user rows, since they are no setting of MuJoCo.
SLOTS = (replace(TUNED, variant="tuned, slots as rows", slots="rows"),)
