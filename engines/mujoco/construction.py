"""What a joint that MuJoCo lacks is built from: parts added to the model, and hooks that run while it is stepped."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import mujoco

from engines.mujoco.stiffness import Stiffness
from engines.rolling_table import Rolled
from engines.tree import Tree, world_offset
from reference.mechanism import Mechanism

Callback = Callable[[Any, Any], None]  # (mujoco.MjModel, mujoco.MjData)
Law = Literal["skate", "slot", "rod", "roll"]


@dataclass(frozen=True)
class Hooks:
    """What runs while a model is stepped: in every stage of the integrator, and before every step."""

    control: Callback | None = None
    before: Callback | None = None

    def __add__(self, other: Hooks) -> Hooks:
        return Hooks(self.control or other.control, self.before or other.before)


# Given the compiled model and where each tree coordinate stands in qpos and qvel.
Binder = Callable[[Any, Sequence[int]], Hooks]


@dataclass(frozen=True)
class WrittenJoint:
    """A joint held by rows of ours: a law of `engines.mujoco.user_rows`, and the numbers that it asks for.

    `first` and `second` are names of bodies, None for the ground; `rolled` is where rolling puts the second.
    """

    law: Law
    first: str | None
    second: str | None
    numbers: tuple[float, ...]
    rolled: Rolled | None = None

    @property
    def size(self) -> int:
        return 2 if self.law == "roll" else 1


@dataclass
class Building:
    """A model while it is built. Constructions add to `spec`, to `written` (rows that a callback writes in every stage,
    see `user_rows`) and to `binders` (called with the compiled model for hooks); `contact` asks for MuJoCo's contacts,
    `start_rates` says how fast further joints move at the start, `halves` which further bodies are cut off whose mass.
    """

    spec: Any  # mujoco.MjSpec, in which body i is called "body i" and tree coordinate c is "coordinate c"
    mechanism: Mechanism
    tree: Tree
    dt: float
    stiffness: Stiffness
    written: list[WrittenJoint] = field(default_factory=list)
    binders: list[Binder] = field(default_factory=list)
    contact: bool = False
    start_rates: dict[str, float] = field(default_factory=dict)
    halves: list[tuple[str, int]] = field(default_factory=list)
    size: int = 0  # rows held by forces, those written not counted

    def index(self, name: str | None) -> int | None:
        """A body's index, None for the ground."""
        return None if name is None else self.mechanism.body_index(name)

    def carrier(self, name: str | None) -> Any:
        """The body, or the ground, in the model."""
        return self.spec.worldbody if name is None else self.spec.body(f"body {self.index(name)}")

    def add_site(self, name: str, body: str | None, point: tuple[float, float]) -> str:
        """A site at a body's own point [m]; its name."""
        self.carrier(body).add_site(name=name, pos=[*world_offset(self.mechanism, body, point), 0.0])
        return name

    def add_between(self, name: str, joint: Any) -> Any:
        """A spatial tendon between the first and the second point of a joint or a force element."""
        tendon = self.spec.add_tendon(name=name)
        tendon.wrap_site(self.add_site(f"{name} first", joint.first, joint.first_point))
        tendon.wrap_site(self.add_site(f"{name} second", joint.second, joint.second_point))
        return tendon

    def add_sum(self, name: str, signs: Mapping[int, float]) -> Any:
        """A fixed tendon: the sum of tree coordinates with these signs."""
        tendon = self.spec.add_tendon(name=name)
        for column, sign in sorted(signs.items()):
            tendon.wrap_joint(f"coordinate {column}", sign)
        return tendon

    def hold(self, kind: Any, first: str, second: str = "", rows: int = 1) -> Any:
        """An equality of this mjtEq, as stiff as the settings say, that counts for so many rows of the mechanism."""
        of_tendon = kind == mujoco.mjtEq.mjEQ_TENDON
        self.size += rows
        return self.spec.add_equality(
            type=kind,
            objtype=mujoco.mjtObj.mjOBJ_TENDON if of_tendon else mujoco.mjtObj.mjOBJ_BODY,
            name1=first,
            name2=second,
            solref=list(self.stiffness.reference(self.mechanism, self.dt)),
            solimp=list(self.stiffness.impedance),
        )

    def hold_tendon(self, name: str) -> None:
        """Keep a tendon as long as it is at the start."""
        self.hold(mujoco.mjtEq.mjEQ_TENDON, name)

    def write(self, law: Law, joint: Any, numbers: Sequence[float], rolled: Rolled | None = None) -> None:
        """Rows of ours for this joint."""
        self.written.append(WrittenJoint(law, joint.first, joint.second, tuple(numbers), rolled))

    def chain(self, joint: WrittenJoint) -> list[int]:
        """The tree coordinates that can move a joint, ascending."""
        links, columns = {link.body: link for link in self.tree.links}, set[int]()
        for name in (joint.first, joint.second):
            body = self.index(name)
            while body is not None:
                columns.update(links[body].columns)
                body = links[body].parent
        return sorted(columns)

    @property
    def gains(self) -> tuple[float, float]:
        """Stiffness [1/s^2] and damping [1/s] of a row."""
        return self.stiffness.gains(self.mechanism, self.dt)
