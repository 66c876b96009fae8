"""Writers of MJCF and URDF files for `crosscheck export`, and MuJoCo's viewer for `crosscheck view`.

The files do not need this suite. An MJCF file is the output of `mujoco.MjSpec` with all digits instead of six. Bodies
keep the mechanism's names, and the initial state is a keyframe. Bars and points without mass and contacts show the
mechanism.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as xml

import mujoco
import numpy as np

from engines import Unsupported
from engines.capability import Capability
from engines.mujoco.releases import spelled
from engines.reading import Names
from engines.tree import Link, spanning_tree
from reference.joints import Drive, Pin, Slot, Vector, Weld
from reference.mechanism import Mechanism
from reference.plane import rotated

if TYPE_CHECKING:
    from engines.mujoco.model import MuJoCoModel

MODEL_FLAGS = ("contact", "island")  # flags that our models may disable
TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
THICKNESS = 0.02  # thickness of bars relative to the mechanism's length
NO_CONTACT = {"contype": "0", "conaffinity": "0", "mass": "0"}


@dataclass(frozen=True)
class Mjcf:
    suffix: str = ".xml"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        from engines.mujoco.methods import VARIANTS

        known = {engine.variant: engine for engine in VARIANTS}
        if variant not in known:
            raise ValueError(f"--variant is {variant!r}; it must be one of {', '.join(known)}")
        return known[variant].text(mechanism, dt)

    def commented(self, text: str, lines: Sequence[str]) -> str:
        comment = "\n".join(lines).replace("--", "- -")
        return f"<!--\n{comment}\n-->\n{text}"


@dataclass(frozen=True)
class Urdf(Mjcf):
    """URDF has no settings, so the file is the same for all variants."""

    suffix: str = ".urdf"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        return urdf(mechanism)


def show(text: str) -> None:
    """Show the motion of an MJCF model in MuJoCo's viewer. Raises Unsupported if there is no viewer or no display."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise Unsupported("there is no display")
    try:
        import mujoco.viewer  # this optional part of MuJoCo needs a window system
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
URDF_CAPABILITY = Capability("URDF", frozenset({Pin, Slot, Weld, Drive}), frozenset())


def urdf(mechanism: Mechanism) -> str:
    URDF_CAPABILITY.require(mechanism)
    tree = spanning_tree(mechanism)
    for joint in tree.loops:
        raise Unsupported(f"joint {joint.name!r} closes a loop, which a URDF can't hold")
    for joint in mechanism.joints:
        if isinstance(joint, Drive) and not tree.holds(joint):
            raise Unsupported(f"drive {joint.name!r} prescribes a motion, which URDF cannot represent")
    root = xml.Element("robot", {"name": "crosscheck"})
    xml.SubElement(xml.SubElement(root, "mujoco"), "option", {"gravity": _upright(*mechanism.gravity)})
    if mechanism.twist.any():
        root.append(
            xml.Comment(" URDF cannot state the initial velocities of the mechanism, so it starts at rest here. ")
        )
    xml.SubElement(root, "link", {"name": "world"})
    anchors = {link.body: link.anchor for link in tree.links}
    for link in tree.links:
        _add_link(root, mechanism, link, anchors)
    return _text(root)


