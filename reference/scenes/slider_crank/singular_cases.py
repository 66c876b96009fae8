"""Slider-cranks where methods fail: the rod's own end in the slot, and a slider that has to start the crank."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import Complexes, Positive, validated
from reference.joints import Pin, Slot
from reference.kinds import Floats
from reference.mechanism import Mechanism
from reference.scenes.slider_crank.linkage import MovingSliderCrank, SliderCrank
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reference.trajectory import Trajectory


@dataclass(frozen=True)
class RodEndInSlot(DrivenSliderCrank):
    """The driven slider-crank without a sliding block: the rod's own end runs in the slot, off its centre of mass.

    The motion of crank and rod is the same, since the crank is prescribed; `slider_mass` never acts.
    """

    name: ClassVar[str] = "rod_end_in_slot"

    @cached_property
    def _mechanism(self) -> Mechanism:
        whole = super()._mechanism
        kept = tuple(joint for joint in whole.joints if "slider" not in (joint.first, joint.second))
        end = next(joint for joint in whole.joints if isinstance(joint, Pin) and joint.second == "slider")
        guide = next(joint for joint in whole.joints if isinstance(joint, Slot))
        return replace(
            whole,
            bodies=whole.bodies[:2],
            joints=(*kept, replace(guide, second="rod", second_point=end.first_point)),
        )

    def _motion(self, times: NDArray[np.float64]) -> Trajectory:
        pose, twist, acceleration = (part[:, :2] for part in self._placement(*self.crank_motion(times)))
        return Trajectory(times, pose, twist, self._mechanism.reaction(pose, acceleration))

    def _branch_of(self, pose: Floats) -> Any:
        """+1 where the rod points to the right, -1 to the left."""
        return np.sign(np.cos(pose[..., 1, 2])).astype(int)


@dataclass(frozen=True)
class PushedSliderCrank(MovingSliderCrank):
    """Gravity acts along the slot, towards the crank's pivot."""

    @validated
    def potential(self, theta: Complexes) -> tuple[Any, Any]:
        """V(theta) [J] and its derivative: everything is pushed to -x."""
        r, x = self.shape.crank, self.shape.position(theta)
        first, _ = self.shape.position_rates(theta)
        cosine, sine = r * np.cos(theta), r * np.sin(theta)
        value = self.crank_mass * cosine / 2 + self.rod_mass * (cosine + x) / 2 + self.slider_mass * x
        slope = -self.crank_mass * sine / 2 + self.rod_mass * (first - sine) / 2 + self.slider_mass * first
        return self.gravity * value, self.gravity * slope


@dataclass(frozen=True)
class SliderAtDeadCentre(FreeSliderCrank):
    """Let go at rest next to the outer dead centre, everything pushed along the slot: the slider has no lever yet.

    In the dead centre itself it would stay for ever; `angle` [rad] is what decides when, and to which side, it leaves.
    """

    name: ClassVar[str] = "slider_at_dead_centre"
    angle: float = 1e-6
    rate: float = 0.0
    duration: Positive = 1.5
    horizon: Positive = 1.5

    @property
    def angle_unit(self) -> float:
        """The start's distance from the dead centre [rad]: an error in it grows as it does, and stays that part."""
        return min(1.0, abs(self.angle)) or 1.0

    @cached_property
    def moving(self) -> MovingSliderCrank:
        shape = SliderCrank(self.crank, self.rod, self.offset, self.branch)
        return PushedSliderCrank(shape, self.crank_mass, self.rod_mass, self.slider_mass, self.gravity)

    @cached_property
    def _mechanism(self) -> Mechanism:
        return replace(super()._mechanism, gravity=(-self.gravity, 0.0))
