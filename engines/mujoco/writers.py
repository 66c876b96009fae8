"""What `crosscheck export` and `view` ask of MuJoCo: MJCF and URDF that run without this suite, and its viewer."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as xml

from engines import Unsupported
from engines.capability import Capability
from engines.mujoco.methods import VARIANTS
from engines.tree import Link, spanning_tree
from reference.joints import Drive, Pin, Slot, Weld
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Mjcf:
    """MJCF by a variant's settings, with the start as a keyframe."""

    suffix: str = ".xml"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        """The file's text. Raises Unsupported where no file can hold it, ValueError for an unknown variant."""
        known = {engine.variant: engine for engine in VARIANTS}
        if variant not in known:
            raise ValueError(f"--variant is {variant!r}; it must be one of {', '.join(known)}")
        return known[variant].text(mechanism, dt)

    def commented(self, text: str, lines: Sequence[str]) -> str:
        """The text with a comment before it."""
        told = "\n".join(lines).replace("--", "- -")
        return f"<!--\n{told}\n-->\n{text}"


@dataclass(frozen=True)
class Urdf(Mjcf):
    """URDF, which knows no settings: of any variant the same."""

    suffix: str = ".urdf"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        """The file's text. Raises Unsupported for what URDF has no word for."""
        return urdf(mechanism)


def show(text: str) -> None:
    """MJCF in MuJoCo's viewer, from its start, until the window is closed. Raises Unsupported where there is none."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise Unsupported("there is no display")
    try:
        import mujoco
        import mujoco.viewer  # an extra of MuJoCo's: it asks for a window system
    except ImportError as reason:
        raise Unsupported(f"MuJoCo's viewer is not installed: {reason}") from None
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    with mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False) as window:
        while window.is_running():
            begin = time.monotonic()
            mujoco.mj_step(model, data)
            window.sync()
            time.sleep(max(0.0, model.opt.timestep - (time.monotonic() - begin)))


MJCF, URDF = Mjcf(), Urdf()
IN_URDF = Capability("URDF", frozenset({Pin, Slot, Weld, Drive}), frozenset())


def urdf(mechanism: Mechanism) -> str:
    """The file's text. Raises Unsupported for loops, free bodies, prescribed motions, and forces."""
    IN_URDF.require(mechanism)
    tree = spanning_tree(mechanism)
    for joint in tree.loops:
        raise Unsupported(f"joint {joint.name!r} closes a loop, which a URDF can't hold")
    for joint in mechanism.joints:
        if isinstance(joint, Drive) and joint not in tree.kept:
            raise Unsupported(f"drive {joint.name!r} prescribes a motion, which URDF has no word for")
    root = xml.Element("robot", {"name": "crosscheck"})
    xml.SubElement(xml.SubElement(root, "mujoco"), "option", {"gravity": _row(*_upright(*mechanism.gravity))})
    if mechanism.twist.any():
        root.append(
            xml.Comment(" The mechanism starts in motion, which URDF has no word for: here it starts at rest. ")
        )
    xml.SubElement(root, "link", {"name": "world"})
    for link in tree.links:
        _add(root, mechanism, link)
    xml.indent(root)
    return xml.tostring(root, encoding="unicode") + "\n"


def _add(root: xml.Element, mechanism: Mechanism, link: Link) -> None:
    """A body's frame is its joint's point, parallel to the world at the start."""
    body = mechanism.bodies[link.body]
    if link.kind == "free" or (link.kind == "slot" and link.turns):
        raise Unsupported(f"body {body.name!r} is held by less than a hinge or a slide, which URDF has no joint for")
    element = xml.SubElement(root, "link", {"name": body.name})
    inertial = xml.SubElement(element, "inertial")
    xml.SubElement(inertial, "origin", {"xyz": _row(*_upright(-link.anchor[0], -link.anchor[1])), "rpy": "0 0 0"})
    xml.SubElement(inertial, "mass", {"value": repr(float(body.mass))})
    tensor = {name: repr(float(body.inertia)) for name in ("ixx", "iyy", "izz")} | dict.fromkeys(
        ("ixy", "ixz", "iyz"), "0"
    )
    xml.SubElement(inertial, "inertia", tensor)
    kind = "prismatic" if link.kind == "slot" else "continuous" if link.turns else "fixed"
    parent = "world" if link.parent is None else mechanism.bodies[link.parent].name
    joint = xml.SubElement(root, "joint", {"name": f"joint of {body.name}", "type": kind})
    xml.SubElement(joint, "parent", {"link": parent})
    xml.SubElement(joint, "child", {"link": body.name})
    at = link.arm
    if link.parent is not None:
        base = _anchor(mechanism, link.parent)
        at = (at[0] - base[0], at[1] - base[1])
    xml.SubElement(joint, "origin", {"xyz": _row(*_upright(*at)), "rpy": "0 0 0"})
    axis = (0.0, -1.0, 0.0) if link.kind == "hinge" else _upright(*link.direction)
    if kind != "fixed":
        xml.SubElement(joint, "axis", {"xyz": _row(*axis)})
    if link.kind == "slot":
        xml.SubElement(joint, "limit", {"lower": "-1e9", "upper": "1e9", "effort": "1e9", "velocity": "1e9"})


def _anchor(mechanism: Mechanism, body: int) -> tuple[float, float]:
    """The joint's point of a body's own link from its centre of mass, with world directions at the start [m]."""
    return next(link.anchor for link in spanning_tree(mechanism).links if link.body == body)


def _upright(x: float, y: float) -> tuple[float, float, float]:
    """A vector of the plane in URDF's frame."""
    return (x, 0.0, y)


def _row(*values: Any) -> str:
    return " ".join(repr(float(value) if not math.isclose(value, 0.0, abs_tol=0.0) else 0.0) for value in values)
