"""A model written as MJCF text, for releases before 3.2.7, whose MjSpec is missing or has other names.

It has the members of `mujoco.MjSpec` that the files beside it use, and no others. Numbers are written with all their
digits; options are set in the compiled model, where their names are the same.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree as xml

import mujoco
import numpy as np

# Attributes of MJCF by those of MjSpec, where they differ; None: it says nothing that the text needs.
NAMES: dict[str, str | None] = {
    "explicitinertial": None,
    "objtype": None,
    "type": None,
    "trntype": None,
    "target": None,
    "biastype": None,
    "solref_friction": "solreffriction",
    "solimp_friction": "solimpfriction",
    "geomname1": "geom1",
    "geomname2": "geom2",
}
OWN = ("data", "_wraps", "_inside")  # what is written otherwise
INERTIAL = {"ipos": "pos", "mass": "mass", "inertia": "diaginertia"}


def new_specification() -> Any:
    """An empty mujoco.MjSpec, or what stands for one in a release without it."""
    found = mujoco.MjSpec() if hasattr(mujoco, "MjSpec") else None
    return found if hasattr(found, "compiler") else Written()


class Element:
    """Anything that has attributes: those given, and those that are set afterwards."""

    def __init__(self, **given: Any) -> None:
        self.data = np.zeros(3)  # of an equality: its anchor
        vars(self).update(given)

    def attributes(self) -> dict[str, str]:
        """Those that MJCF writes, as text."""
        named = {NAMES.get(name, name): value for name, value in vars(self).items() if name not in OWN}
        return {name: _text(value) for name, value in named.items() if name is not None and not _empty(value)}


class Tendon(Element):
    """A fixed tendon: a sum of joints' coordinates; or a spatial one, between sites."""

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        self._wraps: list[tuple[str, dict[str, str]]] = []

    def wrap_joint(self, joint: str, coefficient: float) -> None:
        self._wraps.append(("joint", {"joint": joint, "coef": _text(coefficient)}))

    def wrap_site(self, site: str) -> None:
        self._wraps.append(("site", {"site": site}))

    def write(self, parent: xml.Element) -> None:
        kinds = {kind for kind, _ in self._wraps}
        added = xml.SubElement(parent, "spatial" if kinds == {"site"} else "fixed", self.attributes())
        for kind, wrap in self._wraps:
            xml.SubElement(added, kind, wrap)


class Actuator(Element):
    """A velocity servo, or what pushes by a constant bias."""

    kv: float | None = None

    def set_to_velocity(self, gain: float) -> None:
        self.kv = gain

    def write(self, parent: xml.Element) -> None:
        kind = {mujoco.mjtTrn.mjTRN_SITE: "site", mujoco.mjtTrn.mjTRN_TENDON: "tendon"}.get(self.trntype, "joint")
        told = self.attributes()
        if self.kv is None:
            told["biastype"] = "affine"
        xml.SubElement(parent, "general" if self.kv is None else "velocity", {kind: self.target, **told})


class Body(Element):
    """A body with its joints, geoms, sites and bodies."""

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        self._inside: list[tuple[str, Any]] = []

    def _add(self, kind: str, element: Any) -> Any:
        self._inside.append((kind, element))
        return element

    def add_body(self, **given: Any) -> Body:
        return self._add("body", Body(**given))

    def add_joint(self, **given: Any) -> Element:
        return self._add("joint", Element(**given))

    def add_geom(self, **given: Any) -> Element:
        return self._add("geom", Element(**given))

    def add_site(self, **given: Any) -> Element:
        return self._add("site", Element(**given))

    def all(self, kind: str) -> list[Any]:
        """The elements of a kind in this body and in those inside."""
        own = [element for each, element in self._inside if each == kind]
        return own + [found for each, body in self._inside if each == "body" for found in body.all(kind)]

    def write(self, parent: xml.Element) -> None:
        """This body's attributes and what is in it."""
        for kind, element in self._inside:
            if kind == "body":
                inertial = {name: _text(getattr(element, own)) for own, name in INERTIAL.items()}
                added = xml.SubElement(parent, "body", element.place())
                xml.SubElement(added, "inertial", inertial)
                element.write(added)
            else:
                word = {} if kind == "site" else {"type": _type(kind, element.type)}
                xml.SubElement(parent, kind, {**element.attributes(), **word})

    def place(self) -> dict[str, str]:
        """The body's name and pose in its parent."""
        return {name: _text(value) for name, value in vars(self).items() if name in ("name", "pos", "quat")}


