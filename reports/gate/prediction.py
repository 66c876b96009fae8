"""Predicted discretisation and regularisation errors of a scene, computed by the reference solver of the gate.

A discretisation error A (h / tau)^p has two unknowns, the amplitude A and the time scale tau. Runs of order 2 and of
order 4 determine A and tau. With A and tau, the error of any order p at any step h is known. The error of regularised
joints is proportional to their compliance, so one run predicts the error for all compliances.
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
from reports.model.outcomes import SATURATED
from reports.model.page import Page
from reports.model.quantities import QUANTITY
from reports.model.tasks import Answer, Task, Values

# The kind of a regularisation is (mask of the regularised rows, whether the velocity term of these rows is complete).
# The judge makes one run for each kind.
SoftKind = tuple[tuple[bool, ...], bool]

# The judge's runs have MuJoCo's default regularisation with a smaller compliance. Errors are proportional to the
# compliance and to 1 / stiffness [s^2]. For rows without a gap the errors are proportional to 1 / damping [s].
STIFFNESS, DAMPING, COMPLIANCE = 1 / 0.02**2, 2 / 0.02, 0.01

REFINEMENTS = (
    1,
    3,
)  # Steps per sample of the judge. The first number is used for which the error of order 2 is at most REACH.
REACH = 0.1  # rad.
MOST_STEPS = 20_000  # Largest number of steps of the judge. In longer scenes the method's coarser steps give the bound.
DIFFERENCES = 1000  # Number of intervals for finite differences of the true motion.


@dataclass(frozen=True)
class Prediction:
    """Errors of a scene by quantity, which can be scaled to any convergence order and regularisation.

    second: errors of the method of order 2 at `step` [s].
    fourth: errors of the method of order 4 at `step` [s].
    length: length of the mechanism [m].
    speed, acceleration: largest values of the reference motion [m/s, m/s^2].
    changing: first and second derivative of the reactions, divided by the largest reaction [1/s, 1/s^2].
    soft: errors with STIFFNESS, DAMPING and COMPLIANCE.
    holonomic: mask of the rows that constrain positions.
    prescribed: whether the drives determine the motion.
    lag: errors of delayed velocities and reactions in a prescribed motion, divided by the delay [s].
    """

    step: float
    second: Mapping[str, float]
    fourth: Mapping[str, float]
    length: float
    speed: float
    acceleration: float
    changing: tuple[float, float]
    soft: Mapping[SoftKind, Mapping[str, float]]
    holonomic: tuple[bool, ...]
    prescribed: bool = False
    lag: Mapping[str, float] = field(default_factory=dict)

    def is_defined(self, quantity: str) -> bool:
        """Whether the quantity exists in the scene. For example, a gap needs a joint that constrains positions."""
        return not math.isnan(self.second[quantity]) and (quantity != "gap" or any(self.holonomic))

    def error(self, quantity: str, order: float, step: float) -> float:
        """The predicted error A (step / tau)^order, or infinity if the judge's runs failed, or NaN if it is not
        defined.

        An error of the pose causes an error of the velocity, which is the pose error times speed / length. An error of
        the velocity may be a slip (`Quantity.follows`).
        """
        error = self._power(quantity, order, step)
        cause = QUANTITY[quantity].follows
        if not cause:
            return error
        rate = 1.0 if QUANTITY[cause].unit == QUANTITY[quantity].unit else self.speed / self.length
        return max(error, rate * self._power(cause, order, step))

    def _power(self, quantity: str, order: float, step: float) -> float:
        second, fourth = self.second[quantity], self.fourth[quantity]
        if order == EXACT:
            return 0.0
        if not (math.isfinite(second) and math.isfinite(fourth)):
            return math.nan if math.isnan(second) else math.inf
        if second == 0 or fourth == 0:
            return 0.0
        ratio = fourth / second  # (step / tau)^2
        if order < 2 and QUANTITY[quantity].scales_with_angle and 0 < self.fourth["angle"] < math.inf:
            ratio = min(ratio, self.fourth["angle"] / self.second["angle"])
        return second * ratio ** ((order - 2) / 2) * (step / self.step) ** order

    def softness_error(self, quantity: str, softness: Regularisation | None) -> float:
        return scaled_softness_error(self.soft, quantity, softness, self.holonomic)

    def gap_closing_error(self, quantity: str, gap: float, softness: Regularisation | None) -> float:
        """The error while a spring closes a gap [m] from discretisation with the velocity gap * damping."""
        if softness is None or not softness.complete or math.isnan(gap):
            return 0.0
        if quantity == "reaction":
            return gap * softness.stiffness / self.acceleration
        return self._error_of_slip(quantity, gap * softness.damping)

    def spring_transient_error(self, quantity: str, softness: Regularisation | None) -> float:
        """The error during the initial transient of a method's springs. If a critically damped spring with stiffness k
        [1/s^2] opens to the gap g [m], its largest speed is g sqrt(k) / e."""
        if softness is None or softness.compliance == 0:
            return 0.0
        return self._error_of_slip(
            quantity, self.softness_error("gap", softness) * math.sqrt(softness.stiffness) / math.e
        )

    def _error_of_slip(self, quantity: str, speed: float) -> float:
        """The error of a velocity or energy due to a slip of this speed [m/s], or zero for other quantities."""
        if quantity == "energy":
            return 2 * speed / self.speed
        return {"m/s": speed, "rad/s": speed / self.length}.get(QUANTITY[quantity].unit, 0.0)

    def differencing_error(self, order: float, step: float) -> float:
        """The relative error of a reaction computed from the change of velocity over a step [s]."""
        return self.changing[order > 1] * step ** min(order, 2)

    def largest_comparable(self, quantity: str) -> float:
        """The largest error of a comparable run, in the unit of the quantity."""
        scales = {"rad": 1.0, "m": self.length, "rad/s": self.speed / self.length, "m/s": self.speed}
        facts = QUANTITY[quantity]
        return facts.largest * scales.get(facts.unit, 1.0)


def scaled_softness_error(
    soft: Mapping[SoftKind, Mapping[str, float]],
    quantity: str,
    softness: Regularisation | None,
    holonomic: Sequence[bool],
) -> float:
    """The error that a regularisation causes, scaled from the judge's errors `soft`. holonomic: mask of the rows that
    constrain positions. The gap of these rows depends on the stiffness, and the slip of other rows on the damping."""
    if softness is None:
        return 0.0
    stiff, damped = STIFFNESS / softness.stiffness, DAMPING / softness.damping
    error = 0.0
    if softness.compliance > 0:
        yielding = {
            stiff if spring else damped for soft_row, spring in zip(softness.rows, holonomic, strict=True) if soft_row
        }
        error += soft[softness.rows, True][quantity] * softness.compliance / COMPLIANCE * max(yielding, default=0.0)
        # A regularised row of any stiffness transmits the share 1 - compliance of a force.
        error += softness.compliance if quantity == "reaction" else 0.0
    if not softness.complete:
        lag = stiff if quantity == "gap" else max(damped, stiff)
        error += soft[softness.rows, False][quantity] * lag
    return error


def kinds(scene: Scene, engines: Iterable[Engine]) -> frozenset[SoftKind]:
    """The kinds of regularisation that these engines declare for a scene."""
    mechanism = scene.mechanism()
    out: set[SoftKind] = set()
    for engine in engines:
        softness = engine.regularisation(mechanism, scene.spacing)
        if softness is not None:
            out |= {(softness.rows, True)} if softness.compliance > 0 else set()
            out |= set() if softness.complete else {(softness.rows, False)}
    return frozenset(out)


@cache
def prediction(scene: Scene, soft: frozenset[SoftKind] = frozenset()) -> Prediction:
    """The prediction for a scene, which takes about two seconds and is cached in this process. The judge runs with and
    without projection, and the larger error counts. In a prescribed motion projection removes the whole error. Without
    projection the constraints drift at singular positions."""
    second = fourth = dict.fromkeys(QUANTITY_NAMES, math.inf)
    every = REFINEMENTS[0]
    for every in REFINEMENTS:
        second, fourth = (_order_errors(scene, order, every) for order in (2, 4))
        if second["angle"] <= REACH:
            break
    if not max(second["angle"], fourth["angle"]) <= SATURATED:
        # The judge's run has diverged, so no other order can be predicted.
        second = fourth = dict.fromkeys(QUANTITY_NAMES, math.inf)
    mechanism = scene.mechanism()
    prescribed = is_prescribed(mechanism)
    return Prediction(
        scene.spacing / every,
        second,
        fourth,
        mechanism.length_scale,
        *_motion_scales(scene),
        {kind: unit_softness_errors(scene, *kind) for kind in soft},
        tuple(mechanism.holonomic.tolist()),
        prescribed,
        _lag_errors(scene) if prescribed else {},
    )


def _sampled(scene: Scene) -> Trajectory:
    return scene.motion(np.linspace(0.0, min(scene.horizon, scene.comparable_until), DIFFERENCES + 1))


def _lag_errors(scene: Scene) -> Mapping[str, float]:
    """Return for each quantity the error of a motion that is one interval late, divided by the interval [s]."""
    mechanism, truth = scene.mechanism(), _sampled(scene)
    names = ("t", "pose", "twist", "reaction")
    now, before = (
        Trajectory(*(getattr(truth, name)[part] for name in names)) for part in (slice(1, None), slice(None, -1))
    )
    late = replace(now, twist=before.twist, reaction=before.reaction)
    late_errors = constraint_errors(mechanism, late) | motion_errors(scene, mechanism, now, late)
    return {name: late_errors[name] / (truth.t[1] - truth.t[0]) for name in QUANTITY_NAMES}


def _motion_scales(scene: Scene) -> tuple[float, float, tuple[float, float]]:
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


def unit_softness_errors(scene: Scene, rows: tuple[bool, ...], complete: bool) -> Mapping[str, float]:
    """Quantity -> error if the rows in the mask are regularised by STIFFNESS, DAMPING and COMPLIANCE."""
    every = max(1, math.ceil(scene.spacing * DAMPING / 2))
    scaled: Mapping[str, float] = dict.fromkeys(QUANTITY_NAMES, math.inf)
    if scene.samples * every > MOST_STEPS:
        return scaled
    for divisor in (1.0, 1e3, 1e6):  # If the motion diverges, the next divisor is used.
        soft = Regularisation(STIFFNESS, DAMPING, COMPLIANCE / divisor, rows, complete)
        scaled = {name: value * divisor for name, value in errors(scene, 4, every, soft).items()}
        if not complete or scaled["angle"] / divisor <= SATURATED:
            break
    return scaled


def _order_errors(scene: Scene, order: int, every: int) -> Mapping[str, float]:
    """Quantity -> the larger error of the runs with and without projection. A run with an angle error above SATURATED
    is ignored unless both runs have such an error."""
    runs = [errors(scene, order, every, project=project) for project in (False, True)]
    followed = [run for run in runs if run["angle"] <= SATURATED] or runs
    out = {}
    for name in QUANTITY_NAMES:
        known = [run[name] for run in followed if not math.isnan(run[name])]
        out[name] = max(filter(math.isfinite, known), default=math.inf) if known else math.nan
    return out


MOST_BODIES = 20  # Pages do not use the judge for scenes with more bodies, since a run would take minutes.
STAGE = 1e-3  # Approximate time of one Runge-Kutta stage of the judge for a few bodies [s].


@dataclass(frozen=True)
class Softened(Task):
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
        return {
            name: np.array(value) for name, value in unit_softness_errors(self.scene, self.rows, self.complete).items()
        }


def soft_tasks(scene: Scene, engines: tuple[Engine, ...]) -> tuple[Softened, ...]:
    """The judge's runs for the regularisations of these engines. There are no runs for more than MOST_BODIES bodies."""
    if len(mechanism_of(scene).bodies) > MOST_BODIES:
        return ()
    return tuple(Softened(scene, *kind) for kind in sorted(kinds(scene, engines)))


