"""Motions of many mechanisms in one compiled loop, for sweeps over parameters.

Mechanisms with equal joints between the same bodies are stepped together, LANES in each vector register and one thread
for each processor. Their motions are equal to those of single runs up to rounding. These mechanisms are run alone:
mechanisms with rolling curves, with dependent rows or with very many rows, mechanisms that pass near a singular
position, groups that are too small to compile a program for them, and all mechanisms of an engine with a tolerance.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from engines.lagrange.compiled_model import CompiledModel
from engines.lagrange.engine import Lagrange
from engines.lagrange.records import System
from engines.lagrange.running import FIXED_STEP_TABLEAUS
from engines.lagrange.sweep import INVERSE_LENGTH, ParameterSweep
from engines.lagrange.system import Key
from reference.checks import Count, InvalidMechanism, Positive, require_room, validate, validated
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning

if TYPE_CHECKING:
    from engines.lagrange.lanes.program import MachineCode

Array = NDArray[np.float64]

# Nominal CPU time [s] per product in the matrix from which on a group has a program. The compilation takes 0.3 s and
# 0.013 s for each product (measured up to 470 products), and single runs take a third of the nominal time.
WORTH_COMPILING = 0.04
# Most products in the matrix of a mechanism in a program, whose compilation then takes 13 s.
MOST_PRODUCTS = 1000
# Numbers in the poses that a thread computes at a time (32 MB).
CHUNK_NUMBERS = 2**22
# Largest change of a given start by the projection onto the joints, in units of the mechanism's length and speed.
START_ERROR = 1e-7
VARIED_TABLES = ("constants", "bodies", "joints", "forces", "terms", "equations")


@dataclass(frozen=True)
class Batch:
    """The motions of mechanisms.

    t (samples + 1,) [s]; pose and twist (mechanisms, samples + 1, bodies, 3), or tuples of arrays (samples + 1, bodies,
    3) if the numbers of bodies are different. `warnings` has the warnings by number of a mechanism.
    """

    t: Array
    pose: Any
    twist: Any
    warnings: Mapping[int, tuple[RunWarning | str, ...]]


@dataclass(frozen=True)
class _Group:
    """Mechanisms with equal joints: the numbers in which they differ (mechanisms,), and their starts."""

    first: Mechanism
    numbers: Mapping[Key, Array]
    pose: Array  # (mechanisms, bodies, 3)
    twist: Array
    alone: Callable[[int], Mechanism]


@validated
def run_batch(
    engine: Lagrange,
    mechanisms: Any,
    dt: Positive,
    samples: Count,
    every: Count = 1,
    workers: Count | None = None,
) -> Batch:
    """Make `samples * every` steps of dt [s] with each mechanism, and record samples + 1 states.

    mechanisms: a `ParameterSweep`, or a list of `Mechanism`s. workers: number of threads, by default one for each
    processor.
    Raises InvalidMechanism for a start that does not satisfy the joints, and for a sweep whose mechanism cannot move
    its start.
    """
    mechanisms = validate("run_batch", "mechanisms", mechanisms, ParameterSweep | tuple[Mechanism, ...])
    if not len(mechanisms):
        raise InvalidMechanism("run_batch: there are no mechanisms; give at least one")
    loop = _Loop(engine, dt, samples, every, workers or _processors())
    if isinstance(mechanisms, ParameterSweep):
        return loop.run_sweep(mechanisms)
    return loop.run_list(mechanisms)


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class _Loop:
    engine: Lagrange
    dt: float
    samples: int
    every: int
    workers: int

    @property
    def t(self) -> Array:
        return np.arange(self.samples + 1, dtype=float) * (self.every * self.dt)

    def run_sweep(self, sweep: ParameterSweep) -> Batch:
        mechanism, count = sweep.mechanism, len(sweep)
        starts = (
            np.array(np.broadcast_to(own if given is None else given, (count, *own.shape)))
            for own, given in ((mechanism.pose, sweep.pose), (mechanism.twist, sweep.twist))
        )
        pose, twist = starts
        system = self._system(mechanism)
        if system is None:
            if sweep.pose is None or sweep.twist is None:
                raise InvalidMechanism(
                    "sweep: starts are moved onto the joints in machine code only, which needs the extra 'fast' and a "
                    "structure without rolling curves, dependent rows or a tolerance; give `pose` and `twist`"
                )
            return self.run_list([sweep.alone(number, pose[number], twist[number]) for number in range(count)])
        group = _Group(mechanism, dict(sweep.records(system)), pose, twist, lambda k: sweep.alone(k, pose[k], twist[k]))
        machine = self._machine(system, group)
        self._close(machine, group, is_given=(sweep.pose is not None, sweep.twist is not None))
        return Batch(self.t, *self._run_group(machine, group))

    def run_list(self, mechanisms: Sequence[Mechanism]) -> Batch:
        systems = [self._system(mechanism) for mechanism in mechanisms]
        numbers_of: dict[Any, list[int]] = {}
        for number, system in enumerate(systems):
            numbers_of.setdefault(number if system is None else _structure(system), []).append(number)
        poses: list[Any] = [None] * len(mechanisms)
        twists, warnings = list(poses), dict[int, tuple[RunWarning | str, ...]]()
        for numbers in numbers_of.values():
            members = [mechanisms[number] for number in numbers]
            own = [system for number in numbers if (system := systems[number]) is not None]
            cost = len(members) * self.samples * self.every * self.engine.step_cost(members[0])
            if own and cost >= WORTH_COMPILING * (25 + len(own[0].products)):
                pose, twist = (np.array([getattr(member, name) for member in members]) for name in ("pose", "twist"))
                group = _Group(members[0], _differences(own), pose, twist, members.__getitem__)
                found = self._run_group(self._machine(own[0], group), group)
            else:
                found = self._run_alone(members)
            for k, number in enumerate(numbers):
                poses[number], twists[number] = found[0][k], found[1][k]
                warnings |= {number: found[2][k]} if k in found[2] else {}
        if len({pose.shape for pose in poses}) == 1:
            return Batch(self.t, np.array(poses), np.array(twists), warnings)
        return Batch(self.t, tuple(poses), tuple(twists), warnings)

    def _system(self, mechanism: Mechanism) -> System | None:
        """The system of a mechanism that can be stepped together with others, or None."""
        engine = self.engine
        model = CompiledModel.of(mechanism) if engine.in_machine_code and engine.tolerance is None else None
        if model is None or model.has_dependent_rows:
            return None
        if len(model.system.rolls) or len(model.system.products) > MOST_PRODUCTS:
            return None
        regularisation = engine.regularisation(mechanism, self.dt)
        if regularisation is not None:
            model.regularise(regularisation, np.ones(mechanism.row_count, dtype=bool))
        return model.system

    def _machine(self, system: System, group: _Group) -> MachineCode:
        from engines.lagrange.lanes.program import MachineCode, VectorProgram  # imports numba

        varied = {key: slot for slot, key in enumerate(group.numbers)}
        tableau, projects = FIXED_STEP_TABLEAUS[self.engine.integrator], self.engine.stabilisation == "projection"
        return MachineCode(VectorProgram(system, varied, tableau, projects))

    def _close(self, machine: MachineCode, group: _Group, is_given: tuple[bool, bool]) -> None:
        """Move the starts onto the joints; raise InvalidMechanism if given starts move or joints do not close."""
        poses, twists, pivots = self._stepped(machine, group, 0, moves_start=True)
        is_bad = ~(pivots >= 0)
        if is_bad.any():
            raise InvalidMechanism(
                f"sweep: mechanism {int(is_bad.argmax())}: its joints do not close from the start of the given "
                "mechanism; give `pose` and `twist`, or numbers that are nearer to those of the mechanism"
            )
        scale = np.ones((len(poses), 1, 3))
        inverse_lengths = group.numbers.get(INVERSE_LENGTH, np.array([1 / group.first.length_scale]))
        scale[..., :2] = inverse_lengths[:, None, None]
        for name, moved, start, time, is_fixed in (
            ("pose", poses, group.pose, 1.0, is_given[0]),
            ("twist", twists, group.twist, group.first.time_scale, is_given[1]),
        ):
            errors = (np.abs(moved[:, 0] - start) * scale * time).max(axis=(1, 2))
            if is_fixed and not errors.max() <= START_ERROR:
                raise InvalidMechanism(
                    f"sweep: mechanism {int(errors.argmax())}: its {name} does not satisfy the joints; correct it, or "
                    f"leave {name} out"
                )
            if not is_fixed:
                start[:] = moved[:, 0]

    def _run_group(
        self, machine: MachineCode, group: _Group
    ) -> tuple[Array, Array, dict[int, tuple[RunWarning | str, ...]]]:
        """Step a group, and then the mechanisms alone that passed near a singular position or were lost."""
        from engines.lagrange.lanes.program import LEAST_PIVOT

        poses, twists, pivots = self._stepped(machine, group, self.samples, moves_start=False)
        is_held = (pivots >= LEAST_PIVOT) & np.isfinite(poses[:, -1]).all(axis=(1, 2))
        numbers = np.flatnonzero(~is_held)
        own_poses, own_twists, warnings = self._run_alone([group.alone(int(number)) for number in numbers])
        for number, pose, twist in zip(numbers, own_poses, own_twists, strict=True):
            poses[number], twists[number] = pose, twist
        return poses, twists, {int(numbers[k]): own for k, own in warnings.items()}

    def _stepped(
        self, machine: MachineCode, group: _Group, samples: int, moves_start: bool
    ) -> tuple[Array, Array, Array]:
        """Poses, twists (mechanisms, samples + 1, bodies, 3) and smallest pivots (mechanisms,)."""
        from concurrent.futures import ThreadPoolExecutor  # imported here, as numba above: most processes step no batch

        from engines.lagrange.lanes.number import LANES

        count, bodies = group.pose.shape[:2]
        require_room("a batch", (count, samples + 1, bodies, 3))
        parameters = np.stack([*group.numbers.values()], axis=1) if group.numbers else np.empty((count, 0))
        poses, twists = np.empty((2, count, samples + 1, bodies, 3))
        poses[:, 0], twists[:, 0] = group.pose, group.twist
        pivots = np.empty(count)

        def step(begin: int) -> None:
            own = slice(begin, begin + chunk)
            pivots[own] = machine.run(parameters[own], poses[own], twists[own], self.every, self.dt, moves_start)

        vectors = max(1, CHUNK_NUMBERS // (LANES * (samples + 1) * 3 * bodies))
        chunk = LANES * min(vectors, -(-count // (LANES * self.workers)))
        with ThreadPoolExecutor(self.workers) as pool:
            list(pool.map(step, range(0, count, chunk)))
        return poses, twists, pivots

    def _run_alone(self, mechanisms: Sequence[Mechanism]) -> tuple[Any, Any, dict[int, tuple[RunWarning | str, ...]]]:
        runs = [self.engine.build(mechanism, self.dt)(self.samples, self.every) for mechanism in mechanisms]
        warnings = {number: run.warnings for number, run in enumerate(runs) if run.warnings}
        return [run.pose for run in runs], [run.twist for run in runs], warnings


def _structure(system: System) -> tuple[bytes, ...]:
    """The integers of a system, which are equal for mechanisms with equal joints between the same bodies."""
    tables = [np.atleast_1d(getattr(system, name)) for name in (*VARIED_TABLES, "rows", "further_ends", "products")]
    return tuple(
        table[name].tobytes()
        for table in tables
        for name, (kind, *_) in (table.dtype.fields or {}).items()
        if kind != np.float64
    )


def _differences(systems: Sequence[System]) -> dict[Key, Array]:
    """The numbers in which systems of one structure differ."""
    out: dict[Key, Array] = {}
    for name in VARIED_TABLES:
        tables = np.array([np.atleast_1d(getattr(system, name)) for system in systems])
        for field, (kind, *_) in (tables.dtype.fields or {}).items():
            if kind == np.float64 and tables.size:
                differing = np.flatnonzero((tables[field] != tables[field][0]).any(axis=0)).tolist()
                out |= {(name, index, field): tables[field][:, index] for index in differing}
    return out
