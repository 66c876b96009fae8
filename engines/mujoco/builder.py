"""The builder of a MuJoCo model, to which constructions add joints and force elements."""

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

Callback = Callable[[Any, Any], None]  # a function of (mujoco.MjModel, mujoco.MjData)
RowKind = Literal["skate", "slot", "rod", "roll"]
PLACEHOLDER = "written row"  # tendons with this name and a number reserve rows of the solver


@dataclass(frozen=True)
class Hooks:
    control: Callback | None = None  # MuJoCo's callback `mjcb_control`
    before_step: Callback | None = None

    def __add__(self, other: Hooks) -> Hooks:
        return Hooks(self.control or other.control, self.before_step or other.before_step)

    def __bool__(self) -> bool:
        return bool(self.control or self.before_step)


# A function of the compiled model and the indices of the tree coordinates in qpos and qvel.
HookMaker = Callable[[Any, Sequence[int]], Hooks]


@dataclass(frozen=True)
class UserRowJoint:
    """A joint whose rows our code writes.

    `numbers`: the arguments of the function in `user_rows` that writes this kind of row.
    """

    kind: RowKind
    first: str | None  # name of a body, or None for the ground
    second: str | None
    numbers: tuple[float, ...]
    rolled: Rolled | None = None  # position of a Roll's second body as a function of the rotation

    @property
    def size(self) -> int:
        return 2 if self.kind == "roll" else 1


@dataclass(frozen=True)
class DrivenCoordinate:
    column: int
    rate: float  # rad/s


@dataclass
class ModelBuilder:
    """A MuJoCo specification, and data of the model that the specification does not contain.

    In the specification, body i of the mechanism is "body i" and tree coordinate c is the joint "coordinate c".
    """

    spec: Any  # mujoco.MjSpec
    mechanism: Mechanism
    tree: Tree
    dt: float
    settings: MuJoCo
    row_count: int = 0  # number of the mechanism's rows that MuJoCo's constraints enforce
    needs_contacts: bool = False
    user_rows: list[UserRowJoint] = field(default_factory=list)
    hook_makers: list[HookMaker] = field(default_factory=list)
    driven: list[DrivenCoordinate] = field(default_factory=list)
    start_rates: dict[str, float] = field(default_factory=dict)  # Rates at t = 0 of joints that are no tree coordinate.
    clocks: list[str] = field(default_factory=list)  # Joints outside the tree that no force can accelerate.
    # Names of auxiliary bodies, each with the index of the body from which it was split.
    split_bodies: list[tuple[str, int]] = field(default_factory=list)

    @property
    def stiffness(self) -> Stiffness:
        return self.settings.stiffness

    @property
    def gains(self) -> tuple[float, float]:
        return self.stiffness.gains(self.mechanism, self.dt)

    def index(self, name: str | None) -> int | None:
        return None if name is None else self.mechanism.body_index(name)

    def spec_name(self, name: str | None) -> str:
        return "world" if name is None else f"body {self.index(name)}"

    def spec_body(self, name: str | None) -> Any:
        return self.spec.body(self.spec_name(name))

    def add_site(self, name: str, body: str | None, point: tuple[float, float]) -> str:
        self.spec_body(body).add_site(name=name, pos=[*world_offset(self.mechanism, body, point), 0.0])
        return name

    def add_spatial_tendon(self, name: str, element: Any) -> Any:
        tendon = self.spec.add_tendon(name=name)
        tendon.wrap_site(self.add_site(f"{name} first", element.first, element.first_point))
        tendon.wrap_site(self.add_site(f"{name} second", element.second, element.second_point))
        return tendon

    def add_fixed_tendon(self, name: str, factors: Mapping[int, float]) -> Any:
        tendon = self.spec.add_tendon(name=name)
        for column, factor in sorted(factors.items()):
            tendon.wrap_joint(f"coordinate {column}", factor)
        return tendon

    def add_equality(self, kind: Any, first: str, second: str = "", rows: int = 1) -> Any:
        """Add an equality of a `kind` (mjtEq), which enforces a number of the mechanism's `rows`."""
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
        self.add_equality(mujoco.mjtEq.mjEQ_TENDON, tendon)

    def hold_sum(self, name: str, factors: Mapping[int, float]) -> None:
        """Keep a sum of tree coordinates at its initial value, unless all factors are zero."""
        nonzero = {column: factor for column, factor in factors.items() if factor}
        if nonzero:
            self.add_fixed_tendon(name, nonzero)
            self.hold_length(name)

    def add_user_rows(self, kind: RowKind, joint: Any, numbers: Sequence[float], rolled: Rolled | None = None) -> None:
        self.user_rows.append(UserRowJoint(kind, joint.first, joint.second, tuple(numbers), rolled))

    def moving_columns(self, joint: UserRowJoint) -> list[int]:
        """The tree coordinates that move a body of the joint, in ascending order."""
        links = (link for name in (joint.first, joint.second) for link in self.tree.path_to_ground(name))
        return sorted({column for link in links for column in link.columns})

    def reserve_user_rows(self) -> None:
        """Reserve the last solver rows for `user_rows`; no equality may be added afterwards.

        Equalities of tendons reserve the rows, since each tendon has a separate scale of compliance
        (`tendon_invweight0`).
        """
        columns = [self.moving_columns(joint)[0] for joint in self.user_rows for _ in range(joint.size)]
        for number, column in enumerate(columns):
            name, impedance = f"{PLACEHOLDER} {number}", list(self.stiffness.impedance)
            self.add_fixed_tendon(name, {column: 1.0})
            tendon, kind = mujoco.mjtObj.mjOBJ_TENDON, mujoco.mjtEq.mjEQ_TENDON
            self.spec.add_equality(type=kind, objtype=tendon, name1=name, solimp=impedance)


def add_body(parent: Any, name: str, mass: float, inertia: float, position: Sequence[float] = (0.0, 0.0)) -> Any:
    """Add a rigid body to a parent. `position` [m]: centre of mass in the frame of the parent.

    Only the moment of inertia about z affects planar motion. MuJoCo's checks accept three equal moments.
    """
    return parent.add_body(
        name=name,
        pos=[*position, 0.0],
        ipos=[0.0, 0.0, 0.0],  # otherwise MuJoCo adds `pos` to the centre of mass twice
        mass=mass,
        inertia=[inertia] * 3,
        explicitinertial=True,
    )


def add_slide(body: Any, name: str, direction: Sequence[float]) -> None:
    body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[*direction, 0.0])


def add_hinge(body: Any, name: str, anchor: Sequence[float] = (0.0, 0.0), armature: float = 0.0) -> None:
    """Add a hinge about a point [m] in the frame of a body. `armature` [kg m^2] is added to the inertia."""
    hinge = mujoco.mjtJoint.mjJNT_HINGE
    body.add_joint(name=name, type=hinge, axis=[0.0, 0.0, 1.0], pos=[*anchor, 0.0], armature=armature)
