"""Wrong models: an engine simulates a mechanism with one wrong number, and is compared with the right scene.

Mistakes in adapters have this effect. The second half tests whether the grid's gates notice a wrong model. Right and
wrong models are run at the same steps, from coarse to fine.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from engines import Engine, method_name
from reference.joints import Drive, Joint, Roll, Skate, Slot
from reference.mechanism import Mechanism
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring
from reference.rolling.kinematics import Rolling
from reference.scene import Scene
from reports.gate.change import Altered, Old, moved
from reports.gate.prediction import Prediction, kinds, prediction
from reports.gate.theory import Case, checks
from reports.model.catalogue import PAGES
from reports.model.cells import FULL, Cell, estimated_cost
from reports.model.measure import Measurement, measure
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES
from reports.search.planted import Misbuilt

Some = TypeVar("Some")

NUMBER_KINDS = ("mass", "inertia", "length", "gravity", "point", "angle", "size", "rate")
# Number of bodies or joints up to which all are changed, not only the first, the middle and the last.
MOST_TRIED = 6


@dataclass(frozen=True)
class Mistake:
    """One wrong number of a mechanism. The `owner` is a body or joint, or "" for gravity and the ground's points.

    The kinds are explained for a relative error r, the mechanism's length L and its time scale T.

    mass, inertia: a body's value times 1 + r. length: the positions of all joints of a body, times 1 + r. gravity:
    gravity times 1 + r, or r L / T^2 downwards if gravity is zero. point: a joint's point, moved by r L. angle: the
    angle of a skate's blade, a slot's line, a drive's start or a rolling curve, plus r. size: the size of a rolling
    curve, times 1 + r. rate: a drive's rate (or the start's twists without a drive) times 1 + r, or r / T for a rate of
    zero.
    """

    kind: str
    owner: str = ""
    detail: str = ""

    def __str__(self) -> str:
        return " ".join(filter(None, (self.kind, self.owner, self.detail)))

    def made(self, right: Mechanism, relative: float) -> Misbuilt:
        """The wrong model. The start satisfies the joints and has the smallest change in the norm of the masses."""
        bodies, joints, gravity = list(right.bodies), list(right.joints), right.gravity
        twist = right.twist.copy()
        length, time = right.length_scale, right.time_scale
        match self.kind:
            case "mass" | "inertia":
                index = right.body_index(self.owner)
                value = getattr(bodies[index], self.kind)
                bodies[index] = replace(bodies[index], **{self.kind: value * (1 + relative)})
            case "gravity":
                extra = (0.0, -length / time**2) if not any(gravity) else gravity
                gravity = (gravity[0] + relative * extra[0], gravity[1] + relative * extra[1])
            case "length":
                joints = [_lengthened(joint, self.owner or None, 1 + relative) for joint in joints]
            case "rate" if not self.owner:
                # Bodies at rest get a rotation rate, which is projected to the joints.
                twist = twist * (1 + relative) if twist.any() else np.add(twist, [0.0, 0.0, relative / time])
            case _:
                index = [joint.name for joint in joints].index(self.owner)
                joints[index] = _wrong_joint(joints[index], self.kind, self.detail, relative, length, time)
        return Misbuilt(tuple(bodies), tuple(joints), gravity, right.forces, right=right).closed(twist)


def _lengthened(joint: Joint, body: str | None, factor: float) -> Joint:
    """The joint with the position of the joint's point on this body (None: ground) times `factor`."""
    changes = {}
    for name, point in ((joint.first, "first_point"), (joint.second, "second_point")):
        if name == body and point in joint.__dataclass_fields__:
            x, y = getattr(joint, point)
            changes[point] = (x * factor, y * factor)
    return replace(joint, **changes)


def _wrong_joint(joint: Any, kind: str, detail: str, relative: float, length: float, time: float) -> Any:
    match kind, joint:
        case "rate", Drive(turning_rate=rate):
            return replace(joint, turning_rate=rate * (1 + relative) if rate else relative / time)
        case "angle", Drive():
            return replace(joint, offset=joint.offset + relative)
        case "angle", Skate():
            return replace(joint, angle=joint.angle + relative)
        case "angle", Slot():
            return replace(joint, line_angle=joint.line_angle + relative)
        case _, Roll(rolling=rolling):
            return replace(joint, rolling=_wrong_rolling(rolling, kind, detail, relative, length))
        case _:
            point, axis = detail.split()
            position = list(getattr(joint, point))
            position["xy".index(axis)] += relative * length
            return replace(joint, **{point: tuple(position)})