class Written:
    """What stands for a mujoco.MjSpec."""

    def __init__(self) -> None:
        self.compiler = SimpleNamespace(degree=False)
        self.option = SimpleNamespace(disableflags=0, integrator=None, jacobian=None)
        self.worldbody = Body(name="world")
        self._parts: dict[str, list[Any]] = {"equality": [], "tendon": [], "actuator": [], "contact": []}

    def _add(self, section: str, element: Any) -> Any:
        self._parts[section].append(element)
        return element

    def add_equality(self, **given: Any) -> Element:
        return self._add("equality", Element(**given))

    def add_tendon(self, **given: Any) -> Tendon:
        return self._add("tendon", Tendon(**given))

    def add_actuator(self, **given: Any) -> Actuator:
        return self._add("actuator", Actuator(**given))

    def add_pair(self, **given: Any) -> Element:
        return self._add("contact", Element(**given))

    def body(self, name: str) -> Body:
        return next(body for body in self.worldbody.all("body") if body.name == name)

    def joint(self, name: str) -> Element:
        return next(joint for joint in self.worldbody.all("joint") if joint.name == name)

    def text(self, option: Mapping[str, str] | None = None, flags: Sequence[str] = (), name: str = "") -> str:
        """The model as MJCF; `option`: attributes of its options, `flags`: what it disables."""
        root = xml.Element("mujoco", {"model": name} if name else {})
        xml.SubElement(root, "compiler", {"angle": "radian", "autolimits": "true"})
        if option:
            told = xml.SubElement(root, "option", dict(option))
            if flags:
                xml.SubElement(told, "flag", dict.fromkeys(flags, "disable"))
        self.worldbody.write(xml.SubElement(root, "worldbody"))
        for section, elements in self._parts.items():
            parent = xml.SubElement(root, section)
            for element in elements:
                if section == "equality":
                    xml.SubElement(parent, *_equality(element))
                elif section == "contact":
                    xml.SubElement(parent, "pair", element.attributes())
                else:
                    element.write(parent)
        return xml.tostring(root, encoding="unicode")

    def compile(self) -> Any:
        """The mujoco.MjModel. Raises ValueError where MuJoCo refuses it."""
        compiled = mujoco.MjModel.from_xml_string(self.text())
        for name, value in vars(self.option).items():
            if value is not None:
                setattr(compiled.opt, name, value)
        return compiled


def _equality(element: Element) -> tuple[str, dict[str, str]]:
    """(its tag, its attributes): MJCF names what is equal by its kind."""
    told = element.attributes()
    first, second = told.pop("name1"), told.pop("name2", None)
    if element.type == mujoco.mjtEq.mjEQ_TENDON:  # it stays as long as it is at the start
        return "tendon", told | {"tendon1": first}
    kind = "weld" if element.type == mujoco.mjtEq.mjEQ_WELD else "connect"  # a weld: in the pose of the start
    return kind, told | {"body1": first, "body2": second or "world", "anchor": _text(element.data)}


def _type(kind: str, value: Any) -> str:
    """'hinge' of mjJNT_HINGE, 'plane' of mjGEOM_PLANE."""
    kinds = mujoco.mjtJoint if kind == "joint" else mujoco.mjtGeom
    return kinds(value).name.split("_")[1].lower()


def _empty(value: Any) -> bool:
    return value is None or (isinstance(value, str) and not value)


def _text(value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence | np.ndarray):
        return " ".join(_text(each) for each in value)
    return repr(int(value)) if isinstance(value, int | np.integer) else repr(float(value))
