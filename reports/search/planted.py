"""Controls with planted faults. A control gives an engine a wrong mechanism and measures when the search detects it.

A mistake in an adapter has the same effect as a planted fault. A fault changes one number of all joints or force
elements of a kind, or it changes the inertias. The change of inertias may depend on the description of the mechanism.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Engine, box2d, bullet, drake, exudyn, lagrange, mjx, mujoco, pinocchio, pymunk
from reference.checks import InvalidMechanism
from reference.joints import Body
from reference.mechanism import Mechanism
from reference.rolling.curves import Placed
from reference.rolling.kinematics import Rolling
from reports.gate.change import Altered
from reports.gate.judge import dynamics_of
from reports.model.tasks import Task, Values
from reports.search import relations
from reports.search.mechanisms import CASES_PER_SHAPE, SHAPE_COUNT
from reports.search.parts import ALL_KINDS
from reports.search.plan import supported_kinds
from reports.search.subjects import Adapted

Array = NDArray[np.float64]

# Fault -> the wrong field. The name of a fault begins with a kind. The error of a wrong point is relative to the length
# scale. Errors of fields in FAULT_ANGLES are in radians, and other errors are relative to the value.
FAULT_FIELDS = {
    "pin": "second_point",
    "slot": "line_angle",
    "skate": "angle",
    "roll": "rolling",
    "drive": "turning_rate",
    "rod": "length",
    "gear": "ratio",
    "weld": "angle",
    "spring": "stiffness",
    "damper": "damping",
    "torsion-spring": "stiffness",
    "torsion-damper": "damping",
    "force": "second_point",
    "torque": "torque",
    "spring rest_length": "rest_length",
    "torsion-spring rest_angle": "rest_angle",
    "force force": "force",
}
FAULT_ANGLES = ("line_angle", "angle", "rest_angle")
CLOSING_STEPS = 6  # number of Newton steps that close the joints of a wrong mechanism


@dataclass(frozen=True)
class Misbuilt(Mechanism):
    """A mechanism with a fault; reactions are computed for the mechanism `right`. If not all joints can be closed with
    the fault, the gaps are minimal."""

    right: Mechanism = field(kw_only=True)

    def _refuse_a_bad_start(self) -> None:
        """Accept joints that are open at the start."""

    def reaction(self, *arguments: Any, **options: Any) -> Array:
        return self.right.reaction(*arguments, **options)

    def closed(self, twist: Array) -> Misbuilt:
        """A copy with closed joints. Poses and velocities are projected in the metric of the masses. twist: velocities
        (bodies, 3) before the projection. The poses before the projection are those of the right mechanism."""
        pose = allowed = self.right.pose
        for _ in range(CLOSING_STEPS):
            pose, allowed = dynamics_of(self).project(pose, twist, 0.0)
        bodies = zip(self.bodies, pose.tolist(), allowed.tolist(), strict=True)
        return replace(self, bodies=tuple(replace(body, pose=tuple(p), twist=tuple(v)) for body, p, v in bodies))


@dataclass(frozen=True)
class PlantedFault:
    """A change of a mechanism by a fault in PLANTED_FAULTS. `relative`: size of the error."""

    fault: str
    relative: float

    @property
    def kind(self) -> str:
        return self.fault.split()[0] if self.fault in FAULT_FIELDS else self.fault

    @property
    def is_relation(self) -> bool:
        return self.kind in relations.RELATIONS

    @property
    def kinds(self) -> tuple[str, ...]:
        return ("pin",) if self.kind not in ALL_KINDS else tuple(dict.fromkeys(("pin", self.kind)))

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        if self.kind == "turned":
            x, y = mechanism.gravity
            return replace(mechanism, gravity=((1 + self.relative) * x, y))
        if self.fault not in FAULT_FIELDS:
            bodies = tuple(self._heavier(mechanism, body) for body in mechanism.bodies)
            return replace(mechanism, bodies=bodies)
        length = mechanism.length_scale
        forces = tuple(self._wrong(force, length) for force in mechanism.forces)
        joints = tuple(self._wrong(joint, length) for joint in mechanism.joints)
        if joints == mechanism.joints:
            return replace(mechanism, forces=forces)
        wrong = Misbuilt(mechanism.bodies, joints, mechanism.gravity, mechanism.forces, right=mechanism)
        return wrong.closed(mechanism.twist)

    def _wrong(self, part: Any, length: float) -> Any:
        if kind_of(part) != self.kind:
            return part
        name = FAULT_FIELDS[self.fault]
        match getattr(part, name):
            case Rolling() as rolling:
                curve = Placed(rolling.body, shift=(self.relative * length, 0.0))
                off: Any = Rolling.at_angle(curve, rolling.ground, rolling.theta, rolling.ground_arc)
            case (x, y):
                off = ((1 + self.relative) * x, (1 + self.relative) * y)
                off = off if name == "force" else (x + self.relative * length, y)
            case value:
                off = value + self.relative if name in FAULT_ANGLES else (1 + self.relative) * value
        return replace(part, **{name: off})

    def _heavier(self, mechanism: Mechanism, body: Body) -> Body:
        off = {
            "inertia": True,
            "shifted": body.pose[0] > 0,
            "mirrored": body.pose[2] > 0,
            "renamed": not body.name.isascii(),
            "swapped": any(joint.second == body.name for joint in mechanism.joints),
            "in other lengths": body.inertia < 0.02**2 * body.mass,
            "in other masses": body.mass > 10.5,
        }[self.kind]
        return replace(body, inertia=(1 + self.relative) * body.inertia) if off else body


def kind_of(part: Any) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "-", type(part).__name__).lower()


PLANTED_FAULTS = ("inertia", *FAULT_FIELDS, *relations.RELATIONS)
# The most accurate variants of each engine for the checks of instants and motions.
CONTROL_ENGINES: Mapping[str, tuple[Engine, ...]] = {
    "pymunk": (pymunk.LEAPFROG, pymunk.EXTENDED),
    "mujoco": (mujoco.TUNED, mujoco.EXTENDED),
    "lagrange": (lagrange.VARIANTS[-1],),
    "exudyn": (exudyn.EXTENDED,),
    "box2d": box2d.VARIANTS,
    "pinocchio": (pinocchio.TUNED,),
    "mjx": (mjx.TUNED,),
    "bullet": (bullet.EXTENDED,),
    "drake": (drake.EXTENDED,),
}
CONTROL_SEED = 1
CONTROL_CASES = 300
FAULT_SIZES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


@dataclass(frozen=True)
class PlantedControl(Task):
    """A task that determines the smallest size of a fault that the search detects, and the first case that detects
    it."""

    name: str  # name of the engine
    fault: str
    sizes: tuple[float, ...] = FAULT_SIZES
    cases: int = CONTROL_CASES

    @property
    def cost(self) -> float:
        return 10.0 + max(engine.build_time for engine in CONTROL_ENGINES[self.name])

    @property
    def label(self) -> str:
        return f"planted in {self.name}: {self.fault}"

    @property
    def engine(self) -> Engine:
        return CONTROL_ENGINES[self.name][0]

    def run(self) -> Values:
        """The size of the fault, and the number and the check of the first case that detects it. Numbers are NaN
        without such a case.

        "built": whether the engine supports the kind. "asked": number of judged cases.
        """
        engines, kind, judged_count = CONTROL_ENGINES[self.name], PlantedFault(self.fault, 0.0).kind, 0
        built = kind not in ALL_KINDS or kind in supported_kinds(engines[0])
        size, case, check = np.nan, np.nan, ""
        for fault_size in self.sizes if built else ():
            for number, was_asked, check in search_with_fault(
                engines, PlantedFault(self.fault, fault_size), self.cases
            ):
                judged_count += was_asked
                if check:
                    size, case = fault_size, number
            if check or not judged_count:
                break
        numbers = {"size": size, "case": case, "built": built, "asked": judged_count}
        return {name: np.array(value) for name, value in numbers.items()} | {"check": check}


def search_with_fault(engines: tuple[Engine, ...], change: PlantedFault, cases: int) -> Iterator[tuple[int, bool, str]]:
    """Yield (number of the case, whether it was judged, failing check or ""). The generator ends with the first check
    that fails only with the fault."""
    # To save time, an engine that compiles each shape is checked at instants only.
    of_motion = ("instant",) if any(engine.build_time for engine in engines) else ("instant", "motions")
    oracles = ("relations",) if change.is_relation else of_motion
    for number, engine in product(range(cases), engines):
        if change.is_relation and relations.RELATIONS[number % len(relations.RELATIONS)] != change.kind:
            continue
        right, wrong = Adapted(engine), Adapted(Altered(engine, change))
        case = right.draw(CONTROL_SEED, number, change.kinds, 0)
        if change.kind in ALL_KINDS and change.kind not in case.kinds:
            continue
        for oracle in oracles:
            try:
                result = wrong.ask(case, number, (oracle,))
            except (InvalidMechanism, np.linalg.LinAlgError):  # the fault makes this mechanism invalid
                continue
            faults = [check for check in result.faults if check != "raised"]
            faults = [check for check in faults if not change.is_relation or check == change.kind]
            if faults:
                right_faults = right.ask(case, number, (oracle,)).faults
                faults = [check for check in faults if check not in right_faults]
            yield number, bool(result.errors), f"{engine.variant}: {faults[0]}" if faults else ""
            if faults:
                return


def all_controls() -> list[PlantedControl]:
    out = []
    for (name, engines), fault in product(CONTROL_ENGINES.items(), PLANTED_FAULTS):
        shaped = any(engine.build_time for engine in engines)
        out.append(PlantedControl(name, fault, cases=SHAPE_COUNT * CASES_PER_SHAPE if shaped else CONTROL_CASES))
    return out
