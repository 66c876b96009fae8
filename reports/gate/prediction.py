"""What order and softness cost in a scene: predicted by the judge, from the scene's mechanism and its truth alone.

An error A (h / tau)^p has two unknowns, an amplitude A and a time scale tau. Ideal methods of order 2 and of order 4
give both, and with them what any order costs at any step in this scene: the motion's own rates, however fast, and how
it carries an early error on are in them. The same for joints that give way: their errors are proportional to how soft
they are, so one softness tells of all.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np

from engines import EXACT, Engine, Regularisation
from engines.motions import is_prescribed
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.gate.judge import QUANTITY_NAMES, errors
from reports.model.cells import mechanism_of
from reports.model.errors import constraint_errors, largest, motion_errors
from reports.model.outcomes import SATURATED, TORN
from reports.model.page import Page
from reports.model.tasks import Answer, Task, Values

# Which rows are soft, and whether they have the term of velocities: what the judge has to run once.
SoftKind = tuple[tuple[bool, ...], bool]

# Joints are compared at these, MuJoCo's as shipped but for a smaller compliance, and results scaled: what gives way is
# proportional to the compliance and to the inverse stiffness, or to the time 1 / damping by which slip lags.
STIFFNESS, DAMPING, COMPLIANCE = 1 / 0.02**2, 2 / 0.02, 0.01

# The judge's own steps a sample: the coarsest at which its second-order run is within REACH [rad] of the truth.
REFINEMENTS = (1, 3)
REACH = 0.1
# The judge's own runs end here: a scene of thousands of periods is judged by the methods' own coarser steps alone.
MOST_STEPS = 20_000
# Samples of the truth between which its derivatives are taken.
DIFFERENCES = 1000


# What the judge's fourth order leaves of these is not of the motion alone: of a position it is how far rows that are
# left alone drift, and energy it keeps an order better than the motion. Below both orders the angle's own time scale
# counts.
OTHERWISE = ("position", "energy")


@dataclass(frozen=True)
class Prediction:
    """What order and softness cost in a scene: errors by quantity of ideal methods of order 2 and 4 at `step` [s], and
    the mechanism's `length` [m]; of the truth the largest `speed` [m/s] and `acceleration` [m/s^2], and by how much of
    themselves reactions are `changing`: their first two derivatives [1/s, 1/s^2] over the largest. `soft`: errors by
    kind of softness, at STIFFNESS, DAMPING and COMPLIANCE. `gapped`: which rows of the mechanism have a gap to close.
    `prescribed`: whether nothing is free to move, so that drives alone say how it moves; then `earlier` are errors by
    quantity of velocities and reactions that are those of an earlier instant, over the time between [s].
    """

    step: float
    second: Mapping[str, float]
    fourth: Mapping[str, float]
    length: float
    speed: float
    acceleration: float
    changing: tuple[float, float]
    soft: Mapping[SoftKind, Mapping[str, float]]
    gapped: tuple[bool, ...]
    prescribed: bool = False
    earlier: Mapping[str, float] = field(default_factory=dict)

    def has(self, quantity: str) -> bool:
        """Whether the scene has such a number: without a joint that limits a position there is no gap."""
        return not math.isnan(self.second[quantity]) and (quantity != "gap" or any(self.gapped))

    def error(self, quantity: str, order: float, step: float) -> float:
        """A (step / tau)^order, A and tau from the two ideal methods; infinite where those failed, NaN if unknown.

        A pose that is wrong by this much is wrong in its velocities too, by as much as the motion takes it on; and what
        is wrong in its velocities may show as a slip.
        """
        own = self._power(quantity, order, step)
        pace = self.speed / self.length
        match quantity:
            case "rate":
                return max(own, pace * self._power("angle", order, step))
            case "velocity":
                return max(own, pace * self._power("position", order, step))
            case "slip":
                return max(own, self._power("velocity", order, step))
        return own

    def _power(self, quantity: str, order: float, step: float) -> float:
        second, fourth = self.second[quantity], self.fourth[quantity]
        if order == EXACT:
            return 0.0
        if not (math.isfinite(second) and math.isfinite(fourth)):
            return math.nan if math.isnan(second) else math.inf
        if second == 0 or fourth == 0:
            return 0.0
        # At the judge's step the error falls by (step / tau)^2 from order 2 to order 4: by its root for each order.
        fall = fourth / second
        if order < 2 and quantity in OTHERWISE and 0 < self.fourth["angle"] < math.inf:
            fall = min(fall, self.fourth["angle"] / self.second["angle"])
        return second * fall ** ((order - 2) / 2) * (step / self.step) ** order

    def give(self, quantity: str, softness: Regularisation | None) -> float:
        """What this softness costs, in proportion to what the judge's own does."""
        return given(self.soft, quantity, softness, self.gapped)

    def closing(self, quantity: str, gap: float, softness: Regularisation | None) -> float:
        """What a spring costs that closes a gap [m] of the step's: it moves at gap times damping, which is a slip."""
        if softness is None or not softness.complete or math.isnan(gap):
            return 0.0
        if quantity == "reaction":
            return gap * softness.stiffness / self.acceleration
        return self._slipping(quantity, gap * softness.damping)

    def settling(self, quantity: str, softness: Regularisation | None) -> float:
        """What springs cost that are tied to the step while they take up their load: a critically damped one opens to
        its gap [m] at 1 / e of the gap times the root of its stiffness, at most."""
        if softness is None or softness.compliance == 0:
            return 0.0
        return self._slipping(quantity, self.give("gap", softness) * math.sqrt(softness.stiffness) / math.e)

    def _slipping(self, quantity: str, speed: float) -> float:
        """What a slip of this speed [m/s] is in other quantities than poses."""
        costs = {
            "slip": speed,
            "velocity": speed,
            "rate": speed / self.length,
            "energy": 2 * speed / self.speed,
        }
        return costs.get(quantity, 0.0)

    def differenced(self, order: float, step: float) -> float:
        """The relative error of a reaction that is read as a change of velocity over a step: what it changes in it."""
        return self.changing[order > 1] * step ** min(order, 2)

    def refused(self, quantity: str) -> float:
        """The error above which a run is no longer comparable, whatever the order promises: of velocities, energy and
        reactions one that is as large as the largest there is."""
        scales = {
            "angle": SATURATED,
            "gap": TORN * self.length,
            "position": SATURATED * self.length,
            "rate": self.speed / self.length,
            "velocity": self.speed,
            "slip": self.speed,
        }
        return scales.get(quantity, 1.0)


