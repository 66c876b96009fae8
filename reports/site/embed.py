"""A take with its motions, and the forces of the exact one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.joints import Drive
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reports.model.tasks import Answer, trajectory_of
from reports.site.drawn import between, demanded, place_of
from reports.site.lesson import Take

Array = NDArray[np.float64]

DIGITS = 6  # of forces and their places, after the point


@dataclass(frozen=True)
class Shown:
    """A take with its motions: what pictures are made of."""

    take: Take
    mechanism: Mechanism
    t: Array  # (frames,) s
    truth: Trajectory
    motions: Mapping[str, Array]  # legend -> poses (frames, bodies, 3), NaN where the method gave up
    lost: Mapping[str, str]  # legend -> why there is no motion


def shown(take: Take, answers: Mapping[Any, Answer]) -> Shown:
    """The take at its frames. A method that was not run, or did not finish, is told in `lost`."""
    motions: dict[str, Array] = {}
    lost: dict[str, str] = {}
    spacing = take.scene.duration / take.sample_count
    t = np.arange(take.sample_count + 1, dtype=np.float64)[take.shown] * np.float64(spacing)
    for word, motion in take.motions().items():
        answer = answers.get(motion)
        if answer is None or not answer.finished:
            lost[word] = "not run" if answer is None else f"{answer.outcome}: {answer.sentence}".rstrip(": ")
            continue
        found = trajectory_of(answer)
        motions[word] = found.pose[take.shown]
    return Shown(take, take.scene.mechanism(), t, take.scene.motion(t), motions, lost)


def forces(mechanism: Mechanism, truth: Trajectory) -> list[dict[str, Any]]:
    """The reaction of each joint on its second body: where it acts [m] and the force [N], two numbers an instant.

    Of a rolling contact also the friction that it demands [1]. Nothing for a drive, whose reaction is a torque. With
    `partly` the motion does not determine all of a force, and what it does determine is told.
    """
    found, row = [], 0
    for joint in mechanism.joints:
        own = truth.reaction[:, row : row + joint.size]
        row += joint.size
        known = np.isfinite(own)
        if isinstance(joint, Drive) or not (known.any() or isinstance(joint, Roll)):
            continue
        first, second = between(mechanism, joint, truth.pose)
        across = joint.rows(first, second)[..., 3:5]
        told: dict[str, Any] = {"name": joint.name, "at": _listed(place_of(joint, first, second))}
        told |= {"force": _listed(np.einsum("ti,tij->tj", np.nan_to_num(own), across)), "partly": not bool(known.all())}
        if isinstance(joint, Roll):
            told["contact"] = True
            if known.all():
                normal = own[:, 1:] * across[:, 1]
                told |= {"normal": _listed(normal), "friction": _listed(demanded(own))}
        found.append(told)
    return found


def _listed(values: Array, digits: int = DIGITS) -> list[float | None]:
    """All numbers one after another; None where there is none, since JSON has no NaN."""
    flat = np.asarray(values, dtype=float).ravel()
    return [round(value, digits) + 0.0 if np.isfinite(value) and abs(value) < 1e6 else None for value in flat.tolist()]
