"""Settings of the stiffness of MuJoCo's equality constraints, each of which is a spring and damper with a compliance.

A row obeys a + b v + k r = -R f: its reference acceleration, less the regularisation R times its force. R is (1 - d) /
d times a diagonal estimate of the row's inverse inertia, and the impedance d is at most 0.9999 (mjMAXIMP in mjmodel.h).
Documentation: mujoco.readthedocs.io, "Computation: Constraint model" for the law, "Modeling: Solver parameters" for
solref and solimp.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from reference.checks import Positive, Valid, validated
from reference.mechanism import Mechanism

# solimp with a constant impedance d: both ends of its range are the largest value that MuJoCo takes, mjMAXIMP.
STIFFEST = (0.9999, 0.9999, 0.001, 0.5, 1.0)


@dataclass(frozen=True)
class _Spring(Valid, ABC):
    """Critically damped springs; `impedance` is solimp, and `softening` a factor on the compliance that follows."""

    softening: ClassVar[float] = 1.0
    impedance: ClassVar[tuple[float, float, float, float, float]] = STIFFEST

    @abstractmethod
    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        """[s], for steps of dt [s]."""

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """solref: the time constant [s] and the damping ratio, or -stiffness and -damping of a unit mass."""
        return self.time_constant(mechanism, dt), 1.0

    @validated
    def gains(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """Stiffness [1/s^2] and damping [1/s] of a row per unit of inertia, which this solref means."""
        constant = self.time_constant(mechanism, dt)
        return 1 / constant**2, 2 / constant


@dataclass(frozen=True)
class Shipped(_Spring):
    """MuJoCo's defaults: a time constant of 0.02 s whatever the step, and an impedance that grows with the gap.

    The impedance is 0.9 at a gap of zero and 0.95 from a millimetre on: R is 0.11 of the inverse inertia and falls to
    0.053 (compared with `efc_KBIP` by a test in `tests/engines/test_mujoco_upstream.py`).
    """

    impedance: ClassVar[tuple[float, float, float, float, float]] = (0.9, 0.95, 0.001, 0.5, 2.0)

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return 0.02


@dataclass(frozen=True)
class TiedToStep(_Spring):
    """Critically damped with a time constant of some steps, impedance at its limit: documented settings only.

    The gap is R f / k, so it falls as the square of the step. No other documented setting lets it vanish. Unless the
    flag `refsafe` is disabled, MuJoCo clamps a shorter time constant at two steps (mjDSBL_REFSAFE in mjtype.h). With
    its integrator "discrete" an equality is not clamped, and a contact at about one step (4.0.1; checked by a test in
    `tests/engines/test_mujoco_upstream.py`). The time constant here is that of all other integrators.
    """

    steps: Positive = 5.0

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return max(self.steps, 2.0) * dt

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """solref before MuJoCo clamps it."""
        return self.steps * dt, 1.0


@dataclass(frozen=True)
class Hardened(_Spring):
    """Compliances multiplied by `softening`, and springs as slow as the motion allows, whatever the step.

    The estimate in R comes from fields of the model that can be written after it is compiled. With R near zero the loop
    needs no stiff spring, so its time constant can be `share` of the mechanism's time scale, and at least `steps`
    steps: the Runge-Kutta integrator then has its full order 4. `eased`: where so small a compliance is below the
    rounding of Newton's solver, it is increased (`engines.mujoco.solver_check`).
    """

    softening: Positive = 1e-8  # pyright: ignore[reportIncompatibleVariableOverride]
    share: Positive = 0.2
    steps: Positive = 5.0
    eased: bool = False

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return max(self.steps * dt, self.share * mechanism.time_scale)

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """solref in its direct form, -stiffness and -damping of a unit mass, which MuJoCo does not clamp."""
        constant = self.time_constant(mechanism, dt)
        return -1 / constant**2, -2 / constant


Stiffness = Shipped | TiedToStep | Hardened
