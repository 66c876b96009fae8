"""A rigid body in the plane: its mass, its inertia, and how it starts."""

from __future__ import annotations

from dataclasses import dataclass

from reference.checks import Name, Positive, Valid

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Body(Valid):
    """A rigid body in the plane, described at its centre of mass.

    mass [kg]; inertia [kg m^2] about the centre of mass; pose (x, y, angle) [m, m, rad] and twist (vx, vy, omega)
    [m/s, m/s, rad/s] at t = 0. Raises InvalidMechanism for a non-positive mass or inertia, or a number not finite.
    """

    name: Name
    mass: Positive
    inertia: Positive
    pose: Triple
    twist: Triple = (0.0, 0.0, 0.0)
