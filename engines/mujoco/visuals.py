"""Bars and points that let a written model be seen in MuJoCo's viewer. Nothing touches them, and they have no mass."""

from __future__ import annotations

from itertools import pairwise
from xml.etree import ElementTree as xml

import numpy as np

from reference.joints import Slot, Vector
from reference.mechanism import Mechanism
from reference.plane import rotated

THICKNESS = 0.02  # of the mechanism's length
UNTOUCHED = {"contype": "0", "conaffinity": "0", "mass": "0"}


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
        ends = [_row(rotated(body.pose[2], np.array(point))) for point in _points(mechanism, body.name)]
        for first, second in pairwise(ends):
            look = {"type": "capsule", "fromto": f"{first} {second}", "size": size, "rgba": "0.3 0.5 0.8 1"}
            element.append(xml.Element("geom", {**look, **UNTOUCHED}))
        if len(ends) == 1:
            look = {"type": "sphere", "size": repr(3 * float(size)), "rgba": "0.3 0.5 0.8 1"}
            element.append(xml.Element("geom", {**look, **UNTOUCHED}))
    for point in _points(mechanism, None):
        look = {
            "type": "sphere",
            "pos": _row(np.array(point)),
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


def _row(point: np.ndarray) -> str:
    return f"{float(point[0])!r} {float(point[1])!r} 0.0"
