"""Stiffness of MuJoCo's equality constraints, which are springs and dampers with a compliance.

A row obeys a + b v + k r = -R f, where r is its gap and f its force. The regularisation R is (1 - d) / d times an
estimate of the inverse inertia of the row. The impedance d is at most 0.9999 (mjMAXIMP in mjmodel.h). MuJoCo documents
the law in the section "Constraint model", and solref and solimp in the section "Solver parameters".
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from reference.checks import Positive, Valid, validated
from reference.mechanism import Mechanism

# solimp with the largest impedance (mjMAXIMP) for all gaps.
STIFFEST = (0.9999, 0.9999, 0.001, 0.5, 1.0)


@dataclass(frozen=True)
class _Spring(Valid, ABC):
    softening: ClassVar[float] = 1.0  # Factor on the compliances.
    impedance: ClassVar[tuple[float, float, float, float, float]] = STIFFEST  # solimp.

    @abstractmethod
    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        """The time constant [s] for steps of dt [s]."""

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """solref: the time constant [s] and the damping ratio, or -stiffness and -damping of a unit mass."""
        return self.time_constant(mechanism, dt), 1.0

    @validated
    def gains(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """Stiffness [1/s^2] and damping [1/s] of a row per unit of inertia."""
        constant = self.time_constant(mechanism, dt)
        return 1 / constant**2, 2 / constant


@dataclass(frozen=True)
class Shipped(_Spring):
    """MuJoCo's defaults: the time constant is 0.02 s for all steps, and the impedance grows with the gap.

    The impedance is 0.9 at a gap of zero and 0.95 for gaps of at least a millimetre. R decreases from 0.11 to 0.053 of
    the inverse inertia (checked in `tests/engines/test_mujoco_rows.py`).
    """

    impedance: ClassVar[tuple[float, float, float, float, float]] = (0.9, 0.95, 0.001, 0.5, 2.0)

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return 0.02


@dataclass(frozen=True)
class TiedToStep(_Spring):
    """Documented settings alone: the time constant is `steps` steps, and the impedance has its largest value.

    The gap R f / k is proportional to the square of the step. MuJoCo increases a shorter time constant to two steps,
    unless the flag `refsafe` is disabled (mjDSBL_REFSAFE in mjtype.h). The integrator "discrete" keeps short time
    constants of equalities, and increases those of contacts to about one step (4.0.1, checked in
    `tests/engines/test_mujoco_rows.py`). `time_constant` is valid for all integrators except "discrete".
    """

    steps: Positive = 5.0

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return max(self.steps, 2.0) * dt

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        return self.steps * dt, 1.0


@dataclass(frozen=True)
class Hardened(_Spring):
    """Compliances are multiplied by `softening`, and springs are as slow as the motion allows.

    MuJoCo reads the estimate in R from fields that our code changes after compilation. With R near zero a loop needs no
    stiff spring. The time constant is `share` times the time scale of the mechanism, and at least `steps` steps. RK4
    then has its full order 4. `eased`: increase compliances that are below the rounding of the solver Newton, see
    `engines.mujoco.solver_check`.
    """

    softening: Positive = 1e-8  # pyright: ignore[reportIncompatibleVariableOverride]
    share: Positive = 0.2
    steps: Positive = 5.0
    eased: bool = False

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return max(self.steps * dt, self.share * mechanism.time_scale)

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """solref as -stiffness and -damping per unit of inertia, which MuJoCo does not change."""
        constant = self.time_constant(mechanism, dt)
        return -1 / constant**2, -2 / constant


Stiffness = Shipped | TiedToStep | Hardened