def _add_link(root: xml.Element, mechanism: Mechanism, link: Link, anchors: Mapping[int, Vector]) -> None:
    body = mechanism.bodies[link.body]
    if link.kind == "free" or (link.kind == "slot" and link.turns):
        raise Unsupported(f"body {body.name!r} has more freedom than a hinge or a slide, which URDF cannot represent")
    inertial = xml.SubElement(xml.SubElement(root, "link", {"name": body.name}), "inertial")
    xml.SubElement(inertial, "origin", {"xyz": _upright(-link.anchor[0], -link.anchor[1]), "rpy": "0 0 0"})
    xml.SubElement(inertial, "mass", {"value": repr(float(body.mass))})
    tensor = {f"i{axes}": repr(float(body.inertia)) if axes[0] == axes[1] else "0" for axes in TENSOR}
    xml.SubElement(inertial, "inertia", tensor)
    kind = "prismatic" if link.kind == "slot" else "continuous" if link.turns else "fixed"
    joint = xml.SubElement(root, "joint", {"name": f"joint of {body.name}", "type": kind})
    parent = "world" if link.parent is None else mechanism.bodies[link.parent].name
    base = (0.0, 0.0) if link.parent is None else anchors[link.parent]
    xml.SubElement(joint, "parent", {"link": parent})
    xml.SubElement(joint, "child", {"link": body.name})
    xml.SubElement(joint, "origin", {"xyz": _upright(link.arm[0] - base[0], link.arm[1] - base[1]), "rpy": "0 0 0"})
    if kind != "fixed":
        axis = _row((0.0, -1.0, 0.0)) if link.kind == "hinge" else _upright(*link.direction)
        xml.SubElement(joint, "axis", {"xyz": axis})
    if link.kind == "slot":
        xml.SubElement(joint, "limit", {"lower": "-1e9", "upper": "1e9", "effort": "1e9", "velocity": "1e9"})


def _upright(x: float, y: float) -> str:
    """A vector of the plane in the frame of a URDF file, in which z is upwards."""
    return _row((x, 0.0, y))


def mjcf(model: MuJoCoModel) -> str:
    """The MJCF of a model with unit 1 kg. Raises Unsupported if our code changes the model or runs in its steps."""
    if model.hooks:
        raise Unsupported("this variant needs our code in every step, which a file does not contain")
    if model.softening != 1:
        raise Unsupported("this variant changes compliances, which a file cannot state; choose default or tuned")
    root = xml.fromstring(model.spec.to_xml())
    root.set("model", "crosscheck")
    root.remove(root.find("option"))  # pyright: ignore[reportArgumentType]
    root.insert(1, _option(model.compiled.opt))
    _write_all_digits(root, model.spec, model.compiled)
    add_visuals(root, model.mechanism)
    _rename(root, model)
    start = model.start()
    key = {"name": "start", "qpos": _row(start.qpos), "qvel": _row(start.qvel)}
    if model.compiled.nu:
        key["ctrl"] = _row(start.ctrl)
    xml.SubElement(xml.SubElement(root, "keyframe"), "key", key)
    return _text(root)


def _text(root: xml.Element) -> str:
    xml.indent(root)
    return xml.tostring(root, encoding="unicode") + "\n"


def _option(option: Any) -> xml.Element:
    attributes = {name: _row(getattr(option, name)) for name in ("timestep", "gravity", "tolerance")}
    for name in ("Integrator", "Solver", "Jacobian", "Cone"):
        attributes[name.lower()] = spelled(getattr(mujoco, f"mjt{name}")(getattr(option, name.lower())))
    element = xml.Element("option", attributes | {"iterations": str(int(option.iterations))})
    bits = {flag: int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag.upper()}")) for flag in MODEL_FLAGS}
    off = [flag for flag, bit in bits.items() if option.disableflags & bit]
    if off:
        xml.SubElement(element, "flag", dict.fromkeys(off, "disable"))
    return element


