"""Experiments on engines: rows of other pages, compiled models at one step; and beside cells the joints and forces that
they build, and the velocity term of their rows.

The velocity term of loops: reactions at instants of the exact motion, where every gap and slip is zero, are compared
with two laws. In the tree's coordinates q a loop's rows are J q'' = -J' q' with the term and J q'' = 0 without it. Rows
that an engine does not declare as soft hold exactly. Both laws follow from the mechanism alone, and no step is taken.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported, method_name, registry
from engines.conformance.moving import FORCES
from engines.conformance.worlds import MOVING, WORLDS
from engines.tree import spanning_tree
from reference.joints import Gear, Pin, Rod, Skate, Weld
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reference.scene import Scene
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model.cells import FULL, SLOW_TO_BUILD, Cell, beside_cells, sweep_cells
from reports.model.ending import describe
from reports.model.tasks import Values
from reports.pages.common import OfMethod


class Asked(OfMethod):
    """What takes little but to build the engine's model."""

    @property
    def cost(self) -> float:
        return 0.1 + self.method.build_time


STEP = 1e-2  # s
WORLD = {world.name: world.mechanism for world in (*WORLDS, *MOVING)}
_WHEELS = tuple(Body(name, 1.0, 0.1, (x, 0.0, 0.0)) for name, x in (("first", 0.0), ("second", 1.0)))
_AXLES = tuple(Pin(f"axle of the {body.name}", None, body.name, body.pose[:2], (0.0, 0.0)) for body in _WHEELS)
_DOWN = (0.0, -10.0)
# What is asked, and the mechanism that asks it: of conformance, or the smallest that has the element.
ASKED = {
    "hinge": WORLD["swinging bar"],
    "loop": WORLD["swinging parallelogram"],
    "drive": WORLD["driven crank"],
    "slot": WORLD["sliding block"],
    "slot in a loop": WORLD["trammel"],
    "rod": Mechanism(_WHEELS[1:], (Rod("rod", None, "second", (0.0, 0.0), (0.0, 0.0), 1.0),), _DOWN),
    "weld": Mechanism(_WHEELS, (_AXLES[0], Weld("weld", "first", "second", (0.5, 0.0), (-0.5, 0.0))), _DOWN),
    "gear": Mechanism(_WHEELS, (*_AXLES, Gear("gear", "first", "second", -2.0))),
    **{force.name: Mechanism(_WHEELS[:1], _AXLES[:1], _DOWN, (replace(force, second="first"),)) for force in FORCES},
    "skate": WORLD["sleigh"],
    "disc rolls on a line": WORLD["disc on a slope"],
    "disc rolls in a ring": WORLD["disc in a hole"],
}


# Engines with a joint that holds velocities across a blade or at a rim. All others do it by contact, if at all.
ROLLING_JOINTS = {"lagrange", "exudyn"}
YES, CONTACT, CODE = "yes", "by contact", "with code of ours"
TOO_OLD = "this release lacks what our adapter calls"


@dataclass(frozen=True)
class Capabilities(Asked):
    """By the names in ASKED: YES, CONTACT, CODE, or a sentence that says why not; `reactions` and `width` of a run."""

    what: ClassVar[str] = "what it builds"

    def run(self) -> Values:
        told: dict[str, str] = {}
        for what, mechanism in ASKED.items():
            try:
                self.method.build(mechanism, STEP)
            except Unsupported as reason:
                told[what] = str(reason)
            except (AttributeError, ImportError, TypeError) as error:
                told[what] = f"{TOO_OLD}: {describe(error)}"
            else:
                touching = any(isinstance(joint, Skate | Roll) for joint in mechanism.joints)
                told[what] = CONTACT if touching and self.method.name not in ROLLING_JOINTS else YES
                with suppress(ValueError):
                    held = {self.method.enforcement(joint, mechanism) for joint in mechanism.joints}
                    if mechanism.forces:
                        held.add(self.method.forces_by)
                    told[what] = told[what] if held == {"engine"} else CODE
        run = self.method.build(WORLD["swinging bar"], STEP)(4, 1)
        known = [bool(np.isfinite(each).all()) for each in run.reaction]
        told["reactions"] = "yes" if all(known) else "not at the start" if all(known[1:]) else "no"
        velocity = run.twist[1:]
        # Velocities are the engine's own numbers, which poses of a tree or of angles are not.
        told["width"] = "32 bits" if np.array_equal(velocity, velocity.astype(np.float32)) else "64 bits"
        return told


