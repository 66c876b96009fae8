"""Checks of what a run gives: its start, shapes, instants, cost, and that the same run gives the same bits again."""

from __future__ import annotations

import copy
import math
import time

import numpy as np

from engines import Size
from engines.conformance.check import SAMPLES, STEP, Check, Fails, Subject, finite, stepped
from engines.conformance.worlds import MOVING, SPINNING, WORLDS, World
from engines.contract import flaw_of_shapes, flaw_of_stepping, flaw_of_times

# Of a coordinate's size: what placing a body, and taking its place back from the engine's own coordinates, may take.
PLACING = 1e-12
GRAIN = 1e-4  # s, of another clock of CPU time than ours
SELDOM = (2, 3)  # samples, and steps between them
# The same steps are taken, so rounding is all that may differ; extrapolation weighs it with up to a hundred.
SAMPLED = 1e-9
# A solver that ends by a tolerance may read the same state from another guess, and a change of velocity over a step is
# what single precision rounds; divided by three times that step it is wrong by two thirds.
READ = 1e-3


def _largest(values: np.ndarray) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def has_the_right_shapes(subject: Subject, world: World) -> None:
    """A run gives a Trajectory of samples + 1 poses, twists and reactions, in the order of bodies and rows."""
    if flaw := flaw_of_shapes(subject.run(world.mechanism), world.mechanism, SAMPLES):
        raise Fails(*flaw, "the start is left out or counted twice, or a field is filled by place")


def tells_the_size_of_its_model(subject: Subject, world: World) -> None:
    """A built model says how large it is, by a Size of counts that are not below zero."""
    size = getattr(subject.build(world.mechanism), "size", None)
    if not isinstance(size, Size):
        raise Fails(f"size = {size!r}", "a Size", "the run has no property of that name")
    for name in ("bodies", "coordinates", "rows", "solver_rows"):
        value = getattr(size, name)
        if isinstance(value, bool) or not isinstance(value, int) or value < 0:
            raise Fails(f"size.{name} = {value!r}", "a count", "it is taken from an array of the engine as it is")


def samples_at_the_right_times(subject: Subject, world: World) -> None:
    """Sample k stands at k times `every` times dt, beginning with t = 0."""
    for samples, every in ((SAMPLES, 1), SELDOM):
        run = subject.run(world.mechanism, STEP, samples, every)
        if flaw := flaw_of_times(run, STEP, samples, every):
            raise Fails(*flaw, "`every` is left out, or time is counted from the first step on")


def tells_the_cpu_time_of_stepping(subject: Subject, world: World) -> None:
    """`stepping` is CPU time of this process: not below zero, and not more than it used during the run."""
    run = subject.build(world.mechanism)
    begin = time.process_time()
    told = stepped(run, SAMPLES, 1)
    used = time.process_time() - begin
    if flaw_of_stepping(told) or told.stepping > used + GRAIN:
        raise Fails(
            f"stepping = {told.stepping!r} s",
            f"from 0 to the {used:.3g} s of CPU time that the whole call took",
            "the wall's clock is read, or milliseconds, or nothing",
        )


def first_pose_is_the_start(subject: Subject, world: World) -> None:
    """The first sample's poses are the mechanism's start."""
    _starts(subject.run(world.mechanism).pose[0], world.mechanism.pose, "pose")


def first_twist_is_the_start(subject: Subject, world: World) -> None:
    """The first sample's twists are the mechanism's start."""
    _starts(subject.run(world.mechanism).twist[0], world.mechanism.twist, "twist")


def _starts(found: np.ndarray, start: np.ndarray, what: str) -> None:
    off = _largest(found - start)
    if not off <= PLACING * (1 + _largest(start)):
        body, place = np.unravel_index(int(np.argmax(np.abs(found - start))), start.shape)
        raise Fails(
            f"a {what} that is {off:.3g} off in {('x', 'y', 'the angle')[place]} of body {body}",
            f"the start to {PLACING:g} of its size",
            "the first sample is taken after the first step, or the engine's own frame is not the centre of mass",
        )


