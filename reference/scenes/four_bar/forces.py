"""The forces in a moving four-bar of uniform bars, by Newton's and Euler's laws of its three bars."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from reference.checks import Numbers, Positive, validated
from reference.plane import from_complex

Densities = Positive | tuple[Positive, Positive, Positive]  # kg/m, of all bars or of crank, coupler and rocker


class Forces(NamedTuple):
    """Pin forces (..., 2) [N] on each pin's second body, and the torque (...) [N m] on the crank from the ground.

    A: ground on crank; B: crank on coupler; C: coupler on rocker; D: ground on rocker.
    """

    A: Any
    B: Any
    C: Any
    D: Any
    torque: Any


@validated
def three_densities(density: Densities) -> tuple[float, float, float]:
    """Densities of crank, coupler and rocker [kg/m] from one number or three; raises InvalidMechanism."""
    return density if isinstance(density, tuple) else (density, density, density)


@validated
def bar_forces(
    lengths: tuple[Positive, Positive, Positive],
    density: Densities,
    gravity: tuple[float, float],
    angles: tuple[Numbers, Numbers, Numbers],
    rates: tuple[Numbers, Numbers, Numbers],
    accelerations: tuple[Numbers, Numbers, Numbers],
) -> Forces:
    """Forces for uniform bars of the given lengths [m], density [kg/m] and gravity [m/s^2], in a given motion.

    Angles, rates and accelerations are those of crank, coupler and rocker (theta, beta, phi) and broadcast.
    """
    masses = [rho * length for rho, length in zip(three_densities(density), lengths, strict=True)]
    falling = complex(*gravity)
    # Plane vectors are complex numbers here: half bars, and their accelerations about their own end.
    half = [length / 2 * np.exp(1j * np.asarray(angle)) for length, angle in zip(lengths, angles, strict=True)]
    moving = [
        arm * (1j * np.asarray(acceleration) - np.asarray(rate) ** 2)
        for arm, rate, acceleration in zip(half, rates, accelerations, strict=True)
    ]
    pull = [
        masses[0] * (moving[0] - falling),
        masses[1] * (2 * moving[0] + moving[1] - falling),
        masses[2] * (moving[2] - falling),
    ]  # m (a - g) of each bar: the sum of its pin forces
    spin = [
        mass * length**2 / 12 * np.asarray(acceleration)
        for mass, length, acceleration in zip(masses, lengths, accelerations, strict=True)
    ]
    # Moments of the coupler about B and of the rocker about D leave two equations for the force at C.
    coupler, rocker = 2 * half[1], 2 * half[2]
    about_b = -(spin[1] + _cross(half[1], pull[1]))
    about_d = spin[2] + _cross(half[2], pull[2])
    at_c = (rocker * about_b - coupler * about_d) / _cross(coupler, rocker)
    at_b = pull[1] + at_c
    at_a = pull[0] + at_b
    at_d = pull[2] - at_c
    torque = spin[0] + _cross(half[0], pull[0]) + _cross(2 * half[0], at_b)
    return Forces(from_complex(at_a), from_complex(at_b), from_complex(at_c), from_complex(at_d), torque)


def _cross(first: Any, second: Any) -> Any:
    return (np.conj(first) * second).imag
