"""The four-bar in MuJoCo, cut at each of its pins in turn: what the choice does to the motion."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.scene import Scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model.tasks import Task, Values

Array = NDArray[np.float64]
LOOP = FreeFourBar()
STEP = 1e-3  # s
LINES_OF_LOOPS = (Path(__file__).parents[1] / "your_loop/lines/options.txt").read_text(encoding="utf-8")


@dataclass(frozen=True)
class CutLoop(Task):
    """The free four-bar whose pin `cut` is MuJoCo's connect, with these lines at the end of its file.

    `exact`: with the flag `diagexact`.
    """

    cut: str
    exact: bool
    lines: str = LINES_OF_LOOPS
    scene: Scene = LOOP

    @property
    def cost(self) -> float:
        return 0.5

    @property
    def label(self) -> str:
        return f"loop cut at {self.cut}"

    def run(self) -> Values:
        """`angle`: the largest error of a body's angle [rad]."""
        scene, mechanism = self.scene, self.scene.mechanism()
        text, hinges = cut_open(mechanism, self.cut)
        flag = '<option><flag diagexact="enable"/></option>' if self.exact else ""
        model = mujoco.MjModel.from_xml_string(text.replace("</mujoco>", f"{flag}{self.lines}</mujoco>"))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        truth = scene.motion(np.linspace(0, scene.duration, scene.samples + 1)).pose[..., 2]
        worst, steps = 0.0, round(scene.duration / scene.samples / STEP)
        for angles in truth[1:]:
            mujoco.mj_step(model, data, steps)
            turned: dict[str | None, float] = {None: 0.0}
            for (parent, child), angle in zip(hinges, data.qpos, strict=True):
                turned[child] = turned[parent] + float(angle)
            off = [turned[body.name] - way for body, way in zip(mechanism.bodies, angles - truth[0], strict=True)]
            worst = max(worst, *map(abs, off))
        return {"angle": np.array(worst)}


def cut_open(mechanism: Mechanism, cut: str) -> tuple[str, list[tuple[str | None, str]]]:
    """MJCF of a loop of pins, a tree of hinges but for the pin `cut`, and (parent, child) of each hinge in order."""
    pins = {pin.name: (pin.first, pin.second) for pin in mechanism.joints}
    places = {pin.name: _place(mechanism, pin.first, pin.first_point) for pin in mechanism.joints}  # type: ignore[union-attr]
    hinges: list[tuple[str | None, str]] = []
    origins: dict[str | None, Array] = {None: np.zeros(2)}

    def hung(parent: str | None) -> str:
        """The bodies on a parent, each in a frame at its hinge that is parallel to the world's."""
        text = ""
        for name, ends in pins.items():
            child = next((end for end in ends if end != parent and end not in origins), None)
            if name == cut or parent not in ends or child is None:
                continue
            hinges.append((parent, child))
            origins[child], body = places[name], mechanism.bodies[mechanism.body_index(child)]
            centre, turn = np.array(body.pose[:2]) - places[name], " ".join([repr(body.inertia)] * 3)
            text += f'<body name="{child}" pos="{_spelled(places[name] - origins[parent])}"><joint axis="0 0 1"/>'
            text += (
                f'<inertial pos="{_spelled(centre)}" mass="{body.mass!r}" diaginertia="{turn}"/>{hung(child)}</body>'
            )
        return text

    bodies = hung(None)
    held = next(end for end in pins[cut] if end is not None)
    other = next((end for end in pins[cut] if end != held), None) or "world"
    connect = f'<connect body1="{held}" body2="{other}" anchor="{_spelled(places[cut] - origins[held])}"/>'
    rates = {None: 0.0, **{body.name: body.twist[2] for body in mechanism.bodies}}
    start = " ".join(repr(rates[child] - rates[parent]) for parent, child in hinges)
    return (
        f'<mujoco><option timestep="{STEP!r}" gravity="{_spelled(mechanism.gravity)}"/><worldbody>{bodies}</worldbody>'
        f'<equality>{connect}</equality><keyframe><key qvel="{start}"/></keyframe></mujoco>',
        hinges,
    )


def _place(mechanism: Mechanism, name: str | None, point: tuple[float, float]) -> Array:
    if name is None:
        return np.array(point)
    x, y, angle = mechanism.pose[mechanism.body_index(name)]
    return np.array([x, y]) + rotated(angle, np.array(point))


def _spelled(vector: Sequence[float] | Array) -> str:
    """(x, y) as MJCF has it, in the plane z = 0."""
    return " ".join(repr(float(value)) for value in (*vector, 0.0))


CUTS = {(pin.name, exact): CutLoop(pin.name, exact) for pin in LOOP.mechanism().joints for exact in (False, True)}