def given(
    soft: Mapping[SoftKind, Mapping[str, float]], quantity: str, softness: Regularisation | None, gapped: Sequence[bool]
) -> float:
    """What a softness costs, in proportion to the judge's own errors by kind (`Prediction.soft`).

    A row that has a gap (`gapped`, (rows,)) gives way by its spring, one that has none by its damper.
    """
    if softness is None:
        return 0.0
    stiff, damped = STIFFNESS / softness.stiffness, DAMPING / softness.damping
    found = 0.0
    if softness.compliance > 0:
        yielding = {stiff if gap else damped for gives, gap in zip(softness.rows, gapped, strict=True) if gives}
        found += soft[softness.rows, True][quantity] * softness.compliance / COMPLIANCE * max(yielding, default=0.0)
        # However stiff the spring, this share of a force is not felt by what gives it.
        found += softness.compliance if quantity == "reaction" else 0.0
    if not softness.complete:
        lag = stiff if quantity == "gap" else max(damped, stiff)
        found += soft[softness.rows, False][quantity] * lag
    return found


def _worse(one: Mapping[str, float], other: Mapping[str, float]) -> Mapping[str, float]:
    """By quantity the larger of two errors that are finite, infinite without any; NaN where neither is known."""
    out = {}
    for name in QUANTITY_NAMES:
        known = [value for value in (one[name], other[name]) if not math.isnan(value)]
        out[name] = max((v for v in known if math.isfinite(v)), default=math.inf) if known else math.nan
    return out


def kinds(scene: Scene, engines: Iterable[Engine]) -> frozenset[SoftKind]:
    """What the judge has to know of softness to judge these engines in a scene."""
    mechanism, found = scene.mechanism(), set()
    for engine in engines:
        softness = engine.regularisation(mechanism, scene.spacing)
        if softness is not None:
            found |= {(softness.rows, True)} if softness.compliance > 0 else set()
            found |= set() if softness.complete else {(softness.rows, False)}
    return frozenset(found)


@cache
def prediction(scene: Scene, soft: frozenset[SoftKind] = frozenset()) -> Prediction:
    """The scene's prediction, worked out once a process: a second or two, more for a hundred bodies.

    Joints are left alone and projected: where the motion is prescribed a projection leaves nothing of the error, and at
    singular positions rows left alone drift off. The worse of the two is taken.
    """
    second = fourth = dict.fromkeys(QUANTITY_NAMES, math.inf)
    every = REFINEMENTS[0]
    for every in REFINEMENTS:
        second, fourth = (_judged(scene, order, every) for order in (2, 4))
        if second["angle"] <= REACH:
            break
    if not max(second["angle"], fourth["angle"]) <= SATURATED:
        # Of a motion that is lost nothing follows for another order.
        second = fourth = dict.fromkeys(QUANTITY_NAMES, math.inf)
    mechanism = scene.mechanism()
    prescribed = is_prescribed(mechanism)
    return Prediction(
        scene.spacing / every,
        second,
        fourth,
        mechanism.length_scale,
        *_motion(scene),
        {kind: softened(scene, *kind) for kind in soft},
        tuple(mechanism.holonomic.tolist()),
        prescribed,
        _earlier(scene) if prescribed else {},
    )


def _sampled(scene: Scene) -> Trajectory:
    """The truth at DIFFERENCES + 1 instants within what is compared."""
    return scene.motion(np.linspace(0.0, min(scene.horizon, scene.comparable_until), DIFFERENCES + 1))


