"""Engines that say something wrong of themselves: what the checks of `engines.conformance.members` have to find."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any

from engines import Around, Engine, Softness, Unpromised
from engines.pymunk import LEAPFROG
from reference.joints import Joint, Skate
from reference.mechanism import Mechanism
from tests.wrong.adapters import Wrong


@dataclass(frozen=True)
class TwoLines(Wrong):
    family: str = "two\nlines"  # pyright: ignore[reportIncompatibleMethodOverride]


@dataclass
class Changeable(Around):
    """Not frozen."""

    variant: str = "changeable"
    engine: Engine = LEAPFROG
    name: str = "wrong"  # pyright: ignore[reportIncompatibleMethodOverride]

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        return self.engine.build(mechanism, dt)

    __hash__ = object.__hash__


@dataclass(frozen=True)
class Hiding(Wrong):
    iterations: int = field(default=10, repr=False)


@dataclass(frozen=True)
class Listing(Wrong):
    levels: list[int] = field(default_factory=lambda: [1, 2])


def local() -> Any:
    """An engine of a class that no other process finds."""

    @dataclass(frozen=True)
    class Local(Wrong):
        pass

    return Local("nothing")


@dataclass(frozen=True)
class Forgetful(Wrong):
    """What is no field is lost when it travels."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "_factor", 0.5)

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update({**state, "_factor": 1.0})

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        return self.engine.build(replace(mechanism, gravity=(0.0, vars(self)["_factor"] * mechanism.gravity[1])), dt)


@dataclass(frozen=True)
class Imported(Wrong):
    packages: tuple[str, ...] = ("_pymunk_cffi_backend",)  # pyright: ignore[reportIncompatibleMethodOverride]


@dataclass(frozen=True)
class Numbered(Wrong):
    def order(self, mechanism: Mechanism) -> Any:
        return 2


@dataclass(frozen=True)
class Speechless(Wrong):
    def order(self, mechanism: Mechanism) -> Any:
        return Unpromised("no")


@dataclass(frozen=True)
class Free(Wrong):
    def step_cost(self, mechanism: Mechanism) -> float:
        return 0.0


@dataclass(frozen=True)
class Measured(Wrong):
    def step_cost(self, mechanism: Mechanism) -> float:
        return 1e-6 + 1e-9 * time.perf_counter()


@dataclass(frozen=True)
class Modest(Wrong):
    def holder(self, joint: Joint, mechanism: Mechanism) -> Any:
        return "us" if isinstance(joint, Skate) else "engine"


@dataclass(frozen=True)
class Rowless(Wrong):
    def softness(self, mechanism: Mechanism, dt: float) -> Softness:
        return Softness(1.0, 1.0, 0.0, (True,) * len(mechanism.joints))


@dataclass(frozen=True)
class Counting(Wrong):
    def steps_of_runs(self, mechanism: Mechanism) -> Any:
        return 5


TALKERS: dict[str, Any] = {
    "the family has two lines": TwoLines("nothing"),
    "it can be changed": Changeable(),
    "a setting is not shown": Hiding("nothing"),
    "a setting is a list": Listing("nothing"),
    "its class is local": local(),
    "what is no field is lost": Forgetful("nothing"),
    "a package has another name": Imported("nothing"),
    "the order is a number": Numbered("nothing"),
    "an order is refused in a word": Speechless("nothing"),
    "a step costs nothing": Free("nothing"),
    "a step's cost is measured": Measured("nothing"),
    "who holds a skate is told in another word": Modest("nothing"),
    "softness counts joints": Rowless("nothing"),
    "runs are counted instead of their steps": Counting("nothing"),
}
