"""MuJoCo's accelerations and forces at one instant against the law that its own model declares.

The judge has the mechanism's own rows J and their change, and of MuJoCo only what it says of its constraints: how stiff
a row is (`efc_KBIP`), how far it gives way (`efc_R`), and the armature of driven coordinates
(`declared`). Each of its rows has to be one of the mechanism's, seen in the coordinates of its tree.

MJX runs the same compiled model, so how far a row gives way is what MuJoCo says of it. It leaves out the velocity terms
of loops and rods, so of those it is asked for the law without. The later instant is one that MuJoCo steps to: what is
asked is not how MJX steps, and a second program would have to be compiled.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Softness
from engines.lagrange import TRUTH
from engines.mjx import Mjx, lacks_velocity_terms
from engines.mujoco import MuJoCo
from engines.mujoco.joints.skate import STEPWISE, slip_damping
from engines.mujoco.model import Model
from engines.tree import spanning_tree
from reference.joints import Drive, Joint, Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reports.gate.judge import in_numpy
from reports.search.law import (
    ROUNDINGS,
    Constrained,
    Fault,
    NotAsked,
    constrained,
    difference,
    driving_force,
    force_difference,
    ideal,
    rounded,
    turned_in_a_step,
)
from reports.search.raw_law import jacobian

Array = NDArray[np.float64]

# Of a row's length: what the sums of a chain of ten bodies leave.
SAME_ROW = 1e-9


def declared(
    mechanism: Mechanism, model: Model, data: Any, rows: Array, softness: Softness | None, pose: Array, twist: Array
) -> tuple[Array, Array, Array, Array]:
    """How the rows give way (rows, rows), what they aim at beside their velocity term, which of them the solver has,
    and how stiff each is [1/s^2], all as MuJoCo declares. Raises Fault where rows are lacking.
    """
    compiled = model.compiled
    give, aimed, stiff = np.zeros((len(rows), len(rows))), np.zeros(len(rows)), np.zeros(len(rows))
    solved = np.zeros(len(rows), dtype=bool)
    in_tree = rows @ directions(model, data)
    gap, slip = np.nan_to_num(mechanism.gap(pose, data.time)), mechanism.slip(pose, twist)
    length = np.where(mechanism.turning, 1.0, mechanism.length_scale)
    # What the coordinates of the tree can't move, but by rounding of arms, is held by them.
    rounding = ROUNDINGS * np.finfo(float).eps * float(np.abs(pose[:, :2]).max())
    loose = np.abs(in_tree).max(axis=1, initial=0.0) > SAME_ROW * length + rounding
    lines = jacobian(mujoco, compiled, data)
    seen, beside = model.address, [column for column in range(compiled.nv) if column not in model.address]
    waiting = [number for number, line in enumerate(lines) if np.linalg.norm(line) > SAME_ROW]  # one lies across
    begin = 0
    for joint in mechanism.joints:
        own = slice(begin, begin + joint.size)
        begin = own.stop
        if not loose[own].any():
            continue
        turned = np.flatnonzero(in_tree[own.start])
        if isinstance(joint, Drive) and len(turned) == 1 and compiled.dof_armature[turned[0]] > 0:
            # Its armature is a further inertia of this rotation alone: as a row, it gives way by the inverse.
            give[own, own] = 1 / np.sqrt(compiled.dof_armature[turned[0]] * model.unit)
            continue
        within = _within(lines[waiting][:, seen], in_tree[own][:, seen])
        found = [number for number, inside in zip(waiting, within, strict=True) if inside][: joint.size]
        if len(found) < joint.size:
            raise Fault(f"MuJoCo has {len(found)} constraints for {joint.name!r}, not {joint.size}")
        waiting, solved[own] = [number for number in waiting if number not in found], True
        # MuJoCo's rows are these times ours.
        factors = np.linalg.lstsq(in_tree[own][:, seen].T, lines[found][:, seen].T, rcond=None)[0].T
        # A clock beside the tree, by which a drive is geared, gives way by the inverse of its own inertia.
        clock = np.sum(lines[found][:, beside] ** 2 / compiled.dof_M0[beside], axis=1)
        give[own, own] = np.linalg.solve(factors, np.diag(np.sqrt((data.efc_R[found] + clock) / model.unit)))
        if softness is not None and _is_written(compiled, data.efc_id[found[0]]):
            # A row that callbacks write; a skate's brings a damping of its own.
            damping = slip_damping(mechanism) if isinstance(joint, Skate) else softness.damping
            aimed[own] = -softness.stiffness * gap[own] - damping * slip[own]
            stiff[own] = softness.stiffness
        else:  # each of MuJoCo's rows has a stiffness of its own
            stiffness, damping, impedance, _ = data.efc_KBIP[found].T
            # A clock is not quite where the rate would have it: forces accelerate even so large an inertia a little.
            ahead, faster = (lines[found][:, beside] @ late for late in _clocks_ahead(joint, data, beside))
            asked = -stiffness * impedance * (factors @ gap[own] + ahead) - damping * (factors @ slip[own] + faster)
            aimed[own] = np.linalg.solve(factors, asked)
            stiff[own] = np.max(stiffness * impedance)
    if waiting:
        raise Fault(f"constraint {waiting[0]} of MuJoCo's is none of the mechanism's rows")
    return give, aimed, solved, stiff


def _clocks_ahead(joint: Joint, data: Any, beside: list[int]) -> tuple[Array, Array]:
    """By what angles [rad] and rates [rad/s] clocks are ahead of a drive; they begin at zero."""
    rate = joint.turning_rate if isinstance(joint, Drive) else 0.0
    return data.qpos[beside] - rate * data.time, data.qvel[beside] - rate


def _is_written(compiled: Any, equality: int) -> bool:
    """Whether callbacks write the row of an equality, and not MuJoCo."""
    tendon = compiled.eq_type[equality] == mujoco.mjtEq.mjEQ_TENDON
    return bool(tendon and compiled.tendon(compiled.eq_obj1id[equality]).name.startswith("written row"))


def _within(lines: Array, rows: Array) -> NDArray[np.bool_]:
    """Which of these lines (lines,) are sums of the rows."""
    left = lines.T - rows.T @ np.linalg.lstsq(rows.T, lines.T, rcond=None)[0]
    return np.linalg.norm(left, axis=0) <= SAME_ROW * np.linalg.norm(lines, axis=1)


def directions(model: Model, data: Any) -> Array:
    """The twists (3 bodies, nv) that the coordinates' unit velocities are, in the pose of `data`."""
    count = model.tree.coordinates
    where = np.broadcast_to(data.qpos[model.address], (count, count))
    _, twists, _ = model.tree.motion(where, np.eye(count), np.zeros((count, count)))
    out = np.zeros((3 * len(model.mechanism.bodies), model.compiled.nv))
    out[:, model.address] = twists.reshape(count, -1).T
    return out