def gives_the_same_bits(subject: Subject, world: World) -> None:
    """Two builds, both made before either is run, give the same bits."""
    runs = [subject.build(world.mechanism), subject.build(world.mechanism)]
    first, second = (stepped(run, SAMPLES, 1) for run in runs)
    for name in ("t", "pose", "twist", "reaction"):
        one, other = getattr(first, name), getattr(second, name)
        if not np.array_equal(one, other, equal_nan=True):
            raise Fails(
                f"a {name} that differs by {_largest(np.nan_to_num(one - other)):.3g}",
                "the same bits",
                "two models share something, or a solver begins with random numbers or with what was left before",
            )


def leaves_the_mechanism_alone(subject: Subject, world: World) -> None:
    """Building and running change nothing in the mechanism that was given."""
    given = copy.deepcopy(world.mechanism)
    kept = (repr(given), given.pose.copy(), given.twist.copy(), given.inertias.copy(), given.rate.copy())
    stepped(subject.engine.build(given, STEP), SAMPLES, 1)
    for name, before, now in zip(
        ("description", "pose", "twist", "inertias", "rate"),
        kept,
        (repr(given), given.pose, given.twist, given.inertias, given.rate),
        strict=True,
    ):
        if not np.array_equal(before, now):
            raise Fails(f"another {name}", "what was given", "an array of the mechanism is written into without a copy")


def sampling_changes_nothing(subject: Subject, world: World) -> None:
    """Every third state of a run is that of a run sampled a third as often, to rounding."""
    samples, every = SELDOM
    often, seldom = subject.run(world.mechanism), subject.run(world.mechanism, STEP, samples, every)
    # From there on a run claims nothing, and at which of its samples it notices depends on where they are.
    unresolved = min(math.inf if run.unresolved_at is None else run.unresolved_at for run in (often, seldom))
    claimed = seldom.t < unresolved
    for name, allowed in (("pose", SAMPLED), ("twist", SAMPLED), ("reaction", READ)):
        whole, other = getattr(often, name), getattr(seldom, name)[claimed]
        same = whole[: samples * every + 1 : every][claimed]
        off = _largest(np.nan_to_num(other) - np.nan_to_num(same))
        if not off <= allowed * (1 + _largest(np.nan_to_num(whole))) or not np.array_equal(
            *map(np.isnan, (other, same))
        ):
            raise Fails(
                f"a {name} that differs by {off:.3g}",
                f"at most {allowed:g} of its size",
                "`every` changes the step, or a change of velocity is divided by another time than it took, "
                "or sampling disturbs what the engine goes on from",
            )


def does_not_wrap_angles(subject: Subject, world: World) -> None:
    """An angle goes on beyond a whole turn, and starts where the mechanism says though that is several turns."""
    run = finite(subject.run(world.mechanism))
    off = _largest(run.pose[..., 2] - world.exact(run.t).pose[..., 2])
    # A turn is 6.3 rad, and a step 0.6 rad of it.
    if not off <= 1.0:
        raise Fails(f"an angle that is {off:.3g} rad off", "at most 1 rad", "angles are taken from a sine and a cosine")


CHECKS = (
    Check(has_the_right_shapes, WORLDS),
    Check(tells_the_size_of_its_model, WORLDS),
    Check(samples_at_the_right_times, MOVING),
    Check(tells_the_cpu_time_of_stepping, MOVING),
    Check(first_pose_is_the_start, (*WORLDS, SPINNING)),
    Check(first_twist_is_the_start, (*WORLDS, SPINNING)),
    Check(gives_the_same_bits, MOVING),
    Check(leaves_the_mechanism_alone, MOVING),
    Check(sampling_changes_nothing, MOVING),
    Check(does_not_wrap_angles, (SPINNING,)),
)
