"""The MuJoCo model of a mechanism while its joints and force elements are added."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import mujoco

from engines.mujoco.stiffness import Stiffness
from engines.rolling_table import Rolled
from engines.tree import Tree, world_offset
from reference.mechanism import Mechanism

if TYPE_CHECKING:
    from engines.mujoco.engine import MuJoCo

Callback = Callable[[Any, Any], None]  # of (mujoco.MjModel, mujoco.MjData)
RowKind = Literal["skate", "slot", "rod", "roll"]
PLACEHOLDER = "written row"  # the name, before a number, of the tendons that reserve the solver's rows


@dataclass(frozen=True)
class Hooks:
    """Functions of ours that run while a model is stepped.

    `control`: in every stage of the integrator (MuJoCo's `mjcb_control`); `before_step`: before every step.
    """

    control: Callback | None = None
    before_step: Callback | None = None

    def __add__(self, other: Hooks) -> Hooks:
        return Hooks(self.control or other.control, self.before_step or other.before_step)

    def __bool__(self) -> bool:
        return bool(self.control or self.before_step)


# A function of the compiled model and the index of each tree coordinate in qpos and qvel.
HookMaker = Callable[[Any, Sequence[int]], Hooks]


@dataclass(frozen=True)
class UserRowJoint:
    """A joint held by rows that our code writes: their kind and the numbers of its function in `user_rows`.

    `first` and `second` are names of bodies, None for the ground; `rolled`: the place of a rolling second body.
    """

    kind: RowKind
    first: str | None
    second: str | None
    numbers: tuple[float, ...]
    rolled: Rolled | None = None

    @property
    def size(self) -> int:
        return 2 if self.kind == "roll" else 1


@dataclass(frozen=True)
class DrivenCoordinate:
    """A tree coordinate that turns at a prescribed rate [rad/s]."""

    column: int
    rate: float


@dataclass
class ModelBuilder:
    """A MuJoCo specification, and the parts of the model that it does not contain.

    In `spec` (mujoco.MjSpec) body i of the mechanism is "body i", and tree coordinate c is the joint "coordinate c".
    `row_count`: rows of the mechanism that MuJoCo's constraints hold. `user_rows`: joints whose rows our code writes in
    every stage. `start_rates`: rates at t = 0 of joints that are no tree coordinate; `clocks`: those of them that no
    force can accelerate. `split_bodies`: auxiliary bodies, and the body of the mechanism from which each was split.
    """

    spec: Any
    mechanism: Mechanism
    tree: Tree
    dt: float
    settings: MuJoCo
    row_count: int = 0
    needs_contacts: bool = False
    user_rows: list[UserRowJoint] = field(default_factory=list)
    hook_makers: list[HookMaker] = field(default_factory=list)
    driven: list[DrivenCoordinate] = field(default_factory=list)
    start_rates: dict[str, float] = field(default_factory=dict)
    clocks: list[str] = field(default_factory=list)
    split_bodies: list[tuple[str, int]] = field(default_factory=list)

    @property
    def stiffness(self) -> Stiffness:
        return self.settings.stiffness

    @property
    def gains(self) -> tuple[float, float]:
        """Stiffness [1/s^2] and damping [1/s] of a row."""
        return self.stiffness.gains(self.mechanism, self.dt)

    def index(self, name: str | None) -> int | None:
        """The index of a body in the mechanism, None for the ground."""
        return None if name is None else self.mechanism.body_index(name)

    def spec_name(self, name: str | None) -> str:
        """The name in the specification of a body, or of the ground."""
        return "world" if name is None else f"body {self.index(name)}"

    def spec_body(self, name: str | None) -> Any:
        """The body, or the ground, in the specification."""
        return self.spec.body(self.spec_name(name))

    def add_site(self, name: str, body: str | None, point: tuple[float, float]) -> str:
        """Add a site at a point in a body's frame [m]; returns its name."""
        self.spec_body(body).add_site(name=name, pos=[*world_offset(self.mechanism, body, point), 0.0])
        return name

    def add_spatial_tendon(self, name: str, element: Any) -> Any:
        """Add a tendon between the first and the second point of a joint or a force element."""
        tendon = self.spec.add_tendon(name=name)
        tendon.wrap_site(self.add_site(f"{name} first", element.first, element.first_point))
        tendon.wrap_site(self.add_site(f"{name} second", element.second, element.second_point))
        return tendon

    def add_fixed_tendon(self, name: str, factors: Mapping[int, float]) -> Any:
        """Add a tendon whose length is the sum of tree coordinates with these factors."""
        tendon = self.spec.add_tendon(name=name)
        for column, factor in sorted(factors.items()):
            tendon.wrap_joint(f"coordinate {column}", factor)
        return tendon

    def add_equality(self, kind: Any, first: str, second: str = "", rows: int = 1) -> Any:
        """Add an equality of this mjtEq by the stiffness settings, which holds `rows` rows of the mechanism."""
        is_tendon = kind == mujoco.mjtEq.mjEQ_TENDON
        self.row_count += rows
        return self.spec.add_equality(
            type=kind,
            objtype=mujoco.mjtObj.mjOBJ_TENDON if is_tendon else mujoco.mjtObj.mjOBJ_BODY,
            name1=first,
            name2=second,
            solref=list(self.stiffness.reference(self.mechanism, self.dt)),
            solimp=list(self.stiffness.impedance),
        )

    def hold_length(self, tendon: str) -> None:
        """Hold a tendon at its length at the start."""
        self.add_equality(mujoco.mjtEq.mjEQ_TENDON, tendon)

    def add_user_rows(self, kind: RowKind, joint: Any, numbers: Sequence[float], rolled: Rolled | None = None) -> None:
        """Hold a joint by rows that our code writes."""
        self.user_rows.append(UserRowJoint(kind, joint.first, joint.second, tuple(numbers), rolled))

    def moving_columns(self, joint: UserRowJoint) -> list[int]:
        """The tree coordinates that move one of a joint's bodies, ascending."""
        links = (link for name in (joint.first, joint.second) for link in self.tree.path_to_ground(name))
        return sorted({column for link in links for column in link.columns})

    def reserve_user_rows(self) -> None:
        """Reserve solver rows for `user_rows`; to be called after every other equality, so that they come last.

        They are equalities of tendons, since each of these has a scale of compliance of its own (`tendon_invweight0`).
        """
        columns = [self.moving_columns(joint)[0] for joint in self.user_rows for _ in range(joint.size)]
        for number, column in enumerate(columns):
            name, impedance = f"{PLACEHOLDER} {number}", list(self.stiffness.impedance)
            self.add_fixed_tendon(name, {column: 1.0})
            tendon, kind = mujoco.mjtObj.mjOBJ_TENDON, mujoco.mjtEq.mjEQ_TENDON
            self.spec.add_equality(type=kind, objtype=tendon, name1=name, solimp=impedance)


def add_body(parent: Any, name: str, mass: float, inertia: float, position: Sequence[float] = (0.0, 0.0)) -> Any:
    """Add a rigid body with its centre of mass at `position` [m] in a parent of a specification.

    Only the last moment of inertia is felt in the plane. Three equal ones satisfy MuJoCo's checks.
    """
    return parent.add_body(
        name=name,
        pos=[*position, 0.0],
        ipos=[0.0, 0.0, 0.0],  # if it is not given, MuJoCo adds `pos` to the centre of mass once more
        mass=mass,
        inertia=[inertia] * 3,
        explicitinertial=True,
    )


def add_slide(body: Any, name: str, direction: Sequence[float]) -> None:
    """Let a body slide along a direction (2,) of the plane."""
    body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[*direction, 0.0])


def add_hinge(body: Any, name: str, anchor: Sequence[float] = (0.0, 0.0), armature: float = 0.0) -> None:
    """Let a body turn about a point [m] in its frame; `armature` [kg m^2] is added to its inertia."""
    hinge = mujoco.mjtJoint.mjJNT_HINGE
    body.add_joint(name=name, type=hinge, axis=[0.0, 0.0, 1.0], pos=[*anchor, 0.0], armature=armature)