STEP = 0.01  # of the mechanism's own time scale
STEPS = 5  # after which the second instant lies: at the first one every coordinate of the tree is zero
# Rounding, and what it becomes where a model is hardened: the primal solver adds J^T J / R to the inertia.
LAW, ROUNDED = 1e-9, 1e-14
LOST_SPEED = 0.1  # of the fastest velocity: a method that misses more has lost the motion


def bound(engine: MuJoCo) -> float:
    """The error, relative to the largest acceleration or force, above which something is wrong."""
    return max(LAW, ROUNDED / engine.stiffness.softening)


def errors(engine: MuJoCo, mechanism: Mechanism) -> dict[str, float]:
    """By what accelerations and reactions miss the law, relative to the largest of each, at the start and a bit later.

    Raises NotAsked where the engine declares no law at an instant, Fault for a row that is lacking, and Unsupported.
    """
    dt = STEP * mechanism.time_scale
    refuse_without_a_law(engine, mechanism, dt)
    run = replace(engine, estimates=False).build(mechanism, dt)  # an estimate takes a second run, and says nothing here
    softness = engine.softness(mechanism, dt)
    model = run.model
    if model.halves:
        raise NotAsked("a body that is cut into halves is another mechanism at one instant")
    start = model.start()
    told = run(1, STEPS)
    # What turns faster than steps follow has left its rows by the later instant, or is lost: the start alone is asked.
    followed = turned_in_a_step(mechanism, dt, mechanism.pose, mechanism.twist) <= 1
    if followed and (told.reset_at is not None or not np.isfinite(told.pose).all()):
        _refuse_what_is_huge(engine, mechanism, model, start, softness, dt)
        raise Fault(f"it was lost within {STEPS} steps: {'; '.join(told.warnings)}")
    followed = followed and turned_in_a_step(mechanism, dt, told.pose[-1], told.twist[-1]) <= 1
    radii = [_least_radius(joint) for joint in mechanism.joints if isinstance(joint, Roll)]
    if followed and radii:
        # Their rows are those of a closed gap, and turn by an open one over the radius of curvature.
        open_by = np.abs(np.nan_to_num(mechanism.gap(told.pose[-1], told.t[-1]))).max()
        followed = followed and open_by <= bound(engine) * min(mechanism.length_scale, *radii)
    if any("the solver missed" in warning for warning in told.warnings):
        raise NotAsked("it says itself that its solver ended too early")
    out = {"acceleration": 0.0, "reaction": 0.0}
    with model.hooked():
        for sample, data in enumerate((start, run.data) if followed else (start,)):
            mujoco.mj_forward(model.compiled, data)
            _refine(model, data, engine.tolerance)
            here = Instant.of(mechanism, model, data, softness)
            found = {
                "acceleration": here.missed(data.qacc),
                "reaction": here.missed_force(told.reaction[sample]),
            }
            out = {name: max(out[name], value) for name, value in found.items()}
    if out["reaction"] > bound(engine) and solved(engine) != engine:  # forces were read before the solver went on
        out["reaction"] = errors(solved(engine), mechanism)["reaction"]
    return out