def _earlier(scene: Scene) -> Mapping[str, float]:
    """Errors of the truth's own velocities and reactions, a difference late, over that difference [s]."""
    mechanism, truth = scene.mechanism(), _sampled(scene)
    names = ("t", "pose", "twist", "reaction")
    now, before = (
        Trajectory(*(getattr(truth, name)[part] for name in names)) for part in (slice(1, None), slice(None, -1))
    )
    late = replace(now, twist=before.twist, reaction=before.reaction)
    told = constraint_errors(mechanism, late) | motion_errors(scene, mechanism, now, late)
    return {name: told[name] / (truth.t[1] - truth.t[0]) for name in QUANTITY_NAMES}


def _motion(scene: Scene) -> tuple[float, float, tuple[float, float]]:
    """Speed, acceleration and the change of reactions of the truth; see Prediction."""
    mechanism = scene.mechanism()
    truth, length = _sampled(scene), mechanism.length_scale
    dt = truth.t[1]
    twist, reaction = truth.twist, truth.reaction
    speed = max(largest(np.hypot(twist[..., 0], twist[..., 1])), length * largest(twist[..., 2]))
    change = np.diff(twist, axis=0) / dt
    acceleration = max(largest(np.hypot(change[..., 0], change[..., 1])), math.hypot(*mechanism.gravity))
    scale = largest(reaction)
    first, second = largest(np.diff(reaction, axis=0)) / dt, largest(np.diff(reaction, 2, axis=0)) / dt**2
    changing = (first / scale, second / scale) if scale > 0 else (0.0, 0.0)
    return speed, acceleration, changing


def softened(scene: Scene, rows: tuple[bool, ...], complete: bool) -> Mapping[str, float]:
    """Errors by quantity of joints that give way as the judge's own do: by compliance, or, incomplete, by their lag."""
    every = max(1, math.ceil(scene.spacing * DAMPING / 2))
    found: Mapping[str, float] = dict.fromkeys(QUANTITY_NAMES, math.inf)
    if scene.samples * every > MOST_STEPS:
        return found
    # Where this much softness loses the motion, a thousandth of it is tried, and a thousandth of that.
    for less in (1.0, 1e3, 1e6):
        soft = Regularisation(STIFFNESS, DAMPING, COMPLIANCE / less, rows, complete)
        found = {name: value * less for name, value in errors(scene, 4, every, soft).items()}
        if not complete or found["angle"] / less <= SATURATED:
            break
    return found


def _judged(scene: Scene, order: int, every: int) -> Mapping[str, float]:
    """The worse of both treatments of the joints, without one that lost the motion (an error above half a radian)."""
    found = [errors(scene, order, every, project=project) for project in (False, True)]
    kept = [told for told in found if told["angle"] <= SATURATED] or found
    return _worse(kept[0], kept[-1])


# The judge's own steps take minutes for more bodies than this: of those only the gate asks it.
MOST_BODIES = 20
# One stage of the judge [s] for a few bodies, about; a step has four.
STAGE = 1e-3


@dataclass(frozen=True)
class Softened(Task):
    """Largest errors, by quantity, of joints that give way as the judge's own do; see `reports.gate.prediction`."""

    scene: Scene
    rows: tuple[bool, ...]
    complete: bool

    @property
    def cost(self) -> float:
        steps = self.scene.samples * max(1, math.ceil(self.scene.spacing * DAMPING / 2))
        return 4 * STAGE * steps

    @property
    def label(self) -> str:
        soft = "soft joints" if self.complete else "joints without their velocity term"
        return f"{self.scene.name}: {soft}, by the judge"

    def run(self) -> Values:
        return {name: np.array(value) for name, value in softened(self.scene, self.rows, self.complete).items()}


def soft_tasks(scene: Scene, engines: tuple[Engine, ...]) -> tuple[Softened, ...]:
    """What the judge has to run once to tell what these engines declare in a scene; none where it has many bodies."""
    if len(mechanism_of(scene).bodies) > MOST_BODIES:
        return ()
    return tuple(Softened(scene, *kind) for kind in sorted(kinds(scene, engines)))


def declared_error(answers: Mapping[Task, Answer], scene: Scene, engine: Engine, quantity: str, step: float) -> float:
    """What the engine's declared softness alone costs at this step [s]; 0 where it declares none, NaN if not known."""
    mechanism = mechanism_of(scene)
    softness = engine.regularisation(mechanism, step)
    soft: dict[SoftKind, dict[str, float]] = {}
    for complete in (True, False):
        rows = softness.rows if softness is not None else ()
        answer = answers.get(Softened(scene, rows, complete))
        if answer is not None and answer.finished:
            soft[rows, complete] = {name: answer.number(name) for name in QUANTITY_NAMES}
    try:
        return given(soft, quantity, softness, mechanism.holonomic.tolist())
    except KeyError:  # the judge was not asked, or failed
        return math.nan


def all_tasks(page: Page) -> tuple[Task, ...]:
    """The tasks of a page, of its experiments, and of what its engines declare, each once."""
    experiments = [task for failure in page.failures for task in failure.tasks]
    declared = [task for scene in page.scenes for task in soft_tasks(scene, page.engines_of(scene))]
    return tuple(dict.fromkeys([*page.tasks, *experiments, *declared]))