def _wrong_rolling(rolling: Rolling, kind: str, detail: str, relative: float, length: float) -> Rolling:
    which, _, axis = detail.partition(" ")
    curve: Curve = getattr(rolling, which)
    match kind:
        case "size":
            wrong = _scaled(curve, 1 + relative)
        case "angle":
            wrong = Placed(curve, turn=relative)
        case _:
            wrong = Placed(curve, shift=(relative * length, 0.0) if axis == "x" else (0.0, relative * length))
    arc = rolling.ground_arc * (1 + relative if (kind, which) == ("size", "ground") else 1.0)
    body, ground = (wrong, rolling.ground) if which == "body" else (rolling.body, wrong)
    return Rolling.at_angle(body, ground, rolling.theta, arc)


def _scaled(curve: Curve, factor: float) -> Curve:
    match curve:
        case Circle() | Ring():
            return replace(curve, radius=curve.radius * factor, centre=_times(curve.centre, factor))
        case Ellipse():
            return Ellipse(curve.along_x * factor, curve.along_y * factor)
        case Cam():
            return Cam(curve.radius * factor, _times(curve.cosines, factor), _times(curve.sines, factor))
        case Placed():
            return Placed(_scaled(curve.curve, factor), _times(curve.shift, factor), curve.turn)
        case _:
            raise TypeError(f"{curve!r} has no size")


def _times(values: Any, factor: float) -> Any:
    return tuple(value * factor for value in values)


