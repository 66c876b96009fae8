"""Checks of a motion against the exact one: which instant it belongs to, its order, what its reactions say, and whether
forces act: an engine that does not look at them moves as if there were none, and says nothing.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from engines import Promise, Unpromised, Unsupported
from engines.conformance.check import SAMPLES, STEP, Check, Fails, NotAsked, Subject, finite, require_a_sentence
from engines.conformance.worlds import MOVING, WORLDS, World
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Pin
from reference.mechanism import Body, Mechanism

Array = NDArray[np.float64]

SHORT = 1e-3  # s: within three of these a motion of some radians a second is a parabola to a percent
EARLY = 3  # steps
# Of a step. A state of another instant is half a step off at least; a parabola leaves a hundredth of one.
OFF = 0.1
# A flipped sign is wrong by 2, a factor of two by 1/2 at least; the coarsest first-order method here by less than 0.1.
SIZE = 0.25  # of the largest reaction


def poses_stand_at_their_instants(subject: Subject, world: World) -> None:
    """The first poses after the start lie on the exact motion at their own instants, not half a step or a step off."""
    _promise(subject, world)
    run = finite(subject.run(world.mechanism, SHORT, EARLY))
    exact = world.exact(run.t)
    _at_their_instants("pose", world, run.pose - exact.pose, exact.twist[0])


def twists_stand_at_their_instants(subject: Subject, world: World) -> None:
    """The first twists after the start belong to their own instants, not half a step later or the step before."""
    _promise(subject, world)
    run = finite(subject.run(world.mechanism, SHORT, EARLY))
    exact = world.exact(run.t)
    _at_their_instants("twist", world, run.twist - exact.twist, exact.acceleration[0])


def _at_their_instants(what: str, world: World, error: Array, rate: Array) -> None:
    """The error is rate times (delay + share times t); Fails unless the delay is below OFF.

    Only what the joints leave free is looked at. There a method of any order, even the first, has taken n kicks and n
    drifts after n steps. Across the joints a method of the first order may be off by as much as half a step.
    """
    free = _free(world.mechanism)
    moving = free(rate)
    along = [np.vdot(free(each), moving) / np.vdot(moving, moving) / SHORT for each in error[1:]]
    _, delay = np.polyfit(np.arange(1, EARLY + 1), along, 1)
    if not abs(delay) <= OFF:
        raise Fails(
            f"a {what} that is {abs(delay):.2f} steps {'ahead of' if delay > 0 else 'behind'} its instant",
            f"at most {OFF:g} steps",
            "a leapfrog's velocities, half a step later, or those of the step before are told with the poses",
        )


def _free(mechanism: Mechanism) -> Callable[[Array], Array]:
    """What takes from velocities (bodies, 3) the part that does work against no joint, in the metric of the masses."""
    root = np.sqrt(mechanism.inertias.reshape(-1))
    _, sizes, directions = np.linalg.svd(mechanism.rows(mechanism.pose) / root)
    free = directions[np.sum(sizes > 1e-9 * sizes[0]) :]
    return lambda velocities: free.T @ (free @ (root * velocities.reshape(-1)))


def poses_have_their_order(subject: Subject, world: World) -> None:
    """Errors of poses fall at least as fast with the step as `order` promises, until rounding is left."""
    _has_its_order(subject, world, "pose", "angle")


def twists_have_their_order(subject: Subject, world: World) -> None:
    """Errors of twists fall at least as fast with the step as `order` promises, until rounding is left."""
    _has_its_order(subject, world, "twist", "rate")


def _promise(subject: Subject, world: World) -> Promise:
    """What the engine promises here; raises NotAsked where it says why it can't."""
    subject.run(world.mechanism)  # where it builds nothing it need not promise anything
    promise = subject.engine.order(world.mechanism)
    if isinstance(promise, Unpromised):
        raise NotAsked(f"no order is promised: {promise.reason}")
    return promise


REFINED = (1, 3, 9)  # times as many steps as of the others: between them an order shows as a factor of 3^order
SPAN, WHOLE = 0.06, 3  # s, and samples in it
# Room above what the promised order lets expect of the coarser steps: the next power of the step, and samples.
ROOM = 2.5
# Relative to the motion, an error of this size is rounding, or that of a drive whose rate is held by an inertia of a
# hundred million times the mechanism's.
LEAST = 1e-8
# s^2: with it, an acceleration of 10 m/s^2 opens a joint by a nanometre, which is less than LEAST.
HARD = 1e-10


def _has_its_order(subject: Subject, world: World, name: str, quantity: str) -> None:
    order = _promise(subject, world).of(quantity)
    if _gives_way_for_good(subject, world):
        raise NotAsked("joints give way as the engine says, by the same at every step")
    errors = []
    for every in REFINED:
        run = finite(subject.run(world.mechanism, SPAN / WHOLE / every, WHOLE, every))
        errors.append(float(np.max(np.abs(getattr(run, name) - getattr(world.exact(run.t), name)))))
    steps = [f"{SPAN / WHOLE / every:.2g}" for every in REFINED]
    expected = max(error * (every / REFINED[-1]) ** order for error, every in zip(errors, REFINED[:-1], strict=False))
    bound = max(ROOM * expected, LEAST * (1 + float(np.max(np.abs(world.mechanism.twist)))))
    if not errors[-1] <= bound:
        raise Fails(
            f"errors of {', '.join(f'{error:.2g}' for error in errors)} at steps of {', '.join(steps)} s",
            f"at most {bound:.2g} at the last, by order {order:g}",
            f"the {name} is of another instant than the method's own, or the engine is not of this order",
        )