def _refuse_what_is_huge(
    engine: MuJoCo, mechanism: Mechanism, model: Model, start: Any, softness: Softness | None, dt: float
) -> None:
    """Raises NotAsked where accelerations, or what stiff rows make of rounded gaps, are above mjMAXVAL in m/s^2 or
    rad/s^2: there MuJoCo resets a model, as its documentation says, whatever is in it. Nor is a motion asked for of
    which a textbook method loses a tenth at these steps: a light body turns over within one, a short rod's ends part.
    """
    with model.hooked():
        mujoco.mj_forward(model.compiled, start)
        rounding = Instant.of(mechanism, model, start, softness).floor.motion * LAW
    motion = TRUTH.build(mechanism, dt)(STEPS, 1)
    if motion.unresolved_at is not None or not np.isfinite(motion.pose).all():
        raise NotAsked("the judge itself does not hold what follows, as it says")
    needed = [rounding, *(ideal(mechanism, *state).motion for state in zip(motion.pose, motion.twist, strict=True))]
    if max(max(np.hypot(each[:, 0], each[:, 1]).max(), np.abs(each[:, 2]).max()) for each in needed) > mujoco.mjMAXVAL:
        raise NotAsked("accelerations are above mjMAXVAL, at which MuJoCo resets a model")
    fast = np.abs(motion.twist * [1.0, 1.0, mechanism.length_scale]).max()
    size = np.array([[fast, 0.0, 0.0]])
    try:
        run = in_numpy(mechanism, STEPS, dt, 4 if engine.integrator == "RK4" else 1, 1, None, True)
        off = max(difference(mechanism, *each, (size,)) for each in zip(run.twist, motion.twist, strict=True))
    except ValueError:  # it goes where curves can't touch
        off = math.inf
    if off >= LOST_SPEED:
        raise NotAsked("steps are too long for what happens soon after the start: a textbook method loses it too")


def _least_radius(roll: Roll) -> float:
    """Of curvature [m], anywhere on both curves; infinite for straight lines."""
    bent = [abs(bend) for curve in (roll.rolling.ground, roll.rolling.body) for bend in curve.curvature_range]
    return 1 / max(bent) if max(bent) > 0 else math.inf


def solved(engine: MuJoCo) -> MuJoCo:
    """The engine with a tolerance so small that its solver leaves nothing but rounding.

    What a solver leaves is bounded by the tolerance that the engine declares. Newton ends where a step lessens the cost
    c by less than tolerance I, with I the trace of M. It converges quadratically, so c - c_min is less by then. As the
    Hessian is M + J^T D J, accelerations that are off by e cost e^T M e / 2 at least: e^T M e <= 2 tolerance I (at most
    0.96 of it was met in 1115 starts and steps with blades, by a test in `tests/reports/test_search_oracles.py`). So as
    shipped, 1e-8, a body alone may be off by 2e-4 m/s^2, and a light one beside heavy ones by more: in a slow motion by
    a tenth of all. Springs alone cost a parabola, which one step of Newton's solves; friction does not.
    """
    return replace(engine, tolerance=min(engine.tolerance, ROUNDED**2))


