"""A skate that slips when it would have to give more than a limit: the friction loss of MuJoCo's tendon."""

from __future__ import annotations

from dataclasses import dataclass

from engines.mujoco.engine import MuJoCo
from engines.mujoco.methods import SKATES
from engines.mujoco.model import Model
from reference.checks import Positive, validated
from reference.mechanism import Mechanism

_FRICTION = next(engine for engine in SKATES if engine.variant == "tendon friction")


@dataclass(frozen=True)
class LimitedTendon(MuJoCo):
    """A tendon whose friction gives way beyond `limit` [N]."""

    limit: Positive = 1.0

    def model(self, mechanism: Mechanism, dt: Positive, as_text: bool = False) -> Model:
        model = super().model(mechanism, dt, as_text)
        model.compiled.tendon_frictionloss[:] = self.limit / model.unit
        return model


@validated
def limited_tendon(limit: Positive) -> LimitedTendon:
    """The tendon with a limit [N] on its friction."""
    settings = {name: value for name, value in vars(_FRICTION).items() if name != "variant"}
    return LimitedTendon("tendon with friction loss", **settings, limit=limit)
