"""The MuJoCo engine as a value: its settings, what they may be, and the variants and methods that the report shows."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import itertools
import time
from dataclasses import dataclass, field, replace
from typing import Literal

import mujoco

from engines import Holder, Promise, Size, Softness, Unpromised
from engines.finer import Division, division
from engines.motions import over_three
from engines.mujoco import theory
from engines.mujoco.joints.drive import DriveBy
from engines.mujoco.joints.rod_gear_weld import RodBy
from engines.mujoco.joints.roll import CompletedContact, RollBy, RollContact, RollEquality
from engines.mujoco.joints.skate import STEPWISE, SkateBy, slip_damping
from engines.mujoco.joints.slot import SlotBy
from engines.mujoco.model import Coordinates, Model, Settings, build_model
from engines.mujoco.running import MuJoCoRun
from engines.mujoco.solver_check import choose_solver, ease
from engines.mujoco.stiffness import Hardened, Shipped, Stiffness, TiedToStep
from engines.mujoco.written_file import as_text
from engines.tree import Tree, spanning_tree
from reference.checks import Count, InvalidMechanism, Name, NonNegative, Positive, Valid, validated
from reference.joints import Joint, Rod, Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Integrator = Literal["Euler", "RK4", "implicit", "implicitfast", "discrete"]
Solver = Literal["Newton", "CG", "PGS"]
Factorisation = Literal["auto", "dense", "sparse"]


@dataclass(frozen=True)
class MuJoCo(Valid):
    """A mechanism in MuJoCo; every field but `variant` is a setting.

    `coordinates`: "tree" hinges bodies on one another and closes only the loops, "free" gives every body three
    coordinates and makes every pin a constraint. `drive`: a driven joint turns steadily because nothing can accelerate
    it, with `armature` times the mechanism's own inertia ("inertia"; the rate is missed by about 0.1 / armature); or by
    a velocity servo of `servo_gain` [N m s/rad]; or because its state is overwritten after every step, which the solver
    is not told ("overwrite"; measured in `engines.mujoco.joints.drive`). `solvers` are tried at the start in this
    order, and the first that solves it is taken. `tolerance`: MuJoCo's, relative to the inertia of what is not driven.
    `rolls`: what holds a rolling contact, `rods` a rod. `skates`: see `engines.mujoco.joints.skate`;
    `euler_for_skates`: rows that change once a step are stepped by Euler, whatever the integrator otherwise, since four
    stages of the same stale row cost more and gain nothing. `estimates`: a run of steps twice as long, and where
    that leaves it open one of half steps, tell the error, if it falls with the fourth power of the step; where it is
    above `engines.CLAIM` the motion is unresolved. A motion that becomes faster than its start lets expect takes more
    steps (`engines.finer`), unless its estimate shows that it needs none.
    Raises ValueError for a setting that MuJoCo would not understand.
    """

    variant: Name
    integrator: Integrator = "Euler"
    stiffness: Stiffness = field(default_factory=Shipped)
    coordinates: Coordinates = "tree"
    drive: DriveBy = "inertia"
    armature: Positive = 1e8
    servo_gain: Positive = 10.0
    solvers: tuple[Solver, ...] = ("Newton",)
    iterations: Count = 100
    tolerance: NonNegative = 1e-8
    jacobian: Factorisation = "auto"
    islands: bool = True
    slots: SlotBy = "halves"
    skates: SkateBy = "blade"
    euler_for_skates: bool = True
    rolls: RollBy = field(default_factory=RollContact)
    estimates: bool = False
    rods: RodBy = "tendon"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.solvers:
            raise InvalidMechanism("MuJoCo: solvers is (); it must be a tuple of at least one of Newton, CG and PGS")

    @property
    def name(self) -> str:
        return "mujoco"

    @property
    def packages(self) -> tuple[str, ...]:
        return ("mujoco-core",)

    @property
    def family(self) -> str:
        return "mujoco"

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """See `engines.mujoco.theory`."""
        return theory.promise(self, mechanism, self._tree(mechanism))

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About how long a step takes [s]: a completed contact is read and written entry by entry in every stage."""
        return (40e-6 if isinstance(self.rolls, CompletedContact) else 12e-6) * over_three(mechanism)

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """See `engines.mujoco.theory`."""
        return theory.holder(self, joint, self._tree(mechanism))

    def _tree(self, mechanism: Mechanism) -> Tree:
        return spanning_tree(mechanism, hanging=self.coordinates == "tree")

    def softness(self, mechanism: Mechanism, dt: float) -> Softness | None:
        """How loops, skates and rolls give way with steps of dt [s]; None where the tree holds every joint."""
        tree = self._tree(mechanism)
        soft = [tree.closes_by(joint) or isinstance(joint, Skate | Roll) for joint in mechanism.joints]
        if not any(soft):
            return None
        stiffness, rolling = self.stiffness, any(isinstance(joint, Roll) for joint in mechanism.joints)
        if rolling and isinstance(self.rolls, RollContact):
            stiffness = Shipped() if self.rolls.steps is None else TiedToStep(self.rolls.steps)
        lacking = rolling and isinstance(self.rolls, RollContact | RollEquality)
        skating = any(isinstance(joint, Skate) for joint in mechanism.joints)
        lacking |= skating and self.skates in ("blade", "wheel", "servo", "tendon", "tendon friction")
        lacking |= self.rods == "tendon" and any(isinstance(joint, Rod) for joint in mechanism.joints)
        gain, damping = stiffness.gains(mechanism, dt)
        if self.skates == "rows" and all(
            isinstance(joint, Skate) for joint in itertools.compress(mechanism.joints, soft)
        ):
            damping = slip_damping(mechanism)  # which such a row brings along, whatever the springs of loops have
        # The impedance of a gap of a millimetre and more; as shipped a closed gap is about twice as soft.
        compliance = (1 - stiffness.impedance[1]) / stiffness.impedance[1] * stiffness.softening
        rows = tuple(which for joint, which in zip(mechanism.joints, soft, strict=True) for _ in range(joint.size))
        return Softness(gain, damping, compliance, rows, complete=not lacking)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> MuJoCoRun:
        """See the contract of `engines`. Raises Unsupported, or ValueError for a bad step."""
        model = self.model(mechanism, dt)
        data = model.start()
        size = Size(
            bodies=model.compiled.nbody - 1,
            coordinates=model.compiled.nq,
            rows=model.rows + (len(model.driven) if self.drive != "overwrite" else 0),
            solver_rows=data.nefc,
        )
        promised = self.order(mechanism) if self.estimates else None
        fourth = isinstance(promised, Promise) and promised.order >= theory.ORDER
        if not fourth:
            return MuJoCoRun(model, data, size)

        def plain(other: float) -> MuJoCoRun:
            return replace(self.build(mechanism, other), divided=None)

        if all(isinstance(joint, Roll) for joint in mechanism.joints):
            return MuJoCoRun(model, data, size, plain)  # how far a contact turns in a step is known, and told

        def divided(duration: float) -> Division:
            return division(self, lambda own: plain(own).roughly, mechanism, duration, theory.ORDER, finest=64)

        return MuJoCoRun(model, data, size, plain, divided)

    @validated
    def model(self, mechanism: Mechanism, dt: Positive, as_text: bool = False) -> Model:
        """The compiled model alone; `as_text`: from text of ours with all digits, in kg, which `written_as` keeps."""
        return self._model(mechanism, dt, as_text)

    @validated
    def text(self, mechanism: Mechanism, dt: Positive) -> str:
        """MJCF that runs without this suite, in kg, with the start as its keyframe.

        Raises Unsupported where rows are written, or compliances changed, while or before it is stepped.
        """
        return as_text(self._model(mechanism, dt, as_text=True), self.stiffness.softening)

    def _model(self, mechanism: Mechanism, dt: float, as_text: bool) -> Model:
        stepwise = self.skates in STEPWISE and any(isinstance(joint, Skate) for joint in mechanism.joints)
        integrator = "Euler" if stepwise and self.euler_for_skates else self.integrator
        options = {
            "integrator": getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}"),
            "jacobian": getattr(mujoco.mjtJacobian, f"mjJAC_{self.jacobian.upper()}"),
            "iterations": self.iterations,
            "tolerance": self.tolerance,
        }
        settings = Settings(
            options,
            self.islands,
            self.stiffness,
            self.coordinates,
            self.drive,
            self.armature,
            self.servo_gain,
            self.slots,
            self.skates,
            self.rolls,
            self.rods,
            as_text,
        )
        model = build_model(mechanism, dt, settings)
        start = choose_solver(model, self.solvers)
        if isinstance(self.stiffness, Hardened) and self.stiffness.eased:
            ease(model, self.stiffness.softening, start)
        return model


@validated
def bare_loop(engine: MuJoCo, mechanism: Mechanism, dt: Positive, steps: Count) -> float:
    """CPU seconds of the plainest loop over `mj_step`: what any user pays, to hold a run's cost against."""
    model = engine.model(mechanism, dt)
    compiled, data, advance = model.compiled, model.start(), mujoco.mj_step
    begin = time.process_time()
    for _ in range(steps):
        advance(compiled, data)
    return time.process_time() - begin
