"""Every method of MuJoCo as a value: the three variants, what lies between them, and each construction of a joint.

METHODS are for every scene. SKATES, ROLLS and SLOTS hold one kind of joint in one way each, for a page that compares
them; what each way is stands in `engines.mujoco.joints`.
"""

from __future__ import annotations

from dataclasses import replace

from engines.mujoco.engine import MuJoCo
from engines.mujoco.joints.roll import CompletedContact, RollContact, RollEquality, RollRows
from engines.mujoco.stiffness import Hardened, Shipped, TiedToStep

DEFAULT = MuJoCo("default")
TUNED = MuJoCo(
    "tuned",
    "RK4",
    TiedToStep(),
    # As shipped (1e-8) accelerations may miss by about 1e-4 m/s^2: in a slow motion that is all of them.
    tolerance=1e-15,
    jacobian="dense",
    islands=False,
    skates="predicted tendon",
    rolls=RollContact(friction=10.0, steps=2.0, stick=True, cone="elliptic"),
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
    rolls=RollRows(),
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
# Other ways to prescribe a rate; where nothing is driven they are no methods of their own.
DRIVES = (
    replace(TUNED, variant="tuned, servo", drive="servo"),
    replace(DEFAULT, variant="default, overwritten crank", drive="overwrite"),
)

# What written rows and completed contacts need: MuJoCo's Newton solver, whose later steps refine what a compliance of
# 1e-8 loses in the first; more of them bring nothing, and no tolerance would stop them.
NEWTON = replace(EXTENDED, solvers=("Newton",), iterations=5, tolerance=1e-20)

# A skate by every construction that we found in use, from the least exact to the most, each beside the integrator that
# suits it: the orders of the integrators differ.
SKATES = (
    replace(TUNED, variant="friction blade", skates="blade", integrator="Euler"),
    replace(TUNED, variant="thin wheel", skates="wheel", integrator="Euler"),
    replace(TUNED, variant="velocity servo", skates="servo", integrator="implicit"),
    replace(TUNED, variant="tendon friction", skates="tendon friction"),
    replace(TUNED, variant="tendon", skates="tendon"),
    replace(TUNED, variant="tendon RK4", skates="tendon", euler_for_skates=False),
    replace(NEWTON, variant="leapfrog", skates="leapfrog"),
    replace(TUNED, variant="applied force", skates="force"),
    replace(EXTENDED, variant="passive force", skates="passive"),
    # Nearly all of its error is the softness that it declares, which an estimate of the step's error would count in.
    replace(EXTENDED, variant="rows, shipped compliance", stiffness=Hardened(softening=1.0), estimates=False),
)

ROLLS = (
    replace(TUNED, variant="contact, stiff Euler", integrator="Euler"),
    replace(
        TUNED, variant="joint equality, rewritten", integrator="Euler", stiffness=TiedToStep(2.0), rolls=RollEquality()
    ),
    replace(NEWTON, variant="contact, completed", rolls=CompletedContact()),
)

# A slot whose line moves as a row of ours. It is no setting of MuJoCo's, so it is not what `TUNED` itself takes.
SLOTS = (replace(TUNED, variant="tuned, slots as rows", slots="rows"),)
