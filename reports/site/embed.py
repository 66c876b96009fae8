"""A take as the data that a page carries: the truth at samples, methods over it, joints and forces; and its drawing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.joints import Drive, Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reports.model.tasks import Answer, trajectory_of
from reports.site import drawn
from reports.site.drawn import between, demanded, joints_of, loose, measure_of, opened, place_of
from reports.site.lesson import Take

Array = NDArray[np.float64]

TRUTH_DIGITS = 13  # of poses, after the point: half of the last is below 1e-13, so that a page holds the truth to 1e-12
METHOD_DIGITS = 11  # of openings, after the point
APART = 5  # significant digits of how far a method is from the truth
DIGITS = 9  # of twists, which only place the instant centre


@dataclass(frozen=True)
class Shown:
    """A take with its motions: what `data` and `picture` are made of."""

    take: Take
    mechanism: Mechanism
    t: Array  # (frames,) s
    truth: Trajectory
    motions: Mapping[str, Array]  # legend -> poses (frames, bodies, 3), NaN where the method gave up
    twists: Mapping[str, Array]  # legend -> twists, as the poses
    lost: Mapping[str, str]  # legend -> why there is no motion


def shown(take: Take, answers: Mapping[Any, Answer]) -> Shown:
    """The take at its frames. A method that was not run, or did not finish, is told in `lost`."""
    motions: dict[str, Array] = {}
    twists: dict[str, Array] = {}
    lost: dict[str, str] = {}
    spacing = take.scene.duration / take.sample_count
    t = np.arange(take.sample_count + 1, dtype=np.float64)[take.shown] * np.float64(spacing)
    for word, motion in take.motions().items():
        answer = answers.get(motion)
        if answer is None or not answer.finished:
            lost[word] = "not run" if answer is None else f"{answer.outcome}: {answer.sentence}".rstrip(": ")
            continue
        found = trajectory_of(answer)
        motions[word], twists[word] = found.pose[take.shown], found.twist[take.shown]
    return Shown(take, take.scene.mechanism(), t, take.scene.motion(t), motions, twists, lost)


def data(shown: Shown) -> dict[str, Any]:
    """What the page's script needs, in plain lists: poses one instant after another, body after body.

    A method's are told by how far they are from the truth; the truth's twists are those of the body `centre` alone.
    """
    mechanism, truth = shown.mechanism, shown.truth
    centre = None if shown.take.centre is None else mechanism.body_index(shown.take.centre)
    turning = truth.twist[:, [] if centre is None else [centre]]
    return {
        "t": _listed(shown.t),
        "bodies": [body.name for body in mechanism.bodies],
        "joints": joints_of(mechanism),
        "loose": openings(shown),
        "measure": measure_of(mechanism),
        "size": mechanism.length_scale,
        "truth": {"pose": _listed(truth.pose), "twist": _listed(turning, DIGITS)},
        "motions": [{"name": name, "apart": _apart(pose, truth.pose)} for name, pose in shown.motions.items()],
        "lost": [{"name": name, "why": why} for name, why in shown.lost.items()],
        "forces": forces(mechanism, truth),
        "centre": centre,
        "traces": [{"body": mechanism.body_index(body), "point": list(point)} for body, point in shown.take.traces],
    }


def openings(shown: Shown) -> list[dict[str, Any]]:
    """Skates and rolling contacts: where they are by the truth [m], and how they slip or part in each motion."""
    mechanism, truth = shown.mechanism, shown.truth
    return [
        {
            "name": joint.name,
            "unit": "m/s" if isinstance(joint, Skate) else "m",
            "at": _listed(place_of(joint, *between(mechanism, joint, truth.pose)), 6),
            "motions": [
                _listed(opened(mechanism, joint, pose, shown.twists[name]), METHOD_DIGITS)
                for name, pose in shown.motions.items()
            ],
        }
        for joint in loose(mechanism)
    ]


def forces(mechanism: Mechanism, truth: Trajectory) -> list[dict[str, Any]]:
    """The reaction of each joint on its second body: where it acts [m] and the force [N], two numbers an instant.

    Of a rolling contact also the friction that it demands [1]. Nothing for a drive, whose reaction is a torque, and for
    a joint whose reaction the motion does not determine.
    """
    found, row = [], 0
    for joint in mechanism.joints:
        own = truth.reaction[:, row : row + joint.size]
        row += joint.size
        if isinstance(joint, Drive) or not np.all(np.isfinite(own)):
            continue
        first, second = between(mechanism, joint, truth.pose)
        force = np.einsum("ti,tij->tj", own, joint.rows(first, second)[..., 3:5])
        told = {
            "name": joint.name,
            "at": _listed(place_of(joint, first, second), 6),
            "force": _listed(force, 6),
        }
        if isinstance(joint, Roll):
            normal = own[:, 1:] * joint.rows(first, second)[:, 1, 3:5]
            told |= {"normal": _listed(normal, 6), "friction": _listed(demanded(own), 6)}
        found.append(told)
    return found


def _apart(pose: Array, truth: Array) -> list[float | None]:
    """How far poses are from the truth, which is less to read than the poses are; None where there is none."""
    flat = (pose - truth).ravel().tolist()
    return [float(f"{value:.{APART}g}") if np.isfinite(value) and abs(value) < 1e6 else None for value in flat]


def _listed(values: Array, digits: int = TRUTH_DIGITS) -> list[float | None]:
    """All numbers one after another; None where there is none, since JSON has no NaN."""
    flat = np.asarray(values, dtype=float).ravel()
    return [round(value, digits) + 0.0 if np.isfinite(value) and abs(value) < 1e6 else None for value in flat.tolist()]


def picture(shown: Shown, label: str) -> str:
    """The drawing at the first instant, with the whole paths: an SVG that stands without any script."""
    take, mechanism = shown.take, shown.mechanism
    left, bottom, width, height = drawn.box(mechanism, take, shown.truth.pose)
    box = " ".join(drawn.number(value) for value in (left, -bottom - height, width, height))
    shapes = [drawn.body_shape(mechanism, take, body.name) for body in mechanism.bodies]
    groups = []
    everything = [*shown.motions.items(), ("truth", shown.truth.pose)]  # the truth last: it is drawn over the others
    for index, (name, pose) in enumerate(everything):
        kind = "truth" if name == "truth" else f"method method-{index + 1}"
        paths = "".join(
            f'<path class="trace" d="{_trace(pose[:, mechanism.body_index(body)], point)}"/>'
            for body, point in take.traces
        )
        bodies = "".join(
            f'<g class="body" transform="{drawn.placed(where)}">{shape}</g>'
            for where, shape in zip(pose[0], shapes, strict=True)
        )
        groups.append(f'<g class="motion {kind}"><g class="traces">{paths}</g>{bodies}</g>')
    return (
        f'<svg class="stage" viewBox="{box}" role="img" aria-label="{escape(label)}">'
        f'<g class="world" transform="scale(1 -1)"><g class="ground">{drawn.ground(mechanism, take, shown.truth.pose)}'
        f'</g>{"".join(groups)}<g class="overlay"></g></g></svg>'
    )


def _trace(pose: Array, point: tuple[float, float]) -> str:
    whole = pose[np.all(np.isfinite(pose), axis=-1)]
    return drawn.path(drawn.point_path(whole, point)) if len(whole) else ""
