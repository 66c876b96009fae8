"""The engine with exact multipliers: settings and convergence orders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, get_args

from engines import EXACT, ConvergenceOrder, Enforcement, Engine, NotDeclared, Regularisation
from engines.lagrange.loading import compiled, installed
from engines.lagrange.running import LagrangeRun
from engines.motions import is_prescribed, over_three
from reference.checks import InvalidMechanism, Positive, Valid, validated
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.validators import Rule

Integrator = Literal["euler", "rk4", "dop853"]
Stabilisation = Literal["none", "baumgarte", "projection"]
Tolerance = Annotated[float, Rule(lambda value: 1e-14 <= value < 1, "from 1e-14 to below 1")]

INTEGRATOR_ORDERS: dict[Integrator, int] = {"euler": 1, "rk4": 4, "dop853": 8}
# Time constant of Baumgarte's correction in steps, as in the tuned variant of MuJoCo.
BAUMGARTE_STEPS = 5.0
# Nominal CPU time [s] of a step of three bodies, with and without compiled code. The published steps depend on it.
# Therefore the nominal time stays unchanged, although the compiled code now takes a third of this time.
STEP_COSTS: dict[bool, dict[Integrator, float]] = {
    True: {"euler": 4e-6, "rk4": 8e-6, "dop853": 2e-5},
    False: {"euler": 2e-4, "rk4": 6e-4, "dop853": 1.5e-3},
}


@dataclass(frozen=True)
class Lagrange(Engine, Valid):
    """Ideal constraints by exact multipliers. Raises ValueError for settings that don't exist.

    integrator: "euler" (semi-implicit, order 1), "rk4" (order 4) or "dop853" (order 8).
    stabilisation: "none" (gaps grow), "baumgarte" (springs and dampers that depend on the step) or "projection" (after
        each step).
    tolerance: None for fixed steps of dt, or the relative and absolute tolerance of adaptive steps of "dop853"; dt is
        then the time between samples. To estimate the error of a run, compare it with a run at another tolerance.
    compiled: whether steps are machine code if numba is installed; otherwise they are computed in numpy.
    """

    name = "lagrange"

    integrator: Integrator = "dop853"
    stabilisation: Stabilisation = "projection"
    tolerance: Tolerance | None = None
    compiled: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tolerance is not None and (self.integrator != "dop853" or self.stabilisation == "baumgarte"):
            raise InvalidMechanism(
                "lagrange: a tolerance needs dop853 without baumgarte, since other methods have fixed steps"
            )

    @property
    def packages(self) -> tuple[str, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        return ("numpy", "scipy", "numba") if self.in_machine_code else ("numpy", "scipy")

    @property
    def in_machine_code(self) -> bool:
        return self.compiled and installed()

    def prepare(self) -> None:
        if self.in_machine_code:
            compiled()

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The integrator's order. With a projection, gaps are zero and a prescribed motion has no error.

        The stiffness of Baumgarte's spring is proportional to 1/dt^2. Therefore poses lose up to two orders, and
        reactions may not converge.
        """
        if self.tolerance is not None:
            return NotDeclared("its steps are adaptive, so the error depends on the tolerance and not on dt")
        order, prescribed = INTEGRATOR_ORDERS[self.integrator], is_prescribed(mechanism)
        match self.stabilisation:
            case "projection":
                return ConvergenceOrder(EXACT) if prescribed else ConvergenceOrder(order, gap=EXACT, slip=EXACT)
            case "baumgarte" if order == 1:
                return (
                    ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1)
                    if prescribed
                    else ConvergenceOrder(1, gap=2)
                )
            case "baumgarte" if order == 4:
                return ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=0)
            case "baumgarte":
                return ConvergenceOrder(order - 2)
            case "none":
                return ConvergenceOrder(order)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """The nominal CPU time [s] of a step, which does not depend on whether numba is installed."""
        return STEP_COSTS[self.compiled][self.integrator] * over_three(mechanism)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return "engine"

    @property
    def variant(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        adaptive, slow = " adaptive" * (self.tolerance is not None), " in numpy" * (not self.compiled)
        return f"{self.integrator} {self.stabilisation}{adaptive}{slow}"

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """Baumgarte's critically damped spring and damper in each row, or None for other methods."""
        if self.stabilisation != "baumgarte":
            return None
        rate = 1 / (BAUMGARTE_STEPS * dt)
        return Regularisation(rate**2, 2 * rate, 0.0, (True,) * mechanism.row_count)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> LagrangeRun:
        return LagrangeRun(self, mechanism, dt)


METHODS = tuple(
    Lagrange(integrator, stabilisation)
    for integrator in get_args(Integrator)
    for stabilisation in get_args(Stabilisation)
)
VARIANTS = (Lagrange("euler", "projection"), Lagrange("rk4", "projection"), Lagrange("dop853", "projection"))
