"""Tests that a scene with lengths of nanometres or gigametres has the scaled motion.

A change of unit by a power of two changes no digit of products and sums. So any difference is caused by a constant that
depends on a unit.
"""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from reference.joints import Drive
from reference.scene import Scene
from reference.scenes.catalogue import SCENES
from tests.mechanisms import SCENES_OF_LIMITS

# A mapping from fields with a unit to the exponents of length, time and mass in the unit.
LENGTH, TIME, MASS = (1, 0, 0), (0, 1, 0), (0, 0, 1)
RATE, SPEED, PULL, INERTIA = (0, -1, 0), (1, -1, 0), (1, -2, 0), (2, 0, 1)
_METRES = (
    "crank coupler rocker ground rod offset length hitch wheelbase track centres centre front width trail points point "
    "pin along_x along_y radius eccentricity cosines sines gyration ring hill major hole side ground_arc stance hip_x "
    "hip_y height caster_centre lever distance "
    "pivot_a pivot_b pivot_c bar spring_point upper upper_end lower lower_end rest_length"
)
UNITS = {
    **dict.fromkeys(_METRES.split(), LENGTH),
    **dict.fromkeys(("duration", "horizon"), TIME),
    **dict.fromkeys(("rate", "turning_rate", "start_rate"), RATE),
    **dict.fromkeys(("mass", "masses", "crank_mass", "rod_mass", "slider_mass", "caster_mass", "lever_mass"), MASS),
    **dict.fromkeys(("inertia", "inertias", "slider_inertia", "caster_inertia"), INERTIA),
    **{"speed": SPEED, "gravity": PULL, "density": (-1, 0, 1), "stiffness": (0, -2, 1), "torque": (2, -2, 1)},
}
OTHER = {("elliptic_gears", "eccentricity"): (0, 0, 0)}
POSES = ("start", "pose")  # Fields whose values are x, y and angle.
# Units of length [m], time [s] and mass [kg]. Small multiples of the powers of two do not add up to zero, so that
# errors in two exponents cannot cancel.
SCALES = {"small": (2.0**-30, 2.0**-17, 2.0**23), "large": (2.0**30, 2.0**19, 2.0**-13)}


def scaled(value, factor):
    if isinstance(value, tuple):
        return tuple(scaled(part, factor) for part in value)
    return value * factor


def in_other_units(scene: Scene, unit: tuple[float, float, float]) -> Scene:
    """The scene with its numbers in these units of length [m], time [s] and mass [kg]."""
    changes = {}
    for field in fields(scene):  # pyright: ignore[reportArgumentType] (each scene's class is a dataclass)
        value = getattr(scene, field.name)
        if field.name in POSES and isinstance(value, tuple):
            changes[field.name] = (value[0] * unit[0], value[1] * unit[0], value[2])
            continue
        exponents = OTHER.get((scene.name, field.name), UNITS.get(field.name, (0, 0, 0)))
        if any(exponents):
            factor = math.prod(one**exponent for one, exponent in zip(unit, exponents, strict=True))
            changes[field.name] = scaled(value, factor)
    return replace(scene, **changes)  # pyright: ignore[reportArgumentType]


def off(found, expected):
    size = np.nanmax(np.abs(expected), initial=0.0)
    return float(np.nanmax(np.abs(found - expected), initial=0.0) / size) if size else float(np.nanmax(np.abs(found)))


def difference(scene: Scene, unit: tuple[float, float, float]) -> float:
    """The largest relative difference of poses, twists and reactions between the scene and the scene in other units."""
    other = in_other_units(scene, unit)
    until = min(scene.duration, scene.horizon, scene.comparable_until, getattr(scene, "corner", math.inf) / 2)
    times = until * np.array([0.0, 0.13, 0.5, 1.0])
    usual, found = scene.motion(times), other.motion(times * unit[1])
    place, turn = np.array([unit[0], unit[0], 1.0]), unit[1]
    assert np.array_equal(np.isnan(usual.reaction), np.isnan(found.reaction))
    parts = [
        off(found.pose[..., :2] / place[:2], usual.pose[..., :2]),
        off(found.pose[..., 2], usual.pose[..., 2]),
        off(found.twist[..., :2] / place[:2] * turn, usual.twist[..., :2]),
        off(found.twist[..., 2] * turn, usual.twist[..., 2]),
    ]
    force = unit[2] * unit[0] / turn**2
    turned = np.concatenate([[isinstance(joint, Drive)] * joint.size for joint in scene.mechanism().joints])
    for rows, size in ((~turned, force), (turned, force * unit[0])):
        if np.any(np.isfinite(usual.reaction[:, rows])):
            parts.append(off(found.reaction[:, rows] / size, usual.reaction[:, rows]))
    return max(parts)


# The overdriven crank is left out, since its motion ends.
ALL = tuple(scene for scene in (*SCENES, *SCENES_OF_LIMITS) if scene.name != "overdriven_four_bar")
# Scenes whose reference motion takes a fifth of a second or more.
COSTLY = (
    *("free_four_bar", "spinning_four_bar", "cart", "free_slider_crank", "slider_at_dead_centre", "pendulum_2"),
    *("pendulum_10", "pendulum_100", "pendulum_n", "rolling_cam", "rolling_in_ring", "rolling_ellipse"),
    *(
        "rolling_disc",
        "rolling_incline",
        "person_swaying",
        "person_one_foot",
        "person_two_feet",
        "n_four_bar_40",
        "andrews",
    ),
)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize(
    "scene",
    [pytest.param(each, marks=pytest.mark.slow if each.name in COSTLY else ()) for each in ALL],
    ids=lambda scene: scene.name,
)
def test_the_motion_of_a_scene_does_not_depend_on_units(scene: Scene, scale: str) -> None:
    # The motions differ by rounding. Scenes in COSTLY are slow, and their rounding errors may grow tenfold up to
    # the horizon.
    allowed = 1e-11 if scene.name == "pendulum_100" else 1e-12  # Joint forces of long chains sum more roundings.
    assert difference(scene, SCALES[scale]) < allowed
