"""Whether forces act: an engine that does not look at them moves as if there were none, and says nothing."""

from __future__ import annotations

import numpy as np

from engines import Unsupported
from engines.conformance.check import SAMPLES, STEP, Check, Fails, Subject, finite, require_a_sentence
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Pin
from reference.mechanism import Body, Mechanism

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
    """What the plate's rate gains by then [rad/s], by RK4 of its one angle: nothing of ours but the forces."""
    rest = np.zeros((1, 3))

    def turning(state: np.ndarray) -> np.ndarray:
        pose, twist = rest.copy(), rest.copy()
        pose[0, 2], twist[0, 2] = state
        return np.array([state[1], mechanism.applied.on(pose, twist)[0, 2] / _PLATE.inertia])

    state, step = np.array([_PLATE.pose[2], _PLATE.twist[2]]), until / 200
    for _ in range(200):
        one = turning(state)
        two = turning(state + step / 2 * one)
        three = turning(state + step / 2 * two)
        state = state + step / 6 * (one + 2 * two + 2 * three + turning(state + step * three))
    return float(state[1] - _PLATE.twist[2])


CHECKS = (Check(feels_forces_or_refuses_them),)
