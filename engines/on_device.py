"""The base class of engines that step MuJoCo's model by another implementation, on a processor or a GPU.

Our MuJoCo adapter compiles the MjModel with the same settings, so only the implementation differs from `mujoco`. The
other implementations have no callbacks, so models with callbacks are refused. Skates and rolling are refused too, since
these adapters build no contact.
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
    """The capability of our MuJoCo adapter without contacts; `title` is the engine's name in sentences."""
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
    """settings: MuJoCo method that provides the model and options.
    title: the engine's name in sentences.
    evaluation_cost: CPU time [s] of an evaluation of three bodies, without compilation.
    """

    title: ClassVar[str]
    evaluation_cost: ClassVar[float]
    build_time: ClassVar[float] = 20.0

    variant: Name
    settings: MuJoCo = field(default_factory=lambda: C_DEFAULT)

    def order_without_loops(self, mechanism: Mechanism) -> ConvergenceOrder:
        if turns_steadily(mechanism) or is_prescribed(mechanism):
            return ConvergenceOrder(EXACT)
        return ConvergenceOrder(4 if self.settings.integrator == "RK4" else 1, gap=EXACT, slip=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        return self.evaluation_cost * (4 if self.settings.integrator == "RK4" else 1) * over_three(mechanism)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return self.settings.enforcement(joint, mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        return self.settings.regularisation(mechanism, dt)

    def compiled(self, mechanism: Mechanism, dt: float, unit: float | None = None) -> MuJoCoModel:
        """The model of our MuJoCo adapter with masses in `unit` [kg]; raises Unsupported for a model with callbacks."""
        model = self.settings.model(mechanism, dt, unit)
        if model.hooks:
            raise Unsupported(f"some rows are written by callbacks of MuJoCo's C code, which {self.title} does not run")
        return model

    def refusal(self, reason: Exception) -> Unsupported:
        return Unsupported(f"{self.title} does not run this model: {' '.join(str(reason).split())}")


def size_of(model: MuJoCoModel, solver_rows: int) -> Size:
    return Size(model.compiled.nbody - 1, model.compiled.nq, model.rows + len(model.driven), solver_rows)
