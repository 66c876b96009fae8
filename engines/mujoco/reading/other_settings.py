"""What can be changed in a user's MuJoCo model: kinds of elements switched off, and settings that MuJoCo documents."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from engines.mujoco.stiffness import STIFFEST
from engines.mujoco.written_file import INTEGRATORS
from engines.reading import Change

ELEMENTS = {
    "contact": "CONTACT",
    "limit": "LIMIT",
    "frictionloss": "FRICTIONLOSS",
    "equality": "EQUALITY",
    "actuation": "ACTUATION",
    "spring": "SPRING",
    "damper": "DAMPER",
    "gravity": "GRAVITY",
}
OTHERS = ("armature", "fluid", "forcelimit", "sleep")  # that no flag of MuJoCo's switches off
TIED_STEPS = 5.0  # time constant of the stiffer loops, in steps: the same rule as the tuned variant's
SHIPPED = ((0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0))  # solref and solimp of an equality about which nothing is said
HALVINGS = (1, 2, 4, 8, 16, 32)


def switch_off(model: Any, element: str) -> None:
    """Change a model so that this kind of element no longer acts. Raises ValueError for a word that is none."""
    if element == "armature":
        model.dof_armature[:] = 0.0
    elif element == "forcelimit":
        for limited in (model.actuator_forcelimited, model.jnt_actfrclimited, model.tendon_actfrclimited):
            limited[:] = 0
    elif element == "sleep":
        model.opt.enableflags &= ~int(getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", 0))
    elif element == "fluid":
        model.opt.density = model.opt.viscosity = 0.0
    elif element in ELEMENTS:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{ELEMENTS[element]}"))
    else:
        raise ValueError(f"--without is {element!r}; it must be one of {', '.join((*ELEMENTS, *OTHERS))}")


def changes(model: Any, soft: bool, smallest: float, urdf: bool = False) -> list[Change]:
    """Steps down to `smallest` [s], by the model's own integrator and RK4; `soft`: loops as they are, and stiffer.

    `urdf`: the lines to copy bring the element in which a URDF file holds MuJoCo's options.
    """
    own_step = float(model.opt.timestep)
    own = mujoco.mjtIntegrator(model.opt.integrator).name.split("_")[1]
    integrators = list(dict.fromkeys([own, "RK4"]))
    out = []
    for tied in (False, True) if soft else (False,):
        for integrator in integrators:
            for divisor in HALVINGS:
                dt = own_step / divisor
                if dt < smallest:
                    break
                name = INTEGRATORS.get(integrator, integrator.lower())
                words = f"{name}, step {dt * 1e3:.4g} ms" + (", stiff loops" if tied else "")
                option = f'<option timestep="{dt!r}" integrator="{name}"/>'
                lines = [f"<mujoco>{option}</mujoco>" if urdf else option]
                if tied:
                    impedance = " ".join(f"{value:g}" for value in STIFFEST)
                    values = f'solref="{TIED_STEPS * dt:g} 1" solimp="{impedance}"'
                    lines.append(f"<default><equality {values}/></default>")
                    if _set_by_hand(model):
                        lines.append("<!-- an equality with a solref or solimp of its own needs these values there -->")
                out.append(Change(words, dt, tuple(lines), (("integrator", integrator), ("tied", tied))))
    return out


def _set_by_hand(model: Any) -> bool:
    """Whether an equality has other values than those that MuJoCo gives it: a default would not reach it."""
    return bool(np.any(model.eq_solref != SHIPPED[0]) or np.any(model.eq_solimp != SHIPPED[1]))