def left_by_its_solver(engine: MuJoCo, mechanism: Mechanism, dt: float, seconds: float) -> Array:
    """How far bodies go, (bodies, 3) in m and rad, by accelerations of mjMINVAL, 1e-15 in m/s^2 and rad/s^2, in every
    coordinate of the tree.

    MuJoCo's solver takes no step that is shorter, whatever the tolerance. From one step of the integrator to the next,
    which begins where the last one ended, slow accelerations change by less.
    """
    model = engine.model(mechanism, dt)
    moved = np.abs(directions(model, model.start())).sum(axis=1).reshape(-1, 3)
    return moved * mujoco.mjMINVAL * seconds**2 / 2


def refuse_without_a_law(engine: MuJoCo, mechanism: Mechanism, dt: float) -> None:
    """Raises NotAsked for constructions that obey no law of an instant."""
    if engine.drive != "inertia" and any(joint.labels == ("torque",) for joint in mechanism.joints):
        raise NotAsked(f"a drive by {engine.drive!r} obeys no law of an instant")
    if engine.skates in STEPWISE and any(isinstance(joint, Skate) for joint in mechanism.joints):
        raise NotAsked("a blade whose row is that of another pose obeys no law of an instant")
    softness = engine.softness(mechanism, dt)
    if softness is not None and not softness.complete:
        raise NotAsked("contacts, and rows that are held over a step, obey no law of an instant")


def _refine(model: Model, data: Any, tolerance: float) -> None:
    """Let the solver go on, where what it left is within the tolerance that the engine declares: that is no fault.

    See `solved`; the tolerance is told of the inertia without what only keeps a drive's rate. Nor does a solver that
    compares costs see what rounding hides in them, which are sums of a^T M a.
    """
    compiled, before, kept = model.compiled, data.qacc.copy(), model.compiled.opt.tolerance
    data.qacc_warmstart[:], compiled.opt.tolerance = before, min(kept, ROUNDED**2)
    mujoco.mj_forward(compiled, data)
    compiled.opt.tolerance = kept

    def energy(acceleration: Array) -> float:
        momentum = np.empty(compiled.nv)
        mujoco.mj_mulM(compiled, data, momentum, acceleration)
        return float(acceleration @ momentum)

    inertia = float((compiled.dof_M0 - compiled.dof_armature)[model.address].sum())
    hidden = ROUNDINGS * np.finfo(float).eps * (energy(before) + energy(data.qacc_smooth))
    if not energy(before - data.qacc) <= 2 * tolerance * inertia + hidden:
        data.qacc[:] = before


