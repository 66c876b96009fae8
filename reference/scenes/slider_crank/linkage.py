"""The slider-crank in formulas: position and its rates, dead centres, stroke.

The crank turns about the origin; the slider moves along the line y = offset. With crank r, rod l, offset e and crank
angle theta, the rod's angle beta follows from r sin(theta) + l sin(beta) = e, and x = r cos(theta) + l cos(beta). The
two branches are cos(beta) > 0 (+1) and cos(beta) < 0 (-1). A loop that the chapter calls "difficult or impossible to
express with formulas"; this one isn't.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Complexes, InvalidMechanism, Positive, Sign, Valid, validated

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SliderCrank(Valid):
    """Crank and rod [m], the slot's height `offset` [m], and the `branch`, +1 or -1.

    Raises InvalidMechanism unless the crank can turn fully, |offset| < rod - crank: at equality the branches meet.
    """

    crank: Positive
    rod: Positive
    offset: float = 0.0
    branch: Sign = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not abs(self.offset) < self.rod - self.crank:
            raise InvalidMechanism(
                f"slider-crank: offset is {self.offset!r}; for a full turn it must stay below rod - crank = "
                f"{self.rod - self.crank:.6g} in size"
            )

    def _rod(self, theta: Any) -> tuple[Any, Any]:
        """sin(beta) and cos(beta); unchecked, since an integration asks for them thousands of times.

        Of a complex step the cosine's derivative is written out: in that of (1 - sine)(1 + sine) a small sine is lost.
        """
        sine = (self.offset - self.crank * np.sin(theta)) / self.rod
        flat = np.real(sine)
        cosine = self.branch * np.sqrt((1 - flat) * (1 + flat))
        return sine, cosine - 1j * flat * np.imag(sine) / cosine if np.iscomplexobj(sine) else cosine

    @validated
    def rod_angle(self, theta: ArrayLike) -> Array:
        """beta (...) [rad], from the crank pin to the slider, continuous in theta."""
        sine, _ = self._rod(np.asarray(theta))
        return np.arcsin(sine) if self.branch == 1 else math.pi - np.arcsin(sine)

    @validated
    def position(self, theta: Complexes) -> Any:
        """x (...) [m] of the slider; analytic, so a complex step passes."""
        return self.crank * np.cos(theta) + self.rod * self._rod(theta)[1]

    @validated
    def rates(self, theta: Complexes) -> tuple[Any, Any]:
        """beta' [1] and x' [m] with respect to theta (...): r cos(theta) + l cos(beta) beta' = 0; analytic."""
        return self._rates(theta)

    def _rates(self, theta: Any) -> tuple[Any, Any]:
        sine, cosine = self._rod(theta)
        turn = -self.crank * np.cos(theta) / (self.rod * cosine)
        return turn, -self.crank * np.sin(theta) - self.rod * sine * turn

    def dead_centres(self) -> tuple[float, float]:
        """The crank angles [rad] at which crank and rod are in line: stretched, then folded.

        There the slider stands still, x' = 0, and can't drive the crank.
        """
        stretched = math.asin(self.offset / (self.rod + self.crank))
        folded = math.pi + math.asin(self.offset / (self.rod - self.crank))
        if self.branch == 1:
            return stretched, folded
        return math.pi - stretched, 3 * math.pi - folded

    def stroke(self) -> float:
        """The slider's way between its dead centres [m]."""
        return math.sqrt((self.rod + self.crank) ** 2 - self.offset**2) - math.sqrt(
            (self.rod - self.crank) ** 2 - self.offset**2
        )
