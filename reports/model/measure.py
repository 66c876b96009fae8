"""Functions that run a cell and measure the outcome, the errors, the cost and the size."""

from __future__ import annotations

import io
import os
import struct
import time
import zlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from html import escape
from pathlib import Path
from typing import Any, TypeVar
from zipfile import BadZipFile

import numpy as np

from engines import Unsupported
from engines.trajectory_check import flaw
from reference.checks import freeze
from reference.mechanism import Mechanism
from reference.scene import NoMotion, Scene
from reference.trajectory import ADAPTER_PREFIX, Trajectory
from reference.validators import Array
from reports.model.cells import Cell, mechanism_of
from reports.model.errors import branch_flips, constraint_errors, motion_errors, usable_samples
from reports.model.fingerprint import LONG, digest
from reports.model.outcomes import Outcome, of_motion, refusal
from reports.model.spending import spending

NAN = float("nan")
TIMED = ("sweep", "beside", "growth", "large")  # Purposes whose rows are charted against their cost.
SAME_INSTANT = 1e-15  # Relative difference between equal instants due to rounding.
# After these CPU seconds a run is not repeated. The measured times are then 1.8 % above the minimum of ten runs.
BUDGET = 0.015
MOST_RUNS = 5
LONG_RUN = 0.05  # A longer run [s] is not repeated, since its time is only 1 % above the minimum of three repetitions.
TRUTHS = "truths"  # The folder of exact motions beside a store, which may be deleted at any time.
SHORT_MOTION = 5e-3  # A motion that is computed in less time [s] is not stored, since reading it would take longer.
# Exceptions when a damaged file is read. A part that is marked as encrypted raises RuntimeError.
DAMAGES = (OSError, ValueError, KeyError, EOFError, RuntimeError, MemoryError, struct.error, zlib.error, BadZipFile)
PARTS = ("t", "pose", "twist", "reaction")

Result = TypeVar("Result")


@dataclass(frozen=True)
class Measurement:
    """The row of a cell. An unknown error is NaN. Units of errors are in `reports.model.quantities`."""

    key: str
    purpose: str
    scene: str
    parameters: str  # The scene with its parameters.
    engine: str
    variant: str
    settings: str  # The engine with its settings.
    every: int
    samples: int
    step: float  # s
    outcome: str = Outcome.FAILED
    sentence: str = ""
    position: float = NAN
    position_rms: float = NAN
    angle: float = NAN
    angle_rms: float = NAN
    angle_duration: float = NAN  # The angle error over the whole duration.
    velocity: float = NAN
    rate: float = NAN
    gap: float = NAN
    drive_gap: float = NAN
    slip: float = NAN
    energy: float = NAN
    reaction: float = NAN
    reaction_rows: int = 0  # Number of constraint rows with a reported reaction.
    flips: int = 0
    estimate: float = NAN  # Largest angle error [rad] as estimated by the method.
    bodies: int = 0
    coordinates: int = 0
    rows: int = 0
    solver_rows: int = 0
    own_bodies: int = 0
    own_coordinates: int = 0
    own_rows: int = 0
    own_freedoms: int = 0
    cpu: float = NAN  # CPU seconds of stepping per simulated second.
    runs: int = 0  # Number of runs, whose shortest time is `cpu`.
    build: float = NAN
    limit: float = NAN  # Limit [CPU seconds] at which a cell timed out.

    @property
    def method(self) -> str:
        return f"{self.engine} {self.variant}"

    @property
    def engine_sentence(self) -> str:
        """The part of the sentence before the first warning of our adapter."""
        return self.sentence.partition(f"; {ADAPTER_PREFIX}")[0]

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)

    def _repr_html_(self) -> str:
        known = ((name, value) for name, value in self.as_dict().items() if value not in ("", 0) and value == value)
        rows = (f"<tr><th>{name}</th><td>{escape(str(value))}</td></tr>" for name, value in known)
        return f"<table>{''.join(rows)}</table>"


