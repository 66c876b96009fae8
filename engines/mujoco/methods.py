"""Every method of MuJoCo as a value: the three variants, what lies between them, and each construction of a joint.

METHODS are for every scene. SKATES, ROLLS and SLOTS hold one kind of joint in one way each, for a page that compares
them; what each way is stands in `engines.mujoco.joints`.
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
    # As shipped (1e-8) accelerations may miss by about 1e-4 m/s^2: in a slow motion that is all of them.
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
# Another way to prescribe a rate; where nothing is driven it is no method of its own.
DRIVES = (replace(DEFAULT, variant="default, overwritten crank", drive="overwrite"),)

# A skate beside the variants': the blade of DEFAULT as fast as the step allows, and by the integrator that suits it.
SKATES = (replace(TUNED, variant="friction blade", skates="blade", integrator="Euler"),)
ROLLS = (replace(TUNED, variant="contact, stiff Euler", integrator="Euler"),)
# A slot whose line moves as a row of ours. It is no setting of MuJoCo's, so it is not what `TUNED` itself takes.
SLOTS = (replace(TUNED, variant="tuned, slots as rows", slots="rows"),)
