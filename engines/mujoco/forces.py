"""Force elements in MuJoCo, all of them in the compiled model: no callback, and smooth in every stage.

Springs and dampers are tendons: spatial between two sites, or, where they turn, fixed, a sum of tree coordinates. A
constant torque is an actuator on such a sum, a constant force one at a site, measured from a site of the world, so that
its direction stays; both push by their bias alone, whatever the control.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from engines.mujoco.construction import Building
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring

AUTOMATIC = -1.0  # a springlength that MuJoCo replaces by the length at the start


def add_forces(building: Building) -> None:
    """Add all force elements of the mechanism."""
    for force in building.mechanism.forces:
        match force:
            case Spring():
                tendon = building.add_between(_name(force), force)
                tendon.springlength = [force.rest_length] * 2
                _set(tendon, "stiffness", force.stiffness)
            case Damper():
                _set(building.add_between(_name(force), force), "damping", force.damping)
            case TorsionSpring():
                _add_torsion_spring(building, force)
            case TorsionDamper():
                tendon = _turning(building, force)
                if tendon is not None:
                    _set(tendon, "damping", force.damping)
            case Torque():
                if force.torque and _turning(building, force) is not None:
                    _push(building, force, mujoco.mjtTrn.mjTRN_TENDON, [force.torque, *[0.0] * 5])
            case Force():
                if any(force.force):
                    _add_force(building, force)


def _name(force: ForceElement) -> str:
    return f"force {force.name}"


def _set(tendon: Any, name: str, value: float) -> None:
    """A stiffness or damping: newer releases have a polynomial there, of which this is the linear part."""
    size = np.size(getattr(tendon, name, 0.0))
    setattr(tendon, name, value if size == 1 else [value, *[0.0] * (size - 1)])


def _turning(building: Building, force: TorsionSpring | TorsionDamper | Torque, sense: float = 1.0) -> Any:
    """A fixed tendon as long as the second body has turned against the first; None if it can't turn against it."""
    signs = building.tree.turning(force.first, force.second)
    return building.add_sum(_name(force), {column: sense * sign for column, sign in signs.items()}) if signs else None


def _add_torsion_spring(building: Building, force: TorsionSpring) -> None:
    mechanism = building.mechanism
    second, first = (
        0.0 if name is None else mechanism.pose[mechanism.body_index(name), 2] for name in (force.second, force.first)
    )
    rest = float(force.rest_angle - (second - first))  # tree coordinates are zero at the start
    sense = -1.0 if rest == AUTOMATIC else 1.0
    tendon = _turning(building, force, sense)
    if tendon is not None:
        tendon.springlength = [sense * rest] * 2
        _set(tendon, "stiffness", force.stiffness)


def _add_force(building: Building, force: Force) -> None:
    site = building.add_site(f"{_name(force)} at", force.second, force.second_point)
    origin = building.add_site(f"{_name(force)} from", None, (0.0, 0.0))
    _push(building, force, mujoco.mjtTrn.mjTRN_SITE, [*force.force, *[0.0] * 4], target=site, refsite=origin)


def _push(building: Building, force: ForceElement, kind: Any, gear: list[float], **what: str) -> None:
    """An actuator whose scalar force is one."""
    building.spec.add_actuator(
        name=_name(force),
        trntype=kind,
        biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        biasprm=[1.0, *[0.0] * 9],
        gainprm=[0.0] * 10,
        gear=gear,
        **{"target": _name(force), **what},
    )