@dataclass(frozen=True, eq=False)
class Instant:
    """A state of a model, and the law there: what it asks for, what it is compared with, and the rows it came from."""

    mechanism: Mechanism
    model: Model
    data: Any
    pose: Array  # (bodies, 3)
    twist: Array
    free: Array
    aimed: Array  # (rows,): what J a is to be, beside the velocity term
    give: Array
    solved: Array  # (rows,): which rows are the solver's, the others being held by the tree
    stiff: Array  # (rows,) [1/s^2]

    @classmethod
    def of(cls, mechanism: Mechanism, model: Model, data: Any, softness: Softness | None) -> Instant:
        """What `data` holds after mj_forward. Raises Fault where rows are lacking."""
        pose, twist, _ = _motion(model, data, data.qacc)
        give, aimed, solved, stiff = declared(mechanism, model, data, mechanism.rows(pose), softness, pose, twist)
        free = mechanism.unconstrained(pose, twist)
        return cls(mechanism, model, data, pose, twist, free, aimed, give, solved, stiff)

    def law(self, velocity_term: bool = True) -> Constrained:
        """Accelerations (bodies, 3) and forces (rows,); without it, the solver's rows lack their `velocity_term`.

        A row of the tree's coordinates is J D with D their directions, and its velocity term (J D)' is what then lacks.
        So J a is what it is where no coordinate accelerates.
        """
        rows, right = self.mechanism.rows(self.pose), self.mechanism.bias(self.pose, self.twist)
        if not velocity_term:
            _, _, coasting = _motion(self.model, self.data, np.zeros(self.model.compiled.nv))
            right = np.where(self.solved, rows @ coasting.reshape(-1), right)
        return constrained(rows, right + self.aimed, self.mechanism.inertias, self.free, self.give)

    @cached_property
    def floor(self) -> Constrained:
        """What rounding makes of accelerations and forces, as parts of LAW.

        Beside what `rounded` knows: gaps of stiff rows are differences of places, and so are arms, eps of a place off.
        And MuJoCo solves for the accelerations of a tree's coordinates. In the equation of one stand the inertias of
        all that hangs on it, about the centre of mass of the tree, times accelerations that add up joint by joint, and
        joints may move against each other: a light body far away is lost there. Of n coordinates the solution rounds
        3 n + 1 times (Higham 2002, theorem 10.4), and sums along the tree, and each of what is added, n + 3 times.
        A body's velocity adds a torque v x m v, of the velocity at that centre of mass: its parts, m v^2, cancel but
        for their rounding, which turns a fast body (Featherstone 2008, equation 2.70).
        """
        mechanism, data, unit = self.mechanism, self.data, ROUNDINGS * np.finfo(float).eps
        rows, right, law = mechanism.rows(self.pose), mechanism.bias(self.pose, self.twist) + self.aimed, self.law()
        mass, places = mechanism.inertias[:, 0], np.hypot(self.pose[:, 0], self.pose[:, 1])
        touched = np.abs(rows.reshape(len(rows), len(mass), 3)[..., :2]).max(axis=-1)  # (rows, bodies)
        angle, far = max(1.0, float(np.abs(self.pose[:, 2]).max())), max(mechanism.length_scale, float(places.max()))
        gap = self.stiff * np.where(mechanism.turning, angle, far)
        gap = gap + touched @ (places * (np.abs(law.motion[:, 2]) + self.twist[:, 2] ** 2))
        own = [self.model.compiled.body(f"body {index}").id for index in range(len(mass))]
        far = np.hypot(*(data.xipos[own] - data.subtree_com[self.model.compiled.body_rootid[own]])[:, :2].T)
        moved, turned = self._along_chains(law.motion[:, :2]), self._along_chains(law.motion[:, 2:])
        turned += self._along_chains(self.twist[:, 2:]) ** 2
        hanging, pushed, torque = mass.copy(), mass * (moved + far * turned), mass * far * (moved + far * turned)
        crossed = mass * (np.hypot(self.twist[:, 0], self.twist[:, 1]) + far * np.abs(self.twist[:, 2])) ** 2
        joined = np.zeros(len(mass))
        for link in reversed(self.model.tree.links):  # what hangs on a body is added to its own
            joined[link.body] = far[link.body] + math.hypot(*link.anchor)
            if link.parent is not None:
                for each in (hanging, pushed, torque, crossed):
                    each[link.parent] += each[link.body]
        torque += hanging * joined * (moved + joined * turned)
        summed = np.stack([pushed, pushed, torque], axis=1) * (5 * self.model.compiled.nv + 7) / ROUNDINGS
        summed[:, 2] += crossed + places * (
            touched.T @ np.abs(law.force) + mass * np.hypot(self.free[:, 0], self.free[:, 1])
        )
        doubt = unit * gap, unit * summed
        least = rounded(rows, law, right, mechanism.inertias, self.free, self.give, doubt)
        # Nor does its solver take a step that is shorter than mjMINVAL [m/s^2, rad/s^2].
        ended = mujoco.mjMINVAL * np.abs(directions(self.model, data)).sum(axis=1).reshape(-1, 3)
        return Constrained((least.motion + ended) / LAW, least.force / LAW)

    def _along_chains(self, values: Array) -> Array:
        """(bodies,) the sums of what each joint adds to values (bodies, parts), from the ground to each body."""
        out = np.zeros(len(values))
        for link in self.model.tree.links:
            before, above = (0.0, 0.0) if link.parent is None else (values[link.parent], out[link.parent])
            out[link.body] = above + float(np.linalg.norm(values[link.body] - before))
        return out

    def accelerations(self, velocity_term: bool = True) -> Array:
        """The accelerations (tree coordinates,) of the law; see there for `velocity_term`."""
        _, _, coasting = _motion(self.model, self.data, np.zeros(self.model.compiled.nv))
        own = directions(self.model, self.data)[:, self.model.address]
        told = np.linalg.lstsq(own, (self.law(velocity_term).motion - coasting).reshape(-1), rcond=None)[0]
        return np.asarray(told, dtype=np.float64)

    def missed(self, accelerations: Array, law: Constrained | None = None) -> float:
        """By what accelerations (nv,) miss the law, relative to the largest."""
        _, _, change = _motion(self.model, self.data, accelerations)
        # What a motion needs is compared with what acts, and with what the motion itself asks for.
        others = (self.free, self.twist / self.mechanism.time_scale, self.floor.motion)
        return difference(self.mechanism, change, (law or self.law()).motion, others)

    def missed_force(self, reaction: Array) -> float:
        """By what reactions (rows,) miss the law, relative to the largest force.

        They are read from accelerations (`reference.rows.reactions`), by the SVD of a matrix A, M^(-1/2) J^T with its
        columns made equally long. That rounds A by eps |A|, so a solution x by eps |x| over the smallest singular value
        (Higham 2002, section 20.1), which a light body makes small that many rows turn over long arms.
        """
        mechanism, law = self.mechanism, self.law()
        matrix = (mechanism.rows(self.pose) / np.sqrt(mechanism.inertias.reshape(-1))).T
        long = np.linalg.norm(matrix, axis=0)
        _, singular, right = np.linalg.svd(matrix / long, full_matrices=False)
        read = np.linalg.norm(right.T / singular, axis=1) / long * float(np.linalg.norm(law.force * long))
        rounded = self.floor.force + ROUNDINGS * np.finfo(float).eps / LAW * read
        size = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
        others = (driving_force(mechanism, self.twist), float((rounded * size).max(initial=0.0)))
        return force_difference(mechanism, reaction, law.force, others)


