"""How stiff MuJoCo makes its equality constraints: every one is a spring and damper with a compliance of its own.

A row obeys a + b v + k r = -R f: the reference acceleration that the solver aims at, missed by the regularisation R
times the row's force. R is (1 - d) / d of a diagonal estimate of the row's inverse inertia, and d can't exceed 0.9999
(mjMAXIMP in mjmodel.h). Documentation: mujoco.readthedocs.io, "Computation: Constraint model" for the law, "Modeling:
Solver parameters" for solref and solimp.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from reference.checks import Positive, Valid, validated
from reference.mechanism import Mechanism

# MuJoCo clamps its impedance d here (mjMAXIMP); both ends of its range are this, so that d is constant.
STIFFEST = (0.9999, 0.9999, 0.001, 0.5, 1.0)


@dataclass(frozen=True)
class _Spring(Valid, ABC):
    """Critically damped springs; `impedance` is solimp, `softening` multiplies the compliance that belongs to it."""

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
        """Stiffness [1/s^2] and damping [1/s] of a row per unit of inertia: what this solref amounts to."""
        constant = self.time_constant(mechanism, dt)
        return 1 / constant**2, 2 / constant


@dataclass(frozen=True)
class Shipped(_Spring):
    """MuJoCo's defaults: a time constant of 0.02 s whatever the step, and an impedance that grows with the gap.

    It is 0.9 with the gap closed, and 0.95 where it is open by a millimetre and more: R is 0.11 of the inverse inertia
    and falls to 0.053 (checked against `efc_KBIP` by a test in `tests/engines/test_mujoco_upstream.py`).
    """

    impedance: ClassVar[tuple[float, float, float, float, float]] = (0.9, 0.95, 0.001, 0.5, 2.0)

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return 0.02


@dataclass(frozen=True)
class TiedToStep(_Spring):
    """Critically damped with a time constant of some steps, impedance at its limit: documented settings only.

    The gap is R f / k, so it falls as the square of the step: the only way to let it vanish without touching the model.
    With its flag `refsafe`, which is on unless it is disabled, MuJoCo clamps a shorter time constant at two steps
    (mjDSBL_REFSAFE in mjtype.h). Its integrator "discrete" is another matter: there an equality is not clamped, and a
    contact at about one step (4.0.1; a test in `tests/engines/test_mujoco_upstream.py` asks it for both). The time
    constant here is that of all other integrators.
    """

    steps: Positive = 5.0

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return max(self.steps, 2.0) * dt

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """solref as it is asked for, which MuJoCo clamps."""
        return self.steps * dt, 1.0


@dataclass(frozen=True)
class Hardened(_Spring):
    """The compliance itself multiplied by `softening`; springs as slow as the motion allows, whatever the step.

    The estimate in R comes from fields of the model that can be written after it is compiled. With R near zero the loop
    needs no stiff spring, so its time constant can be `share` of the mechanism's time scale, and at least `steps`
    steps: the Runge-Kutta integrator then keeps its order 4. `eased`: where Newton's solver would lose so small a
    compliance in rounding it is made larger again (`engines.mujoco.solver_check`); otherwise it is what was asked for.
    """

    softening: Positive = 1e-8  # pyright: ignore[reportIncompatibleVariableOverride]
    share: Positive = 0.2
    steps: Positive = 5.0
    eased: bool = False

    def time_constant(self, mechanism: Mechanism, dt: float) -> float:
        return max(self.steps * dt, self.share * mechanism.time_scale)

    @validated
    def reference(self, mechanism: Mechanism, dt: Positive) -> tuple[float, float]:
        """solref in its direct form, -stiffness and -damping of a unit mass: this one MuJoCo doesn't clamp."""
        constant = self.time_constant(mechanism, dt)
        return -1 / constant**2, -2 / constant


Stiffness = Shipped | TiedToStep | Hardened
