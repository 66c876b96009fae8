"""What the page needs to run the engines itself: the models that our adapters make, as text and numbers.

Nothing is stepped here. A model is made for every place of the sliders; what differs between places is kept as a
table of numbers, so that the page has no mechanism of its own. Truth, where it is no closed form, is the reference's.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from typing import Any
from unittest.mock import patch

import pymunk as pymunk_package

from engines import mujoco, pymunk
from engines.mujoco.model import Model
from engines.mujoco.written_model import Written
from reference.four_bar.scenes import DrivenFourBar, FourBarScene, FreeFourBar

CRANKS = (0.2, 0.3, 0.4, 0.42, 0.45)  # m; the chapter's is 0.4
COUPLERS = (
    0.53,
    0.4 * 2**0.5,
    0.65,
    0.75,
    0.9,
)  # m; the chapter's is 0.566; every crank can turn
RATIOS = (0.01, 0.1, 1.0, 10.0, 100.0)  # of the coupler's density to that of the others
SAMPLES = 60  # of a revolution
FREE_SAMPLES = 100
NUMBER = re.compile(r"(?<=[\" ])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?=[\" ])")


@dataclass(frozen=True)
class Place:
    """One place of the sliders: the scene with these numbers, as text of MJCF and as what pymunk holds."""

    scene: FourBarScene
    text: str
    start: tuple[float, ...]  # qvel in MuJoCo's order
    mean_inertia: float
    munk: tuple[float, ...]


def data() -> dict[str, Any]:
    """All that the page needs, for JSON."""
    driven = [place(DrivenFourBar(crank=a, coupler=b, density=(1.0, c, 1.0))) for a, b, c in corners()]
    free = place(FreeFourBar())
    default = DrivenFourBar()
    times = [index * free.scene.duration / FREE_SAMPLES for index in range(FREE_SAMPLES + 1)]
    return {
        "cranks": CRANKS,
        "couplers": COUPLERS,
        "ratios": RATIOS,
        "lengths": {"rocker": default.rocker, "ground": default.ground, "start": default.start, "rate": default.rate},
        "options": options(default),
        "links": links(default),
        "bodies": ["crank", "coupler", "rocker"],
        "joints": joints(),
        "driven": {"samples": SAMPLES, "duration": default.duration, **told(driven)},
        "free": {
            "samples": FREE_SAMPLES,
            "duration": free.scene.duration,
            "truth": free.scene.motion(times).pose.ravel().tolist(),
            **told([free]),
        },
    }


def corners() -> Iterator[tuple[float, float, float]]:
    """Crank, coupler [m] and ratio of densities at every place of the sliders, in the order of the tables."""
    return itertools.product(CRANKS, COUPLERS, RATIOS)


def place(scene: FourBarScene) -> Place:
    """The scene's models as shipped, in both engines."""
    model, text = written(scene)
    velocity = tuple(model.start().qvel.tolist())
    return Place(scene, text, velocity, float(model.compiled.stat.meaninertia), munk(scene))


def told(places: Sequence[Place]) -> dict[str, Any]:
    """Templates with the numbers that differ from place to place."""
    parts = [NUMBER.split(each.text) for each in places]
    numbers = [NUMBER.findall(each.text) for each in places]
    if len({tuple(each) for each in parts}) != 1:
        raise ValueError("the models of a slider's places differ in more than numbers")
    return {
        "mjcf": parts[0],
        "numbers": [",".join(each) for each in numbers],
        "start": [list(each.start) for each in places],
        "meanInertia": [each.mean_inertia for each in places],
        "munk": [list(each.munk) for each in places],
        "masses": [[body.mass for body in each.scene.mechanism().bodies] for each in places],
    }


@contextmanager
def _written_by_our_own() -> Iterator[None]:
    """Models are built as MJCF text, which keeps all digits: MuJoCo's own writer keeps six."""
    with patch("engines.mujoco.model.new_specification", Written):
        yield


@cache
def written(scene: FourBarScene) -> tuple[Model, str]:
    """The model as shipped, and its text."""
    texts: list[str] = []
    whole = Written.text

    def kept(self: Written) -> str:
        texts.append(whole(self))
        return texts[-1]

    with _written_by_our_own(), patch.object(Written, "text", kept):
        model = mujoco.DEFAULT.model(scene.mechanism(), 1e-3)
    return model, texts[-1]


def options(scene: FourBarScene) -> dict[str, Any]:
    """MuJoCo's options that are no sliders, of a default model, as they are in the compiled one."""
    option = written(scene)[0].compiled.opt
    return {
        "gravity": option.gravity.tolist(),
        "disableflags": int(option.disableflags),
        "jacobian": int(option.jacobian),
    }


def links(scene: FourBarScene) -> list[dict[str, Any]]:
    """The tree: each body, its parent, and where its coordinate stands in qpos."""
    model = written(scene)[0]
    tree, address = model.tree, model.address
    if any(link.kind != "hinge" for link in tree.links):
        raise ValueError("the page knows hinges alone")
    return [{"body": link.body, "parent": link.parent, "column": address[link.column]} for link in tree.links]


def joints() -> list[dict[str, Any]]:
    """The pins: the bodies and on which end of a bar each sits; -1 for the ground."""
    return [
        {"name": "A", "first": -1, "second": 0, "ends": [None, -1]},
        {"name": "B", "first": 0, "second": 1, "ends": [1, -1]},
        {"name": "C", "first": 1, "second": 2, "ends": [1, 1]},
        {"name": "D", "first": -1, "second": 2, "ends": [None, -1]},
    ]


def munk(scene: FourBarScene) -> tuple[float, ...]:
    """What pymunk's model holds, as shipped: gravity; bodies; pivots.

    A body: kind (0 dynamic, 1 kinematic), mass, moment, x, y, angle, vx, vy, rate, and its origin in our frame. A
    pivot: the places of its bodies, -1 for the ground, and its two anchors.
    """
    model = pymunk.DEFAULT.model(scene.mechanism(), 1e-3)
    flat: list[float] = [*model.space.gravity, len(model.bodies)]
    for body, origin in zip(model.bodies, model.origins, strict=True):
        kinematic = body.body_type == pymunk_package.Body.KINEMATIC
        weight = (1.0, 1.0) if kinematic else (body.mass, body.moment)
        flat += [float(kinematic), *weight, *body.position, body.angle, *body.velocity, body.angular_velocity, *origin]
    places: dict[Any, int] = {body: index for index, body in enumerate(model.bodies)}
    # In the order in which the adapter added them: the solver sweeps in this order.
    for pivot in _constraints(model.space):
        flat += [places.get(pivot.a, -1), places.get(pivot.b, -1), *pivot.anchor_a, *pivot.anchor_b]
    return tuple(map(float, flat))


def _constraints(space: Any) -> list[Any]:
    return list(space._constraints)


def with_sliders(crank: float, coupler: float, ratio: float, rate: float) -> DrivenFourBar:
    """The scene that the page shows at a place of its sliders."""
    return replace(DrivenFourBar(), crank=crank, coupler=coupler, density=(1.0, ratio, 1.0), rate=rate)