TIMINGS = ("cpu", "runs", "build")


def blank(cell: Cell, outcome: Outcome = Outcome.FAILED, sentence: str = "") -> Measurement:
    return Measurement(
        key=cell.key,
        purpose=cell.purpose,
        scene=cell.scene.name,
        parameters=repr(cell.scene),
        engine=cell.engine.name,
        variant=cell.engine.variant,
        settings=repr(cell.engine),
        every=cell.every,
        samples=cell.sample_count,
        step=cell.step,
        outcome=outcome,
        sentence=sentence,
    )


def exact_motion(cell: Cell, t: Array, folder: Path | None) -> Trajectory:
    """The scene's motion at the instants t (times,) [s]. If the folder exists, motions are stored there. Instants that
    differ only by rounding share a motion. Raises ValueError if the scene has no such motion."""
    usual = np.arange(len(t)) * (cell.scene.duration / cell.sample_count)
    shared = np.allclose(t, usual, rtol=SAME_INSTANT, atol=0.0)
    instants = np.ascontiguousarray(usual if shared else t, dtype=float)
    with spending("truth"):
        return _motion(cell.scene, instants.tobytes(), cell.truth, folder)


@lru_cache(maxsize=128)
def _motion(scene: Scene, instants: bytes, name: str, folder: Path | None) -> Trajectory:
    """The cached motion. The file is never stale, since its name is a digest of everything that affects the motion."""
    if folder is None or not folder.is_dir():
        return freeze(scene.motion(np.frombuffer(instants)))
    file = folder / f"{digest(name.encode() + instants, LONG)}.npz"
    with suppress(*DAMAGES), np.load(io.BytesIO(file.read_bytes())) as stored:
        return freeze(Trajectory(*(stored[part] for part in PARTS)))
    seconds, motion = process_seconds(lambda: scene.motion(np.frombuffer(instants)))
    if seconds > SHORT_MOTION:
        _store_motion(motion, file)
    return freeze(motion)


def _store_motion(motion: Trajectory, file: Path) -> None:
    half = file.with_name(f"{file.stem}.{os.getpid()}.half")
    with suppress(OSError):
        try:
            with half.open("wb") as stream:
                np.savez(stream, **{part: getattr(motion, part) for part in PARTS})
            half.replace(file)
        finally:
            half.unlink(missing_ok=True)


@lru_cache(maxsize=128)
def _own_freedoms(scene: Scene) -> int:
    return mechanism_of(scene).degrees_of_freedom()[0]


def measure(cell: Cell, repeat: bool = True, truths: Path | None = None) -> Measurement:
    """Build, run, compare and time one cell in this process. truths: folder of exact motions. Refusals and warnings of
    the engine become outcomes. Other exceptions are raised."""
    row = blank(cell)
    with np.errstate(all="ignore"):
        try:
            mechanism = mechanism_of(cell.scene)
            with spending("preparing engines"):
                cell.engine.prepare()
            with spending("building"):
                build, run = process_seconds(lambda: cell.engine.build(mechanism, cell.step))
            row = replace(row, build=build, **sizes(mechanism, run.size, _own_freedoms(cell.scene)))
            with spending("stepping"):
                trajectory = run(cell.sample_count, cell.every)
        except (Unsupported, ValueError) as reason:
            return replace(row, **asdict(refusal(reason)))
        if reason := flaw(trajectory, mechanism, cell.step, cell.sample_count, cell.every):
            return replace(row, outcome=Outcome.FAILED, sentence=reason)
        with spending("comparing"):
            row = compare(cell, mechanism, trajectory, row, truths)
        if repeat and cell.purpose in TIMED and Outcome(row.outcome).comparable:
            with spending("timing again"):
                cpu, runs, build = repeated_stepping(cell, mechanism, trajectory.stepping, build)
        else:
            cpu, runs = trajectory.stepping, 1
    return replace(row, cpu=cpu / cell.scene.duration, runs=runs, build=build)


