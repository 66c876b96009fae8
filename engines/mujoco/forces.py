"""Force elements in MuJoCo's model: tendons with stiffness or damping, and actuators with a constant force.

Springs and dampers are spatial tendons between two sites. Torsion springs and torsion dampers are fixed tendons, whose
length is a sum of tree coordinates. The force of an actuator is its bias, so controls have no effect. The actuator of a
torque acts on a fixed tendon. The actuator of a force acts at a site; its reference site is in the world, so the force
does not turn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import mujoco
import numpy as np

from engines.mujoco.builder import ModelBuilder
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring

AUTOMATIC = -1.0  # MuJoCo replaces a springlength of -1 by the initial length


def _name(force: ForceElement) -> str:
    return f"force {force.name}"


def _set_linear(tendon: Any, field: str, value: float) -> None:
    """Set the linear coefficient of a stiffness or damping, which is a polynomial in newer releases."""
    size = np.size(getattr(tendon, field, 0.0))
    setattr(tendon, field, value if size == 1 else [value, *[0.0] * (size - 1)])


def _add_spring(builder: ModelBuilder, force: Spring) -> None:
    tendon = builder.add_spatial_tendon(_name(force), force)
    tendon.springlength = [force.rest_length] * 2
    _set_linear(tendon, "stiffness", force.stiffness)


def _add_damper(builder: ModelBuilder, force: Damper) -> None:
    _set_linear(builder.add_spatial_tendon(_name(force), force), "damping", force.damping)


def _add_angle_tendon(
    builder: ModelBuilder, force: TorsionSpring | TorsionDamper | Torque, sign: float = 1.0
) -> Any | None:
    factors = builder.tree.turning(force.first, force.second)
    scaled = {column: sign * factor for column, factor in factors.items()}
    return builder.add_fixed_tendon(_name(force), scaled) if factors else None


def _add_torsion_spring(builder: ModelBuilder, force: TorsionSpring) -> None:
    mechanism = builder.mechanism
    second, first = (
        0.0 if name is None else mechanism.pose[mechanism.body_index(name), 2] for name in (force.second, force.first)
    )
    rest = float(force.rest_angle - (second - first))  # tree coordinates are zero at t = 0
    sign = -1.0 if rest == AUTOMATIC else 1.0
    tendon = _add_angle_tendon(builder, force, sign)
    if tendon is not None:
        tendon.springlength = [sign * rest] * 2
        _set_linear(tendon, "stiffness", force.stiffness)


def _add_torsion_damper(builder: ModelBuilder, force: TorsionDamper) -> None:
    tendon = _add_angle_tendon(builder, force)
    if tendon is not None:
        _set_linear(tendon, "damping", force.damping)


def _add_torque(builder: ModelBuilder, force: Torque) -> None:
    if force.torque and _add_angle_tendon(builder, force) is not None:
        _add_actuator(builder, force, mujoco.mjtTrn.mjTRN_TENDON, [force.torque, *[0.0] * 5])


def _add_force(builder: ModelBuilder, force: Force) -> None:
    if not any(force.force):
        return
    site = builder.add_site(f"{_name(force)} at", force.second, force.second_point)
    origin = builder.add_site(f"{_name(force)} from", None, (0.0, 0.0))
    gear = [*force.force, *[0.0] * 4]
    _add_actuator(builder, force, mujoco.mjtTrn.mjTRN_SITE, gear, target=site, refsite=origin)


def _add_actuator(builder: ModelBuilder, force: ForceElement, kind: Any, gear: list[float], **fields: str) -> None:
    builder.spec.add_actuator(
        name=_name(force),
        trntype=kind,
        biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        biasprm=[1.0, *[0.0] * 9],
        gainprm=[0.0] * 10,
        gear=gear,
        **{"target": _name(force), **fields},
    )


FORCE_CONSTRUCTIONS: Mapping[type, Callable[[ModelBuilder, Any], None]] = {
    Spring: _add_spring,
    Damper: _add_damper,
    TorsionSpring: _add_torsion_spring,
    TorsionDamper: _add_torsion_damper,
    Torque: _add_torque,
    Force: _add_force,
}
