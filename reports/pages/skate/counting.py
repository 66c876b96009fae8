"""The freedoms of skates on one body, counted by rank and by brackets."""

from __future__ import annotations

import numpy as np

from reference.chapter.integrability import freedoms_by_brackets, mechanism_is_integrable
from reference.joints import Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.slopes import HeldBySkates
from reports.pages.page import Material, Observation


def _body(*joints: Pin | Skate) -> Mechanism:
    return Mechanism((Body("body", 2.0, 0.3, (0.0, 0.0, 0.0)),), joints)


def _skate(name: str, point: tuple[float, float], angle: float = 0.0) -> Skate:
    return Skate(name, None, "body", point, angle)


COUNTED: tuple[tuple[str, Mechanism], ...] = (
    ("free body", _body()),
    ("pinned body (18.62)", _body(Pin("pin", None, "body", (-0.5, 0.0), (-0.5, 0.0)))),
    ("one skate (18.64)", _body(_skate("one", (-0.5, 0.0)))),
    ("two skates on one axle", _body(_skate("left", (-0.5, 0.2)), _skate("right", (-0.5, -0.2)))),
    ("two skates in one line", _body(_skate("rear", (-0.5, 0.0)), _skate("front", (0.5, 0.0)))),
    ("two skates, one steered", _body(_skate("rear", (-0.5, 0.0)), _skate("front", (0.5, 0.0), 0.4))),
    ("a pin and a skate off it", _body(Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0)), _skate("skate", (0.5, 0.0)))),
    (
        "a pin and a skate square to it",
        _body(Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0)), _skate("skate", (0.5, 0.0), np.pi / 2)),
    ),
    ("three skates", HeldBySkates().mechanism()),
)


def counting(material: Material) -> list[Observation]:
    """Freedoms by rank and by brackets, and integrability by Frobenius, of skates on one body."""
    found = []
    for name, mechanism in COUNTED:
        configuration, velocity = mechanism.degrees_of_freedom()
        reached = freedoms_by_brackets(mechanism)[-1] if velocity else 0
        kind = "integrable" if mechanism_is_integrable(mechanism) else "not integrable"
        said = f"({configuration}, {velocity}); {kind}: of {configuration} it can reach {reached}"
        if velocity == 0:
            said = f"({configuration}, {velocity}): nothing can move, wherever it stands"
        found.append(Observation(name, f"{mechanism.row_count} row{'' if mechanism.row_count == 1 else 's'}", said))
    return found
