"""A person upright on one foot without a muscle: the only sway there is, and how soon the knee buckles out of it.

Upright with all segments in line is an equilibrium. Of the five modes of small motions about it two swing, both mostly
of the lifted leg (4.1 and 9.3 rad/s), and three grow, the fastest by e in 0.03 s: the standing knee. The start lies on
the faster swinging mode, to the digits given, so that the body sways until what was left out has grown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig

from reference.checks import Positive, validated
from reference.scenes.person import OneFoot

Array = NDArray[np.float64]

UPRIGHT = (math.pi / 2, math.pi / 2, math.pi / 2, -math.pi / 2, -math.pi / 2)


@dataclass(frozen=True)
class SwayingOnOneFoot(OneFoot):
    """Upright on one foot, the lifted leg a tenth of a radian aside; angles [rad] on the mode that swings at 9.3 rad/s.

    The horizon is that of a difference's tenfold growth, which the buckling knee sets.
    """

    name: ClassVar[str] = "person_swaying"
    left_shank: float = -0.00200745
    left_thigh: float = -0.00285913
    trunk: float = 0.00332792
    right_thigh: float = -0.0676988
    right_shank: float = 0.1
    duration: Positive = 0.3
    horizon: Positive = 0.1


@validated
def modes_upright(person: OneFoot) -> tuple[Array, Array]:
    """Squares s [1/s^2] (5,) ascending, and shapes (5, 5) in columns, of small motions u'' = s u about standing
    upright.

    s < 0 swings at sqrt(-s) rad/s, s > 0 grows like e^(sqrt(s) t). By differences of the equations of motion.
    """
    upright, rest = np.array(UPRIGHT), np.zeros(5)

    def slope(step: float) -> Array:
        columns = [
            person.accelerations(upright + step * move, rest) - person.accelerations(upright - step * move, rest)
            for move in np.eye(5)
        ]
        return np.array(columns).T / (2 * step)

    # Richardson: central differences have even powers only. The steps balance rounding and the fifth derivative.
    found: Any = eig((4 * slope(1e-4) - slope(2e-4)) / 3)
    order = np.argsort(found[0].real)
    return found[0].real[order], found[1].real[:, order]