def _gives_way_for_good(subject: Subject, world: World) -> bool:
    """Whether joints give way visibly under a force, and at the smallest step nearly as much as at the one before."""
    coarse, fine = (_give(subject, world, SPAN / WHOLE / every) for every in REFINED[-2:])
    return fine > HARD and fine * (REFINED[-1] / REFINED[-2]) > ROOM * coarse


def _give(subject: Subject, world: World, dt: float) -> float:
    """s^2: the way that a joint gives, over the acceleration that it should prevent."""
    softness = subject.engine.softness(world.mechanism, dt)
    return 0.0 if softness is None else softness.compliance / softness.stiffness


def reactions_have_sign_and_size(subject: Subject, world: World) -> None:
    """Reactions are forces on the second body: up where it hangs, and of the size of its weight and m a."""
    _promise(subject, world)  # a method without one holds another motion, with other forces
    run = finite(subject.run(world.mechanism))
    exact = world.exact(run.t).reaction
    turning = world.mechanism.turning
    known = ~np.isnan(run.reaction).all(axis=0)
    if not known.any():
        raise NotAsked("the engine tells no reactions here")
    for row in np.flatnonzero(known):
        largest = np.max(np.abs(exact[:, turning == turning[row]]))
        # Of all samples the middle one: a contact that has just been made may take some steps to carry the weight.
        off = np.nanmedian((run.reaction[:, row] - exact[:, row]) / largest)
        if not abs(off) <= SIZE:
            told, right = np.nanmedian(run.reaction[:, row]), np.median(exact[:, row])
            raise Fails(
                f"{told:.4g} {'N m' if turning[row] else 'N'} in row {world.mechanism.row_names[row]!r}",
                f"about {right:.4g}",
                "the force on the first body is told, or an impulse is divided by another step",
            )


# Of a plate on a pin: each element alone, as strong as to change the rate much within the samples of a check.
_PLATE = Body("plate", 2.0, 0.1, (0.0, 0.0, 0.3), (0.0, 0.0, 2.0))
_HINGE = Pin("hinge", None, "plate", (0.0, 0.0), (0.0, 0.0))
_FAR = ((1.0, -0.5), (0.2, 0.1))
FORCES: tuple[ForceElement, ...] = (
    Torque("torque", None, "plate", 3.0),
    Force("force", "plate", (0.2, 0.1), (10.0, -5.0)),
    Spring("spring", None, "plate", *_FAR, 20.0, 0.2),
    Damper("damper", None, "plate", *_FAR, 10.0),
    TorsionSpring("torsion spring", None, "plate", 5.0, -1.0),
    TorsionDamper("torsion damper", None, "plate", 0.5),
)
FELT = 0.2  # of what a force does to the rate: far above what a method of first order misses at these steps


def feels_forces_or_refuses_them(subject: Subject) -> None:
    """Each kind of force changes the motion as it should, or is refused by Unsupported with one sentence."""
    refused: list[str] = []
    for force in FORCES:
        mechanism = Mechanism((_PLATE,), (_HINGE,), (0.0, 0.0), (force,))
        try:
            run = finite(subject.run(mechanism))
        except Unsupported as reason:
            require_a_sentence(str(reason), f"a {type(force).__name__}")
            refused.append(str(reason))
            continue
        found, expected = float(run.twist[-1, 0, 2]) - 2.0, _gained(mechanism, STEP * SAMPLES)
        if not abs(found - expected) < FELT * abs(expected):
            raise Fails(
                f"a rate that changes by {found:.3g} rad/s under a {type(force).__name__}",
                f"{expected:.3g} rad/s, or Unsupported",
                "the mechanism's forces are not looked at when it is built, or one has another sign or unit",
            )
    if len(refused) == len(FORCES):
        raise Unsupported(refused[0])


def _gained(mechanism: Mechanism, until: float) -> float:
    """The change of the plate's rate by then [rad/s], from its one equation of motion."""
    pose, twist = np.zeros((1, 3)), np.zeros((1, 3))

    def derivative(_: float, state: Array) -> list[float]:
        pose[0, 2], twist[0, 2] = state
        return [state[1], mechanism.applied.on(pose, twist)[0, 2] / _PLATE.inertia]

    states = solve_ivp(derivative, (0.0, until), [_PLATE.pose[2], _PLATE.twist[2]], rtol=1e-6).y
    return float(states[1, -1] - _PLATE.twist[2])


# Where the joints leave something free, and where gravity changes that.
FREE = tuple(world for world in MOVING if world.name != "driven crank")
PULLED = tuple(world for world in FREE if world.name != "sleigh")
CHECKS = (
    Check(reactions_have_sign_and_size, WORLDS),
    Check(poses_stand_at_their_instants, FREE),
    Check(twists_stand_at_their_instants, PULLED),
    Check(poses_have_their_order, MOVING),
    Check(twists_have_their_order, MOVING),
    Check(feels_forces_or_refuses_them),
)
