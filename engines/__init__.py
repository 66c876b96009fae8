"""The contract of an engine under test, and the one list of them.

1. An engine is a frozen dataclass; its fields are its settings, printed in the report. `variant` is a label of the
   user's choice: any string that is not empty and can be printed. Settings, steps and counts that can't be are refused
   by a ValueError, not by the engine's own abort: `reference.validation` does it for what inherits from `Valid`, and
   for `build` and `run` with `validated`.
2. `build(mechanism, dt)` makes a model of the mechanism at t = 0 for steps of dt [s], or raises Unsupported with a
   sentence. It sees no scene, so it can't see the answer.
3. `run(samples, every)` steps `samples * every` times and gives samples + 1 states, the first at t = 0. One shot: build
   again to repeat. Pose and twist belong to the same instant; reactions too, NaN where the engine can't tell.
4. `Trajectory.stepping` is the CPU time of the stepping loop, recording included; reading it out afterwards is not.
5. An engine that resets itself says when (`reset_at`), one that warns says so (`warnings`); both go on.
6. An engine whose joints give way may say how: `softness(mechanism, dt)` returns a Softness, or None where they don't.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reference.validation import Count, Positive


class Unsupported(Exception):
    """An engine can't build this mechanism; the message is one sentence that says why."""


@dataclass(frozen=True)
class Size:
    """What was modelled: to be held against the mechanism's own size."""

    bodies: int  # moving bodies
    coordinates: int  # position coordinates that the engine integrates
    rows: int  # scalar constraints that the engine holds by forces
    solver_rows: int  # rows in the engine's solver, empty ones included


@dataclass(frozen=True)
class Softness:
    """How joints give way: J a = bias - damping slip - stiffness gap - compliance A reaction.

    stiffness [1/s^2], damping [1/s]; compliance: a share of the row's own inverse inertia A. `rows`: which rows of the
    mechanism (rows,) are so, the others hold exactly. `complete`: whether `bias`, the term of the velocities, is there.
    """

    stiffness: float
    damping: float
    compliance: float
    rows: tuple[bool, ...]
    complete: bool = True


class Run(Protocol):
    """A built model, ready to be stepped once."""

    @property
    def size(self) -> Size: ...
    def __call__(self, samples: Count, every: Count) -> Trajectory: ...


@runtime_checkable
class Engine(Protocol):
    """See the module's numbered contract."""

    @property
    def name(self) -> str: ...
    @property
    def variant(self) -> str: ...
    def build(self, mechanism: Mechanism, dt: Positive) -> Run: ...
