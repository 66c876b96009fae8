"""A model of ours as an MJCF file that runs without us: its options, its bodies under their names, its start."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as xml

import mujoco

from engines import Unsupported
from engines.mujoco.visuals import add_visuals

if TYPE_CHECKING:
    from engines.mujoco.model import Model

INTEGRATORS = {"EULER": "Euler", "RK4": "RK4", "IMPLICIT": "implicit", "IMPLICITFAST": "implicitfast"}
SOLVERS = {"PGS": "PGS", "CG": "CG", "NEWTON": "Newton"}
FLAGS = ("contact", "island")
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