def _write_all_digits(root: xml.Element, spec: Any, compiled: Any) -> None:
    """Replace the numbers in the text of a mujoco.MjSpec, which have only six digits.

    Positions of shapes come from the compiled model, since our code raises the plane below a blade after compilation.
    """
    for element in root.iter("body"):
        body = spec.body(element.get("name"))
        _set(element, pos=body.pos)
        _set(element.find("inertial"), pos=body.ipos, mass=body.mass, diaginertia=body.inertia)
        for child in element.findall("joint"):
            joint = spec.joint(child.get("name"))
            _set(child, axis=joint.axis, pos=joint.pos, armature=joint.armature)
    for element in root.iter("geom"):
        shape, size = compiled.geom(element.get("name")), len(element.get("size", "").split())
        _set(element, pos=shape.pos, quat=shape.quat, size=shape.size[:size])
    for element in root.iterfind("worldbody//site"):
        _set(element, pos=spec.site(element.get("name")).pos)
    coefficients = iter(compiled.wrap_prm)
    for element in root.find("tendon") or ():
        tendon = spec.tendon(element.get("name"))
        # In newer releases these coefficients are polynomials, which are written without trailing zeros.
        polynomials = {name: np.trim_zeros(np.ravel(getattr(tendon, name)), "b") for name in ("stiffness", "damping")}
        _set(element, springlength=tendon.springlength, **polynomials)
        for child, coefficient in zip(element, coefficients, strict=False):
            if child.tag == "joint":
                _set(child, coef=coefficient)
    for number, (element, equality) in enumerate(zip(root.find("equality") or (), spec.equalities, strict=True)):
        _set(element, solref=equality.solref, solimp=equality.solimp)
        if element.tag == "weld":
            _set(element, relpose=compiled.eq_data[number][3:10])
        if element.tag != "tendon":
            _set(element, anchor=equality.data[:3])
    for element, pair in zip(root.find("contact") or (), spec.pairs, strict=True):
        names = ("friction", "solref", "solimp", "solreffriction", "margin")
        _set(element, **{name: getattr(pair, name) for name in names})
    for element, actuator in zip(root.find("actuator") or (), spec.actuators, strict=True):
        _set(element, gear=actuator.gear, biasprm=actuator.biasprm, gainprm=actuator.gainprm)


def _set(element: xml.Element | None, **numbers: Any) -> None:
    """Set attributes of an element, except zeros that the text does not contain."""
    assert element is not None
    for name, values in numbers.items():
        if np.any(values) or name in element.attrib:
            element.set(name, _row(values))


def _rename(root: xml.Element, model: MuJoCoModel) -> None:
    old = [f"body {number}" for number in range(len(model.mechanism.bodies))]
    names = Names()
    for other in ("world", *(element.get("name", "") for element in root.iter("body"))):
        if other not in old:
            names.new(other)
    new = dict(zip(old, (names.new(body.name) for body in model.mechanism.bodies), strict=True))
    for element in root.iter():
        for attribute in ("name", "body", "body1", "body2"):
            value = element.get(attribute)
            if value in new and (attribute != "name" or element.tag == "body"):
                element.set(attribute, new[value])


def _row(values: Any) -> str:
    return " ".join(repr(float(value) + 0.0) for value in np.ravel(values))


def add_visuals(root: xml.Element, mechanism: Mechanism) -> None:
    """Add bars between the joints of bodies without shapes, and a camera that looks at the plane."""
    size = THICKNESS * mechanism.length_scale
    visual = xml.Element("visual")
    xml.SubElement(visual, "global", {"azimuth": "90", "elevation": "-90"})
    xml.SubElement(visual, "headlight", {"ambient": "0.5 0.5 0.5"})
    root.insert(1, visual)
    world = root.find("worldbody")
    assert world is not None

    def add(parent: xml.Element, kind: str, size: float, colour: str = "0.3 0.5 0.8 1", **position: str) -> None:
        look = {"type": kind, **position, "size": repr(size), "rgba": colour}
        parent.append(xml.Element("geom", {**look, **NO_CONTACT}))

    bodies = {element.get("name"): element for element in world.iter("body")}
    for index, body in enumerate(mechanism.bodies):
        element = bodies[f"body {index}"]
        if element.find("geom") is not None:
            continue
        # Body frames in the file are parallel to the world at t = 0.
        ends = [_row([*rotated(body.pose[2], np.array(point)), 0.0]) for point in _points(mechanism, body.name)]
        for first, second in pairwise(ends):
            add(element, "capsule", size, fromto=f"{first} {second}")
        if len(ends) == 1:
            add(element, "sphere", 3 * size)
    for point in _points(mechanism, None):
        add(world, "sphere", 1.5 * size, "0.5 0.5 0.5 1", pos=_row([*point, 0.0]))


def _points(mechanism: Mechanism, name: str | None) -> list[Vector]:
    points = [point for joint in mechanism.joints for owner, point in joint.fixed_points if owner == name]
    if name is not None and len(set(points)) < 2:
        points.append((0.0, 0.0))
    return list(dict.fromkeys(points))
