"""The methods of MuJoCo as values: three variants, methods between them, and methods for single kinds of joints.

METHODS are for every scene. SKATES, ROLLS and SLOTS each hold one kind of joint by another construction (see
`engines.mujoco.joints`), for a page that compares these.
"""

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
    # With MuJoCo's default, 1e-8, accelerations may be wrong by about 1e-4 m/s^2, which is 100 % in a slow motion.
    tolerance=1e-15,
    jacobian="dense",
    islands=False,
    skates="predicted tendon",
    rolls=CONTACT,
)
EXTENDED = MuJoCo(
    "extended",
    "RK4",
    Hardened(eased=True),
    armature=1e12,
    solvers=("Newton", "PGS", "CG"),
    iterations=100,
    tolerance=1e-28,
    jacobian="dense",
    islands=False,
    slots="rows",
    skates="rows",
    rolls="rows",
    estimates=True,
    rods="rows",
)
VARIANTS = (DEFAULT, TUNED, EXTENDED)
METHODS = (
    DEFAULT,
    TUNED,
    EXTENDED,
    replace(TUNED, variant="stiff Euler", integrator="Euler"),
    replace(TUNED, variant="stiff implicitfast", integrator="implicitfast"),
    replace(TUNED, variant="stiff discrete", integrator="discrete"),
    replace(TUNED, variant="RK4 alone", stiffness=Shipped(), rolls=RollContact()),
    replace(EXTENDED, variant="extended, free coordinates", coordinates="free"),
)
# For mechanisms with drives: another way to prescribe a rate.
DRIVES = (replace(DEFAULT, variant="default, overwritten crank", drive="overwrite"),)

# The blade of DEFAULT with friction that acts as fast as the step allows, and with Euler, which suits it.
SKATES = (replace(TUNED, variant="friction blade", skates="blade", integrator="Euler"),)
ROLLS = (replace(TUNED, variant="contact, stiff Euler", integrator="Euler"),)
# A slot with a moving line as a user row, which is no setting of MuJoCo's, and so not in `TUNED`.
SLOTS = (replace(TUNED, variant="tuned, slots as rows", slots="rows"),)
