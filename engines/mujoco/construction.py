"""What a joint that MuJoCo lacks is built from: parts added to the model, and hooks that run while it is stepped."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import mujoco

from engines.mujoco.stiffness import Stiffness
from engines.mujoco.written_rows import WrittenJoint
from engines.tree import Tree
from reference.mechanism import Mechanism

Callback = Callable[[Any, Any], None]  # (mujoco.MjModel, mujoco.MjData)


Reading = Callable[[Any, Any], tuple[Any, Any, Any]]


@dataclass(frozen=True)
class Hooks:
    """What runs while a model is stepped: callbacks in every stage, actions before every step, and one at the start.

    `read`, where the numbers at a sample don't mean one instant: from (model, data) as sampled it gives the positions,
    velocities and accelerations that belong to the sample's time.
    """

    control: tuple[Callback, ...] = ()
    passive: tuple[Callback, ...] = ()
    before: tuple[Callback, ...] = ()
    start: tuple[Callback, ...] = ()
    read: Reading | None = None

    def __add__(self, other: Hooks) -> Hooks:
        return Hooks(
            self.control + other.control,
            self.passive + other.passive,
            self.before + other.before,
            self.start + other.start,
            self.read or other.read,
        )


def in_turn(callbacks: Sequence[Callback]) -> Callback | None:
    """One callback that runs all of them; None for none, which costs nothing."""
    if len(callbacks) < 2:
        return callbacks[0] if callbacks else None

    def run(model: Any, data: Any) -> None:
        for callback in callbacks:
            callback(model, data)

    return run


def read_by_step(model: Any, data: Any) -> tuple[Any, Any, Any]:
    """A reading whose acceleration is what a whole step does to the velocity."""
    position, velocity = data.qpos.copy(), data.qvel.copy()
    mujoco.mj_step(model, data)
    return position, velocity, (data.qvel - velocity) / model.opt.timestep


# Given the compiled model and where each tree coordinate stands in qpos and qvel.
Binder = Callable[[Any, Sequence[int]], Hooks]


@dataclass
class Building:
    """A model while it is built. Constructions add to `spec`, to `written` (rows that callbacks will write, see
    `written_rows`) and to `binders` (called with the compiled model for hooks); `contact` asks for MuJoCo's contacts,
    `start_rates` says how fast further joints move at the start, `halves` which further bodies are cut off whose mass.
    """

    spec: Any  # mujoco.MjSpec, in which body i is called "body i" and tree coordinate c is "coordinate c"
    mechanism: Mechanism
    tree: Tree
    dt: float
    stiffness: Stiffness
    driven: tuple[int, ...]  # tree coordinates that turn at a prescribed rate
    written: list[WrittenJoint] = field(default_factory=list)
    binders: list[Binder] = field(default_factory=list)
    contact: bool = False
    rewritten: bool = False  # rows of equalities that stand here already are changed by callbacks
    start_rates: dict[str, float] = field(default_factory=dict)
    halves: list[tuple[str, int]] = field(default_factory=list)
    size: int = 0  # rows held by forces, those written not counted

    @property
    def writes(self) -> bool:
        """Whether callbacks write rows: the solver must then read them where they are written."""
        return bool(self.written) or self.rewritten

    def index(self, name: str | None) -> int | None:
        """A body's index, None for the ground."""
        return None if name is None else self.mechanism.body_index(name)