def process_seconds(function: Callable[[], Result]) -> tuple[float, Result]:
    start = time.process_time()
    result = function()
    return time.process_time() - start, result


def repeated_stepping(cell: Cell, mechanism: Mechanism, first: float, build: float) -> tuple[float, int, float]:
    """Repeat a cell; return (minimum stepping time [s], number of runs, minimum building time [s])."""
    if not first < LONG_RUN:
        return first, 1, build
    times: list[float] = []
    begin = time.process_time()
    while not times or (len(times) < MOST_RUNS and time.process_time() - begin < BUDGET):
        seconds, run = process_seconds(lambda: cell.engine.build(mechanism, cell.step))
        build = min(build, seconds)
        times.append(run(cell.sample_count, cell.every).stepping)
    return min(times), len(times), build


def sizes(mechanism: Mechanism, size: Any, freedoms: int) -> dict[str, int]:
    return {
        **asdict(size),
        "own_bodies": len(mechanism.bodies),
        "own_coordinates": 3 * len(mechanism.bodies),
        "own_rows": mechanism.row_count,
        "own_freedoms": freedoms,
    }


def compare(
    cell: Cell, mechanism: Mechanism, trajectory: Trajectory, row: Measurement, truths: Path | None = None
) -> Measurement:
    trajectory, note = stopped_where_it_ends(cell.scene, trajectory)
    count = usable_samples(trajectory)
    finite = first_samples(trajectory, count)
    errors: dict[str, Any] = {}
    note = "; ".join(filter(None, dict.fromkeys([note, *trajectory.warnings])))
    try:
        errors |= constraint_errors(mechanism, finite) if count else {}
    except ValueError as reason:  # A pose is outside the domain of a joint, such as beyond a corner.
        sentence = "; ".join(filter(None, (f"a joint has no meaning at the end: {reason}", note)))
        return replace(row, outcome=Outcome.REFUSED, sentence=sentence)
    try:
        truth = exact_motion(cell, finite.t, truths)
        errors |= motion_errors(cell.scene, mechanism, truth, finite)
        errors["flips"] = branch_flips(cell.scene, truth, finite)
    except NoMotion as reason:  # Errors are unknown without an exact motion.
        return replace(row, outcome=Outcome.REFUSED, sentence=str(reason))
    except ValueError as reason:  # Without an exact motion the row has the engine's outcome.
        note = "; ".join(filter(None, (f"the reference refuses: {reason}", note)))
    if trajectory.estimate is not None and not np.isnan(trajectory.estimate[..., 2]).all():
        errors["estimate"] = float(np.nanmax(np.abs(trajectory.estimate[..., 2])))
    errors["reaction_rows"] = int(np.isfinite(trajectory.reaction).any(axis=0).sum())
    row = replace(row, **errors)
    outcome, sentence = of_motion(row, mechanism, trajectory, count)
    return replace(row, outcome=outcome, sentence="; ".join(filter(None, (sentence, note))))


def stopped_where_it_ends(scene: Scene, trajectory: Trajectory) -> tuple[Trajectory, str]:
    """(the samples that can be compared with the ideal motion, a sentence if samples were removed)."""
    limit = scene.comparable_until
    count = int(np.sum(trajectory.t <= limit * (1 + 1e-12)))
    if count == len(trajectory.t):
        return trajectory, ""
    events = {name: getattr(trajectory, name) for name in ("reset_at", "unresolved_at")}
    compared = replace(
        first_samples(trajectory, count),
        estimate=None if trajectory.estimate is None else trajectory.estimate[:count],
        **{name: t if t is not None and t <= limit else None for name, t in events.items()},
    )
    why = f"compared until {limit:.4g} s only: beyond, the ideal motion asks for what a real contact can't give"
    return compared, why


def first_samples(trajectory: Trajectory, count: int) -> Trajectory:
    return replace(trajectory, **{part: getattr(trajectory, part)[:count] for part in PARTS})
