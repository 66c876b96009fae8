"""A model of ours as an MJCF file that runs without us: its options, its bodies under their names, its start, and bars
and points that let it be seen. Nothing touches these, and they have no mass.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as xml

import mujoco
import numpy as np

from engines import Unsupported
from reference.joints import Slot, Vector
from reference.mechanism import Mechanism
from reference.plane import rotated

if TYPE_CHECKING:
    from engines.mujoco.model import Model

INTEGRATORS = {"EULER": "Euler", "RK4": "RK4", "IMPLICIT": "implicit", "IMPLICITFAST": "implicitfast"}
SOLVERS = {"PGS": "PGS", "CG": "CG", "NEWTON": "Newton"}
FLAGS = ("contact", "island")
THICKNESS = 0.02  # of bars, in the mechanism's lengths
UNTOUCHED = {"contype": "0", "conaffinity": "0", "mass": "0"}
REFERRING = ("name", "body", "body1", "body2")


def as_text(model: Model, softening: float) -> str:
    """The file's text. Raises Unsupported for a model that our code helps while it is stepped."""
    hooks = model.hooks
    if hooks.control or hooks.before or model.drive == "overwrite":
        raise Unsupported("this variant writes rows while it steps: a file would not run without this suite")
    if softening != 1:
        raise Unsupported("this variant changes compliances that no file can state; take default or tuned")
    compiled, written = model.compiled, model.written_as
    assert written is not None
    option = compiled.opt
    integrator = mujoco.mjtIntegrator(option.integrator).name.split("_")[1]
    attributes = {
        "timestep": repr(float(option.timestep)),
        "gravity": " ".join(repr(float(value)) for value in option.gravity),
        "integrator": INTEGRATORS.get(integrator, integrator.lower()),
        "solver": SOLVERS[mujoco.mjtSolver(option.solver).name.split("_")[1]],
        "iterations": str(int(option.iterations)),
        "tolerance": repr(float(option.tolerance)),
        "jacobian": mujoco.mjtJacobian(option.jacobian).name.split("_")[1].lower(),
        "cone": mujoco.mjtCone(option.cone).name.split("_")[1].lower(),
    }
    off = [flag for flag in FLAGS if option.disableflags & int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag.upper()}"))]
    root = xml.fromstring(written.text(attributes, off, "crosscheck"))
    for section in [
        each for each in root if len(each) == 0 and each.tag in ("equality", "tendon", "actuator", "contact")
    ]:
        root.remove(section)
    _place_shapes(root, compiled)
    add_visuals(root, model.mechanism)
    _rename(root, model)
    start = model.start()
    key = {"name": "start", "qpos": _row(start.qpos), "qvel": _row(start.qvel)}
    if compiled.nu:
        key["ctrl"] = _row(start.ctrl)
    xml.SubElement(xml.SubElement(root, "keyframe"), "key", key)
    xml.indent(root)
    return xml.tostring(root, encoding="unicode") + "\n"


def _place_shapes(root: xml.Element, compiled: Any) -> None:
    """Shapes where the compiled model has them: a blade is pressed into its plane once its weight is known."""
    owners = [owner for owner in root.iter() if owner.tag in ("worldbody", "body")]
    shapes = [shape for owner in owners for shape in owner.findall("geom")]
    for shape, place in zip(shapes, compiled.geom_pos, strict=True):
        if shape.get("pos") is not None:
            shape.set("pos", _row(place))


def _rename(root: xml.Element, model: Model) -> None:
    """Bodies under the mechanism's names, where these are not taken by something else."""
    names = {f"body {number}": body.name for number, body in enumerate(model.mechanism.bodies)}
    if set(names) & set(names.values()):
        return
    for element in root.iter():
        for attribute in REFERRING:
            value = element.get(attribute)
            if value in names and (attribute != "name" or element.tag == "body"):
                element.set(attribute, names[value])


def _row(values: Any) -> str:
    return " ".join(repr(float(value)) for value in values)


def add_visuals(root: xml.Element, mechanism: Mechanism) -> None:
    """Bars through the joints of every "body i" of a model that has no shapes yet, and the view onto its plane."""
    size = repr(THICKNESS * mechanism.length_scale)
    visual = xml.Element("visual")
    xml.SubElement(visual, "global", {"azimuth": "90", "elevation": "-90"})
    xml.SubElement(visual, "headlight", {"ambient": "0.5 0.5 0.5"})
    root.insert(1, visual)
    world = root.find("worldbody")
    assert world is not None
    for index, body in enumerate(mechanism.bodies):
        element = next(each for each in world.iter("body") if each.get("name") == f"body {index}")
        if element.find("geom") is not None:
            continue
        # The file's bodies stand parallel to the world at the start.
        ends = [_place(rotated(body.pose[2], np.array(point))) for point in _points(mechanism, body.name)]
        for first, second in pairwise(ends):
            look = {"type": "capsule", "fromto": f"{first} {second}", "size": size, "rgba": "0.3 0.5 0.8 1"}
            element.append(xml.Element("geom", {**look, **UNTOUCHED}))
        if len(ends) == 1:
            look = {"type": "sphere", "size": repr(3 * float(size)), "rgba": "0.3 0.5 0.8 1"}
            element.append(xml.Element("geom", {**look, **UNTOUCHED}))
    for point in _points(mechanism, None):
        look = {
            "type": "sphere",
            "pos": _place(np.array(point)),
            "size": repr(1.5 * float(size)),
            "rgba": "0.5 0.5 0.5 1",
        }
        world.append(xml.Element("geom", {**look, **UNTOUCHED}))


def _points(mechanism: Mechanism, name: str | None) -> list[Vector]:
    """Joint points of a body, with its centre of mass where there is at most one; those of the ground alone."""
    points = [
        tuple(getattr(joint, which))
        for joint in mechanism.joints
        for owner, which in ((joint.first, "first_point"), (joint.second, "second_point"))
        if owner == name and hasattr(joint, which) and not (isinstance(joint, Slot) and which == "first_point")
    ]
    if name is not None and len(set(points)) < 2:
        points.append((0.0, 0.0))
    return list(dict.fromkeys(points))


def _place(point: np.ndarray) -> str:
    return f"{float(point[0])!r} {float(point[1])!r} 0.0"
