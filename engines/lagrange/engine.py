"""Exact multipliers as an engine: its settings and its convergence orders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, get_args

from engines import EXACT, ConvergenceOrder, Enforcement, Engine, NotDeclared, Regularisation
from engines.lagrange.compiled_model import compile_functions
from engines.lagrange.loading import installed
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
# The time constant of Baumgarte's correction, in steps: the same rule as that of the tuned MuJoCo variant.
BAUMGARTE_STEPS = 5.0
# Nominal CPU time of a step of three bodies [s], by `compiled`: in compiled code, and in numpy. The grid of cells
# follows from it, so it is not adjusted to faster code, which takes a third of the first three today.
STEP_COSTS: dict[bool, dict[Integrator, float]] = {
    True: {"euler": 4e-6, "rk4": 8e-6, "dop853": 2e-5},
    False: {"euler": 2e-4, "rk4": 6e-4, "dop853": 1.5e-3},
}


@dataclass(frozen=True)
class Lagrange(Engine, Valid):
    """Ideal constraints by exact multipliers; raises ValueError for settings that don't exist.

    integrator: "euler" (semi-implicit, order 1), "rk4" (order 4), "dop853" (order 8), all with the given fixed step.
    stabilisation: "none" (the joints drift apart), "baumgarte" (a spring and a damper tied to the step) or "projection"
    (onto the joints after each step).
    tolerance: for "dop853" only, relative and absolute, for about the error that a step adds: steps are adaptive, and
    dt is the time between samples. The error of a run grows from it as any perturbation does; to estimate it, compare
    with a run at another tolerance.
    compiled: in machine code if numba is installed; False: in numpy, with the same numbers up to rounding.
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
                "lagrange: a tolerance goes with dop853, without baumgarte: only those adapt their steps"
            )

    @property
    def packages(self) -> tuple[str, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        return ("numpy", "scipy", "numba") if self.in_machine_code else ("numpy", "scipy")

    @property
    def in_machine_code(self) -> bool:
        """Whether runs are compiled."""
        return self.compiled and installed()

    def prepare(self) -> None:
        """Compile the functions of a run, or read their machine code, so that no run's CPU time contains this."""
        if self.in_machine_code:
            compile_functions(self.tolerance is not None)

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The integrator's order; a projection leaves no gap, and a prescribed motion no error at all.

        Baumgarte's spring has a stiffness of 1/dt^2. It turns a gap into an acceleration divided by the squared step:
        poses lose two orders, and reactions have none.
        """
        if self.tolerance is not None:
            return NotDeclared("its steps are its own: the error is that of its tolerance, whatever the step asked for")
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
        """The nominal CPU time of a step [s] with numba, also if it is not installed: the grid is the same then."""
        return STEP_COSTS[self.compiled][self.integrator] * over_three(mechanism)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """The engine itself: it is nothing but the ideal constraint."""
        return "engine"

    @property
    def variant(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        adaptive, slow = " adaptive" * (self.tolerance is not None), " in numpy" * (not self.compiled)
        return f"{self.integrator} {self.stabilisation}{adaptive}{slow}"

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """Baumgarte's spring and damper in each row, critically damped; None for the other methods."""
        if self.stabilisation != "baumgarte":
            return None
        rate = 1 / (BAUMGARTE_STEPS * dt)
        return Regularisation(rate**2, 2 * rate, 0.0, (True,) * mechanism.row_count)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> LagrangeRun:
        """A run with steps of dt [s]; raises ValueError for a step that is not a finite time above zero."""
        return LagrangeRun(self, mechanism, dt)


METHODS = tuple(
    Lagrange(integrator, stabilisation)
    for integrator in get_args(Integrator)
    for stabilisation in get_args(Stabilisation)
)
# For each scene: orders 1, 4 and 8.
VARIANTS = (Lagrange("euler", "projection"), Lagrange("rk4", "projection"), Lagrange("dop853", "projection"))