Array = NDArray[np.float64]
INSTANTS = 12
ROWS_STEP = 1e-3  # s, that a model is built for; none is compared


def started_anew(mechanism: Mechanism, pose: Array, twist: Array) -> Mechanism:
    """The mechanism with its bodies at these poses and twists (bodies, 3)."""
    bodies = tuple(
        replace(body, pose=tuple(place.tolist()), twist=tuple(speed.tolist()))
        for body, place, speed in zip(mechanism.bodies, pose, twist, strict=True)
    )
    return replace(mechanism, bodies=bodies)


def reactions_with(
    mechanism: Mechanism, soft: tuple[bool, ...], complete: bool, compliance: Array | float = 0.0
) -> Array:
    """The start's reactions (rows,) [N] if soft rows have their velocity term or not; `compliance` (rows,) [1/kg]."""
    rows = mechanism.rows(mechanism.pose)
    bias = mechanism.bias(mechanism.pose, mechanism.twist)
    if not complete:
        tree = spanning_tree(mechanism)
        still = np.zeros((1, tree.coordinates))
        _, _, carried = tree.motion(still, tree.start_rates()[None], still)
        bias = np.where(soft, rows @ carried.reshape(-1), bias)
    weight = 1 / mechanism.inertias.reshape(-1)
    right: Array = bias - rows @ mechanism.free_fall.reshape(-1)
    inverse = (rows * weight) @ rows.T + np.diag(np.broadcast_to(compliance, right.shape))
    return np.asarray(np.linalg.solve(inverse, right), dtype=np.float64)


@dataclass(frozen=True)
class VelocityTerm(Asked):
    """How far an engine's reactions (instants,) are from those with the velocity term and without, of the largest."""

    what: ClassVar[str] = "the velocity term of a loop"

    def run(self) -> Values:
        scene = FreeFourBar()
        described = scene.mechanism()
        softness = self.method.regularisation(described, ROWS_STEP)
        if softness is None:
            raise ValueError(f"{method_name(self.method)} declares no soft rows: its loops are exact")
        t = np.linspace(0.2, 1.0, INSTANTS) * scene.duration
        truth = scene.motion(t)
        found: dict[str, list[float]] = {"with": [], "without": []}
        for pose, twist in zip(truth.pose, truth.twist, strict=True):
            now = started_anew(described, pose, twist)
            told = self.method.build(now, ROWS_STEP)(1, 1).reaction[0]
            for name, complete in (("with", True), ("without", False)):
                wanted = reactions_with(now, softness.rows, complete)
                found[name].append(float(np.abs(told - wanted).max() / np.abs(wanted).max()))
        return {"t": t, **{name: np.array(values) for name, values in found.items()}}


FREE = FreeFourBar()
MILLISECOND = round(FREE.spacing / 1e-3)  # steps between samples

# A scene of every mechanism, by the quantity that its own page compares.
LINKAGES = ("free_four_bar", "driven_slider_crank", "pendulum_2", "pendulum_10", "n_four_bar_2")
CHARTED = {"angle": (*LINKAGES, "person_two_feet", "rolling_disc"), "position": ("sleigh", "cart")}
BY_NAME: dict[str, Scene] = {scene.name: scene for scene in SCENES}
CHARTED_SCENES = tuple(BY_NAME[name] for names in CHARTED.values() for name in names)

# A model that is compiled for tens of seconds is run at one step of two scenes: one with a loop, one without.
COMPILED = tuple(
    Cell(BY_NAME[name], engine, MILLISECOND, "beside")
    for name in ("free_four_bar", "pendulum_2")
    for engine in registry.OTHERS
    if engine.build_time >= SLOW_TO_BUILD
)
BORROWED = sweep_cells(CHARTED_SCENES, registry.VARIANTS, FULL)
SWEPT = beside_cells(CHARTED_SCENES, registry.OTHERS, sweep=True)
