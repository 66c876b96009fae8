"""The base of engines that run the model of our MuJoCo adapter by another implementation, on a processor or a GPU.

The model is the MjModel that the adapter compiles with the same settings, so that only the implementation differs from
`mujoco`. Callbacks of C code do not exist there, so models with callbacks are refused. Skates and rolling are refused
too, since these adapters build no contact.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability, Lack
from engines.contract import EXACT, ConvergenceOrder, Enforcement, Regularisation, Size, Unsupported
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.mujoco.engine import MuJoCo
from engines.mujoco.methods import DEFAULT as C_DEFAULT
from engines.mujoco.model import MUJOCO_CAPABILITY, MuJoCoModel
from engines.single_run import ExtraEngine
from reference.checks import Name, validated
from reference.joints import Joint, Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Array = NDArray[np.float64]


def without_contacts(engine: str, title: str) -> Capability:
    """The capability of our MuJoCo adapter without the joints that need a contact; `title`: the engine in sentences."""
    return Capability(
        engine,
        tuple(kind for kind in MUJOCO_CAPABILITY.joints if kind not in (Skate, Roll)),
        MUJOCO_CAPABILITY.forces,
        lacks={
            kind: Lack(f"a {kind.__name__.lower()} needs a contact, and our adapter of {title} builds none")
            for kind in (Skate, Roll)
        },
    )


@dataclass(frozen=True)
class MuJoCoOnDevice(ExtraEngine):
    """An engine in the sense of `engines.Engine`.

    settings: the MuJoCo method whose model and options are taken
    title: the engine's name in sentences
    evaluation_cost: CPU time [s] of an evaluation with three bodies, once compiled
    """

    title: ClassVar[str]
    evaluation_cost: ClassVar[float]
    build_time: ClassVar[float] = 20.0

    variant: Name
    settings: MuJoCo = field(default_factory=lambda: C_DEFAULT)

    def order_without_loops(self, mechanism: Mechanism) -> ConvergenceOrder:
        """The integrator's order."""
        if turns_steadily(mechanism) or is_prescribed(mechanism):
            return ConvergenceOrder(EXACT)
        return ConvergenceOrder(4 if self.settings.integrator == "RK4" else 1, gap=EXACT, slip=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """Approximate CPU time of a step [s], once compiled."""
        return self.evaluation_cost * (4 if self.settings.integrator == "RK4" else 1) * over_three(mechanism)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """As in MuJoCo."""
        return self.settings.enforcement(joint, mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """That of MuJoCo with these settings."""
        return self.settings.regularisation(mechanism, dt)

    def compiled(self, mechanism: Mechanism, dt: float, unit: float | None = None) -> MuJoCoModel:
        """The model of our MuJoCo adapter, with masses in this unit [kg]; raises Unsupported for one with callbacks."""
        model = self.settings.model(mechanism, dt) if unit is None else self.settings.model(mechanism, dt, unit=unit)
        if model.hooks:
            raise Unsupported(f"some rows are written by callbacks of MuJoCo's C code, which {self.title} does not run")
        return model

    def refusal(self, reason: Exception) -> Unsupported:
        """The refusal of a model that the implementation does not know."""
        return Unsupported(f"{self.title} does not run this model: {' '.join(str(reason).split())}")


def size_of(model: MuJoCoModel, solver_rows: int) -> Size:
    """The size of a compiled model."""
    return Size(model.compiled.nbody - 1, model.compiled.nq, model.rows + len(model.driven), solver_rows)
