"""Checks that a motion does not depend on how it is described: see `engines.conformance.changes`."""

from __future__ import annotations

import numpy as np

from engines import Unsupported
from engines.conformance.changes import (
    Change,
    Isometry,
    bodies_reordered,
    joints_reordered,
    joints_swapped,
    relabelled,
)
from engines.conformance.check import Check, Fails, Subject, finite
from engines.conformance.worlds import MOVING, World

# Below these, relative to the largest value, only rounding differs: a solver that ends by a tolerance lets some more
# through than the 1e-13 of a direct one, and reactions are differences of velocities over a step.
ROUNDING = {"pose": 1e-10, "twist": 1e-9, "reaction": 1e-6}
# Where an engine decides at a threshold (whether two shapes that just touch do touch) or treats the rows of a joint one
# after the other, two descriptions may come out with errors of their own. Both are of the size of its error at this
# step, so they differ by at most twice that; and half as much again, since errors are known at samples only.
OWN = 3.0
# The order in which an iterative solver goes over the joints changes what its sweeps leave, so the error itself: the
# rate of a Gauss-Seidel sweep is that of the matrix, whatever the order, but not the first sweep's share. A decade.
SWEPT = 10.0


def same_if_turned(subject: Subject, world: World) -> None:
    """The whole world turned by an odd angle moves in the same way."""
    _same(subject, world, Isometry(turn=0.7), OWN, "a direction of the world is used as one of a body, or of gravity")


def same_if_shifted(subject: Subject, world: World) -> None:
    """The whole world shifted moves in the same way."""
    _same(subject, world, Isometry(shift=(3.7, -2.9)), OWN, "a point of the ground is taken from the origin")


def same_if_mirrored(subject: Subject, world: World) -> None:
    """The whole world seen in a mirror moves in the mirrored way."""
    _same(
        subject, world, Isometry(mirrored=True), OWN, "a sign of an angle or of a direction across is taken for granted"
    )


def same_if_relabelled(subject: Subject, world: World) -> None:
    """Other names of bodies and joints change nothing."""
    _same(subject, world, relabelled, OWN, "bodies are sorted by name, or a name means something")


def same_if_bodies_are_reordered(subject: Subject, world: World) -> None:
    """Bodies in another order move in the same way, and are told in that order."""
    _same(subject, world, bodies_reordered, OWN, "states stand in the engine's order instead of the mechanism's")


def same_if_joints_are_reordered(subject: Subject, world: World) -> None:
    """Joints in another order move in the same way, with an error of the same size, and reactions in that order."""
    _same(subject, world, joints_reordered, SWEPT, "reactions stand in the engine's order, or only a tree is built")


def same_if_bodies_of_joints_are_swapped(subject: Subject, world: World) -> None:
    """Pins and drives named from their other body move in the same way, with reactions of the other sign."""
    _same(subject, world, joints_swapped, OWN, "the ground, or the parent, is expected to be the first body of a joint")


def _same(subject: Subject, world: World, change: Change, factor: float, means: str) -> None:
    run = finite(subject.run(world.mechanism))
    exact = world.exact(run.t)
    changed, back = change(world.mechanism)
    try:
        other = back(finite(subject.fresh(changed)))
    except Unsupported as reason:
        raise Fails(f"a refusal: {reason}", "the same motion, since it builds the other description", means) from reason
    for name, now in zip(("pose", "twist", "reaction"), other, strict=True):
        was = getattr(run, name)
        if np.array_equal(np.isnan(was), np.isnan(now)) and np.isnan(was).all():
            continue
        own = factor * float(np.nanmax(np.abs(was - getattr(exact, name))))
        size = max(1.0, float(np.nanmax(np.abs(was))))
        bound = own + ROUNDING[name] * size
        differ = float(np.max(np.abs(np.nan_to_num(now) - np.nan_to_num(was))))
        if not differ <= bound or not np.array_equal(np.isnan(was), np.isnan(now)):
            raise Fails(
                f"a {name} that differs by {differ:.3g}",
                f"at most {bound:.2g}: {factor:g} times its error at this step, and rounding",
                means,
            )


CHECKS = (
    *(Check(function, MOVING) for function in (same_if_turned, same_if_shifted, same_if_mirrored, same_if_relabelled)),
    Check(same_if_bodies_are_reordered, tuple(world for world in MOVING if len(world.mechanism.bodies) > 1)),
    Check(same_if_joints_are_reordered, tuple(world for world in MOVING if len(world.mechanism.joints) > 1)),
    Check(same_if_bodies_of_joints_are_swapped, tuple(world for world in MOVING if {"pin", "drive"} & {*world.kinds})),
)