def _motion(model: Model, data: Any, accelerations: Array) -> tuple[Array, Array, Array]:
    """Poses, twists and accelerations (bodies, 3) of a state with these accelerations (nv,)."""
    own = (values[model.address][None] for values in (data.qpos, data.qvel, accelerations))
    (pose,), (twist,), (change,) = model.tree.motion(*own)
    return pose, twist, change


def in_state(model: Model, state: Any) -> Any:
    """A mujoco.MjData at the time, the place and the rates of another one, what follows from them computed."""
    data = model.start()
    data.time, data.qpos[:], data.qvel[:] = state.time, state.qpos, state.qvel
    mujoco.mj_forward(model.compiled, data)
    return data


WITHOUT = "without velocity terms"  # the law that MJX obeys where it leaves them out, as its adapter says


def mjx_errors(engine: Mjx, mechanism: Mechanism) -> dict[str, float]:
    """By what accelerations miss the law, relative to the largest: of loops and rods, which lack the velocity terms of
    rows as the adapter says, the law without those terms.

    Raises NotAsked where no law is declared, Fault for a row that is lacking, and Unsupported.
    """
    missed = mjx_missed(engine, mechanism)
    check = WITHOUT if lacks_velocity_terms(spanning_tree(mechanism)) else "acceleration"
    return {check: missed[check]}


def mjx_missed(engine: Mjx, mechanism: Mechanism) -> dict[str, float]:
    """By what they miss the law and the law without velocity terms; see `mjx_errors`."""
    dt = STEP * mechanism.time_scale
    engine = replace(engine, settings=solved(engine.settings))
    model, held = engine.model(mechanism, dt)
    refuse_without_a_law(engine.settings, mechanism, dt)
    if model.halves:
        raise NotAsked("a body that is cut into halves is another mechanism at one instant")
    run = engine.settings.build(mechanism, dt)
    told = run(1, STEPS)
    if not np.isfinite(told.pose).all():
        raise NotAsked("MuJoCo itself lost the motion")
    if any("the solver missed" in warning for warning in told.warnings):
        raise NotAsked("with these settings MuJoCo says itself that its solver ends too early")
    softness = engine.softness(mechanism, dt)
    out = {"acceleration": 0.0, WITHOUT: 0.0}
    for data in (model.start(), run.data):
        mujoco.mj_forward(model.compiled, data)
        here, found = Instant.of(mechanism, model, data, softness), engine.accelerations(model, held, data)
        misses = {"acceleration": here.missed(found), WITHOUT: here.missed(found, here.law(velocity_term=False))}
        out = {name: max(out[name], value) for name, value in misses.items()}
    return out
