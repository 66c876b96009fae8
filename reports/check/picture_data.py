"""What the pictures of a check are drawn from, as plain data: errors over time, and two poses."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from reference.forces import Spring
from reference.joints import Rod, Slot
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.trajectory import Trajectory, body_points, ground_points
from reports.check.checked import Checked, Tried
from reports.check.judging import UNITS, Errors, IdealMotion

Array = NDArray[np.float64]
Lines = list[list[list[float]]]  # lines of points of two coordinates [m]
Curves = dict[str, list[float]]  # errors over time by quantity, in its unit


@dataclass(frozen=True)
class Pose:
    """One pose: bars through the joints of each body, rods and springs, rails on which something slides [m]."""

    bars: Lines
    links: Lines
    rails: Lines


@dataclass(frozen=True)
class PictureData:
    """Errors over the times t [s] of three runs, those of quantities that are known, and a moment [s] in two poses.

    `advised` is None where the user's own settings are enough; `horizon` [s] where errors do not grow exponentially;
    `label`: what the first run is called.
    """

    t: list[float]
    own: Curves
    judge_t: list[float]
    judge: Curves
    advised_t: list[float]
    advised: Curves | None
    horizon: float | None
    moment: float
    ground: list[list[float]]
    ideal: Pose
    found: Pose
    label: str = "your settings"

    def as_text(self) -> str:
        """JSON, in which NaN may stand."""
        return json.dumps(asdict(self), sort_keys=True)


def from_text(text: str) -> PictureData:
    """Back from `PictureData.as_text`."""
    data = json.loads(text)
    return PictureData(**{**data, "ideal": Pose(**data["ideal"]), "found": Pose(**data["found"])})


def shown_of(found: Checked, advised: Tried | None = None) -> PictureData:
    """What is drawn of a check; `advised`: the settings beside the user's own, if not those that it advises."""
    advised = advised or found.advised
    other = None if advised is None or found.met else advised.errors
    return picture_data(found.reading.mechanism, found.judge, found.judge_errors, found.own, found.own_errors, other)


def picture_data(
    mechanism: Mechanism,
    ideal: IdealMotion,
    judge: Errors,
    run: Trajectory,
    own: Errors,
    other: Errors | None = None,
    label: str = PictureData.label,
) -> PictureData:
    """Of a run with its errors, beside the ideal motion, the judge's errors, and another run's."""
    known = [quantity for quantity in UNITS if np.isfinite(own.of[quantity]).any()]
    sample = int(np.argmax(np.where(np.isfinite(own.whole), own.whole, -1.0)))
    return PictureData(
        own.t.tolist(),
        _curves(own, known),
        judge.t.tolist(),
        _curves(judge, known),
        [] if other is None else other.t.tolist(),
        None if other is None else _curves(other, known),
        ideal.horizon if ideal.horizon < ideal.trajectory.t[-1] else None,
        float(own.t[sample]),
        ground_points(mechanism).tolist(),
        pose_of(mechanism, ideal.trajectory.pose[sample]),
        pose_of(mechanism, run.pose[sample]),
        label,
    )


def _curves(errors: Errors, known: list[str]) -> Curves:
    return {quantity: errors.of[quantity].tolist() for quantity in known}


def pose_of(mechanism: Mechanism, pose: Array) -> Pose:
    """What is drawn of a pose (bodies, 3) [m, m, rad]."""
    reach = 2 * max(mechanism.length_scale, float(np.ptp(mechanism.pose[:, :2], axis=0).max()))
    rails, links = [], []
    for joint in mechanism.joints:
        if isinstance(joint, Slot) and joint.first is None:
            way = 0.5 * reach * np.array([np.cos(joint.line_angle), np.sin(joint.line_angle)])
            place = _place(mechanism, pose, joint.second, joint.second_point)
            rails.append([(place - way).tolist(), (place + way).tolist()])
    for link in (*mechanism.joints, *mechanism.forces):
        if isinstance(link, Rod | Spring):
            first = _place(mechanism, pose, link.first, link.first_point)
            second = _place(mechanism, pose, link.second, link.second_point)
            if np.linalg.norm(second - first) < 3 * reach:  # not one that stands for a spring along a slide
                links.append([first.tolist(), second.tolist()])
    return Pose(_bars(mechanism, pose), links, rails)


def _bars(mechanism: Mechanism, pose: Array) -> Lines:
    """Every body as a bar through its joints; one with a single joint reaches to its centre of mass."""
    found = body_points(mechanism, pose)
    centres = [pose[mechanism.body_index(name)][:2] for name in found]
    return [
        (points if len(points) > 1 else np.vstack([points, centre])).tolist()
        for points, centre in zip(found.values(), centres, strict=True)
    ]


def _place(mechanism: Mechanism, pose: Array, name: str | None, point: tuple[float, float]) -> Array:
    """A body's own point in the world (2,) [m]."""
    if name is None:
        return np.array(point)
    x, y, angle = pose[mechanism.body_index(name)]
    return np.array([x, y]) + rotated(angle, np.array(point))