def declared_error(answers: Mapping[Task, Answer], scene: Scene, engine: Engine, quantity: str, step: float) -> float:
    """The error that the engine's declared regularisation causes at this step [s], or NaN if it is unknown."""
    mechanism = mechanism_of(scene)
    softness = engine.regularisation(mechanism, step)
    soft: dict[SoftKind, dict[str, float]] = {}
    for complete in (True, False):
        rows = softness.rows if softness is not None else ()
        answer = answers.get(Softened(scene, rows, complete))
        if answer is not None and answer.finished:
            soft[rows, complete] = {name: answer.number(name) for name in QUANTITY_NAMES}
    try:
        return scaled_softness_error(soft, quantity, softness, mechanism.holonomic.tolist())
    except KeyError:  # The task was not run, or it failed.
        return math.nan


def all_tasks(page: Page) -> tuple[Task, ...]:
    """The distinct tasks of a page: for its text, for its experiments, and the judge's runs for its engines. The
    judge's runs follow from the engines' regularisations, so models for all scenes of the page are built."""
    declared = [task for scene in page.scenes for task in soft_tasks(scene, page.engines_of(scene))]
    return tuple(dict.fromkeys([*described_tasks(page), *declared]))


def described_tasks(page: Page) -> tuple[Task, ...]:
    """The tasks for the text and the experiments of a page."""
    return (*page.tasks, *(task for failure in page.failures for task in failure.tasks))
