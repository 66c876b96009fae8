"""Rolling in MuJoCo: every construction as a method of its own, beside the general variants."""

from __future__ import annotations

from dataclasses import replace

from engines.mujoco.engine import EXTENDED, TUNED
from engines.mujoco.roll_contact import CompletedContact, RollContact
from engines.mujoco.roll_rows import RollEquality, RollRows
from engines.mujoco.stiffness import TiedToStep

# What written rows and completed contacts need: MuJoCo's Newton solver, whose later steps refine what a compliance of
# 1e-8 loses in the first; more of them bring nothing, and no tolerance would stop them.
NEWTON = replace(EXTENDED, solvers=("Newton",), iterations=5, tolerance=1e-20)

METHODS = (
    replace(TUNED, variant="contact, stiff Euler", integrator="Euler"),
    replace(
        TUNED, variant="joint equality, rewritten", integrator="Euler", stiffness=TiedToStep(2.0), rolls=RollEquality()
    ),
    replace(NEWTON, variant="contact, completed", rolls=CompletedContact()),
)

__all__ = ["METHODS", "NEWTON", "CompletedContact", "RollContact", "RollEquality", "RollRows"]