def _some(many: Sequence[Some]) -> Sequence[Some]:
    return many if len(many) <= MOST_TRIED else (many[0], many[len(many) // 2], many[-1])


def mistakes(mechanism: Mechanism) -> tuple[Mistake, ...]:
    """The mistakes in all numbers of a mechanism, in long chains only of the ends and the middle."""
    return tuple(_mistakes(mechanism))


def _mistakes(mechanism: Mechanism) -> Iterator[Mistake]:
    bodies = [body.name for body in _some(mechanism.bodies)]
    joints = _some(mechanism.joints)
    yield from (Mistake(kind, name) for kind in ("mass", "inertia") for name in bodies)
    yield Mistake("gravity")
    for name in (*bodies, None):
        if any(_lengthened(joint, name, 2.0) != joint for joint in mechanism.joints):
            yield Mistake("length", name or "")
    for joint in joints:
        match joint:
            case Roll():
                for which in ("body", "ground"):
                    yield from (Mistake("point", joint.name, f"{which} {axis}") for axis in "xy")
                    yield Mistake("angle", joint.name, which)
                    if not isinstance(getattr(joint.rolling, which), Line):
                        yield Mistake("size", joint.name, which)
            case _:
                if isinstance(joint, Drive | Skate | Slot):
                    yield Mistake("angle", joint.name)
                for point in ("first_point", "second_point"):
                    if point in joint.__dataclass_fields__:
                        yield from (Mistake("point", joint.name, f"{point} {axis}") for axis in "xy")
    drives = [joint for joint in joints if isinstance(joint, Drive)]
    yield from (Mistake("rate", drive.name) for drive in drives)
    if not any(isinstance(joint, Drive) and joint.turning_rate for joint in drives):
        yield Mistake("rate")


@dataclass(frozen=True)
class Misnumbered:
    """A function that returns a mechanism with a mistake of a relative size."""

    mistake: Mistake
    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        return self.mistake.made(mechanism, self.relative)


def mistaken(engine: Engine, mistake: Mistake, relative: float) -> Altered:
    """An engine that builds models with one mistake and has the declarations of the right engine."""
    return Altered(engine, Misnumbered(mistake, relative))


@dataclass(frozen=True)
class MistakeTrial:
    """Mistakes of one relative size in one scene and engine; runs have an estimated cost of at most `limit` [s]."""

    scene: Scene
    engine: Engine
    relative: float
    mistakes: tuple[Mistake, ...]
    limit: float

    @property
    def method(self) -> str:
        return method_name(self.engine)


@dataclass(frozen=True)
class Sighting:
    """The result of the checks of a mistake.

    `check`: the check of theory that only the wrong model fails, or "". `every`: the number of steps per sample in the
    last run. `changed`: whether the gate of change distinguishes the wrong row from the right row at any step. `shift`:
    the largest difference between errors of the wrong and the right model, in the errors' units. `noise`: the largest
    error of the right model. Both are from the step with the smallest noise.
    """

    check: str = ""
    every: int = 0
    changed: bool = False
    shift: float = math.inf
    noise: float = math.inf

    def after(self, every: int, right: Measurement, wrong: Measurement, amplified: float) -> Sighting:
        """The sighting after one more step at which no check has noticed the mistake."""
        baseline = Old(
            Outcome(right.outcome), {quantity.name: getattr(right, quantity.name) for quantity in QUANTITIES}
        )
        out = replace(self, every=every, changed=self.changed or moved(wrong, baseline, amplified))
        noise = max((abs(error) for error in baseline.errors.values() if not math.isnan(error)), default=0.0)
        return replace(out, shift=shift(right, wrong), noise=noise) if noise < self.noise else out


def shift(right: Measurement, wrong: Measurement) -> float:
    """The largest difference between the errors of two rows, which is infinite if outcomes or known errors differ."""
    pairs = [(getattr(right, quantity.name), getattr(wrong, quantity.name)) for quantity in QUANTITIES]
    if right.outcome != wrong.outcome or any(math.isnan(a) != math.isnan(b) for a, b in pairs):
        return math.inf
    return max((abs(a - b) for a, b in pairs if not math.isnan(a)), default=0.0)


def noticed(trials: Sequence[MistakeTrial]) -> tuple[Mapping[Mistake, Sighting], ...]:
    """The sightings of trials that are all in one scene, so that the scene's prediction is computed once."""
    scene = trials[0].scene
    judge = prediction(scene, kinds(scene, [trial.engine for trial in trials]))
    return tuple(sightings(trial, judge) for trial in trials)


def sightings(trial: MistakeTrial, judge: Prediction) -> Mapping[Mistake, Sighting]:
    """The sighting of every mistake, or nothing if the engine can't build the scene.

    Models with a mistake that is not noticed are run again at smaller steps. A wrong row is checked together with the
    wrong rows of larger steps, as in a grid with a wrong engine.
    """
    scene, engine = trial.scene, trial.engine
    page = next(page for page in PAGES if scene.name in {member.name for member in page.scenes})
    promise = page.orders.get((scene.name, trial.method)) or engine.order(scene.mechanism())
    case = Case(scene, engine, promise)
    noticed_mistakes: dict[Mistake, Sighting] = {}
    waiting = {mistake: Sighting() for mistake in trial.mistakes}
    rights: list[Measurement] = []
    wrongs: dict[Mistake, list[Measurement]] = {mistake: [] for mistake in trial.mistakes}
    for every in FULL:
        cell = Cell(scene, engine, every)
        if not waiting or (rights and estimated_cost(cell) > trial.limit):
            break
        right = measure(cell, repeat=False)
        if right.outcome == Outcome.UNSUPPORTED:
            return {}
        rights.append(right)
        passed = {(check.name, check.quantity) for check in checks(case, rights, judge) if check.passed}
        for mistake, sighting in tuple(waiting.items()):
            wrong = measure(replace(cell, engine=mistaken(engine, mistake, trial.relative)), repeat=False)
            wrongs[mistake].append(wrong)
            waiting[mistake] = sighting.after(every, right, wrong, case.amplified)
            results = [check for check in checks(case, wrongs[mistake], judge) if not check.passed]
            failed = [check for check in results if (check.name, check.quantity) in passed]
            if failed:
                worst = max(failed, key=lambda check: check.nearness)
                noticed_mistakes[mistake] = replace(waiting.pop(mistake), check=str(worst))
    return noticed_mistakes | waiting
