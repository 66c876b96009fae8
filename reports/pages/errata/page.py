"""The page of errata: the wrong formulas of the chapter, and the derivatives and engines that prove them wrong.

Each slip has a document slips/NUMBER.md with the printed and the right formula, and a script that evaluates both.

Engines give evidence that does not use the chapter's formulas. Accelerations are computed from the velocities in
engines by differences.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from engines import Engine, method_name, mujoco, pymunk
from engines.lagrange import Lagrange
from reference.chapter import errata
from reference.chapter.errata import Array, Values, acceleration_of_g, closed_form, integrated, rolling_acceleration
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.plane import perpendicular, rotation_velocity
from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import RollingOnCircle
from reference.scenes.skates import ChaplyginSleigh
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.tasks import Answer, Task
from reports.model.tasks import Values as Kept
from reports.pages.common import MethodTask, run_script
from reports.run.running import run_items
from reports.write.tables import number

REFEREES: tuple[Engine, ...] = (pymunk.EXTENDED, mujoco.EXTENDED, Lagrange("rk4", "projection"))

# Time between samples [s]. With this value, differences of order eight have far smaller errors than the engines.
WINDOW_SPACING = 1e-3
RUN_SAMPLES = 300
# Weights of nine points in the first and second derivatives at the middle point.
FIRST_DERIVATIVE = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840
SECOND_DERIVATIVE = np.array([-9, 128, -1008, 8064, -14350, 8064, -1008, 128, -9]) / 5040
POINTS, MIDDLE = len(FIRST_DERIVATIVE), len(FIRST_DERIVATIVE) // 2


@dataclass(frozen=True)
class SampleWindow:
    """POINTS successive samples of an engine's motion. Formulas are evaluated at the middle sample."""

    pose: Array  # (POINTS, bodies, 3).
    twist: Array  # (POINTS, bodies, 3).

    def change(self, values: Array) -> Array:
        """The time derivative of values (POINTS, ...) at the middle sample."""
        return np.tensordot(FIRST_DERIVATIVE, values, axes=1) / WINDOW_SPACING


HILL, SLEIGH = RollingOnCircle(), ChaplyginSleigh()
CONFIRMED = 0  # number of equations (18.70) and (18.71), which are right as printed


def double_pendulum() -> Mechanism:
    """Two uniform bars of 1 kg under gravity, with lengths, angles and rates from `reference.chapter.errata`."""
    chain = Chain((errata.BAR,) * 2, (1.0, 1.0))
    angle, rate = np.array(errata.PHI), np.array(errata.PHI_RATE)
    pose, twist, _ = chain.placement(angle, rate, np.zeros(2))
    bodies = tuple(
        Body(name, 1.0, float(chain.inertia[i]), tuple(pose[i].tolist()), tuple(twist[i].tolist()))
        for i, name in enumerate(("OA", "AB"))
    )
    half = errata.BAR / 2
    joints = (Pin("O", None, "OA", (0.0, 0.0), (-half, 0.0)), Pin("A", "OA", "AB", (half, 0.0), (-half, 0.0)))
    return Mechanism(bodies, joints, (0.0, -chain.gravity))


def _pendulum(window: SampleWindow) -> dict[int, Values]:
    """Accelerations of the bars' ends, by r_A = 2 r_G1 and r_B/A = 2 (r_G2 - r_A)."""
    velocity = window.twist[:, :, :2]
    ends = np.stack([2 * velocity[:, 0], 2 * (velocity[:, 1] - 2 * velocity[:, 0])], axis=1)
    measured, turning = window.change(ends), window.change(window.twist[:, :, 2])
    # The x axis of a bar points from its pin to its end; the chapter measures phi from another direction.
    angle, rate = window.pose[MIDDLE, :, 2] + math.pi / 2, window.twist[MIDDLE, :, 2]
    # The formula in the note is for phi1'', so the second derivative of the angle decides.
    twice = np.atleast_1d(SECOND_DERIVATIVE @ window.pose[:, 0, 2]) / WINDOW_SPACING**2
    values = {24: Values(rate[:1], turning[:1], twice)}
    for slip, (bar, printed) in errata.PENDULUM_SLIPS.items():
        state = errata.BarState(errata.BAR, float(angle[bar]), float(rate[bar]), float(turning[bar]))
        values[slip] = Values(printed(state), errata.right(state), measured[bar])
    return values


def _rolling(window: SampleWindow) -> dict[int, Values]:
    """The point of contact lies on the line from the hill's centre to the disc's centre."""
    pose, twist = window.pose[:, 0], window.twist[:, 0]
    arm = HILL.eccentricity * np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], axis=-1)
    centre = pose[:, :2] + arm
    direction = centre / np.linalg.norm(centre, axis=-1, keepdims=True)
    contact = HILL.hill * direction
    normal, rate = direction[MIDDLE], twist[MIDDLE, 2]
    tangent = perpendicular(normal)
    advance = HILL.hill * (math.atan2(normal[1], normal[0]) - math.pi / 2)  # arc length s, which is 0 at the top
    speed = rate / (1 / HILL.hill + 1 / HILL.radius)
    # The pole is the point of contact, which has no velocity; it is not the origin of the ground.
    at_origin, at_contact = (
        twist[MIDDLE, :2] + rotation_velocity(rate, point - pose[MIDDLE, :2]) for point in (0.0, contact[MIDDLE])
    )
    return {
        1: Values(advance * tangent, speed * tangent, window.change(contact)),
        2: Values(at_origin, at_contact, np.zeros(2)),
    }


def _skate(window: SampleWindow) -> dict[int, Values]:
    pose, twist = window.pose[:, 0], window.twist[:, 0]
    along = np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], axis=-1)
    # G and C have the same speed along the blade, since the line C G is parallel to it
    speed = np.sum(twist[:, :2] * along, axis=-1)
    push, turning = (float(window.change(values)) for values in (speed, twist[:, 2]))
    state = (float(pose[MIDDLE, 2]), float(speed[MIDDLE]), push, float(twist[MIDDLE, 2]), turning, (SLEIGH.offset, 0.0))
    return {11: Values(*acceleration_of_g(*state), window.change(twist[:, :2]))}


def _four_bar(window: SampleWindow) -> dict[int, Values]:
    theta, beta, phi = (float(angle) for angle in window.pose[MIDDLE, :, 2])
    crank, *others = window.twist[MIDDLE, :, 2]
    rates = crank * np.array(errata.rates(theta, beta, phi))
    return {
        19: Values(integrated(theta), np.array(closed_form(theta)), np.array([beta, phi])),
        CONFIRMED: Values(rates, rates, np.array(others)),
    }


class DecidingMotion(NamedTuple):
    """A mechanism, and the function that computes the values of slips from an engine's motion."""

    mechanism: Callable[[], Mechanism]
    read: Callable[[SampleWindow], dict[int, Values]]


COMPANIONS: tuple[Scene, ...] = (HILL, SLEIGH, DrivenFourBar(), LinkPendulum())
QUESTIONS: dict[str, DecidingMotion] = {  # description of the motion -> mechanism and values
    "a disc rolls off a round hill": DecidingMotion(HILL.mechanism, _rolling),
    "a sleigh on one skate coasts": DecidingMotion(SLEIGH.mechanism, _skate),
    "the crank of sample 18.15 turns at 10 rad/s": DecidingMotion(DrivenFourBar().mechanism, _four_bar),
    "the double pendulum falls": DecidingMotion(double_pendulum, _pendulum),
}


@dataclass(frozen=True)
class Refereed(MethodTask):
    """A task with the last POINTS samples of the motion `question` in an engine."""

    question: str
    description: ClassVar[str] = "{0.question}"
    seconds: ClassVar[float] = 0.2

    def run(self) -> Kept:
        motion = self.method.build(QUESTIONS[self.question].mechanism(), WINDOW_SPACING)(RUN_SAMPLES, 1)
        return {"pose": motion.pose[-POINTS:], "twist": motion.twist[-POINTS:]}


TASKS = tuple(Refereed(engine, question) for question in QUESTIONS for engine in REFEREES)


@dataclass(frozen=True)
class Ruling:
    """The values of one slip from an engine's motion near 0.3 s. `about`: description of the motion."""

    number: int
    method: str
    about: str
    values: Values


def rulings(answers: Iterable[tuple[Task, Answer]]) -> tuple[tuple[Ruling, ...], list[str]]:
    """The rulings, sorted by slip, and messages about failed runs. A mechanism that an engine refuses gives no
    message."""
    decided: list[Ruling] = []
    failed: list[str] = []
    for task, answer in answers:
        if not isinstance(task, Refereed) or answer.outcome == Outcome.UNSUPPORTED:
            continue
        method = method_name(task.method)
        if not answer.finished:
            failed.append(f"{method} where {task.question}: {answer.told}")
            continue
        window = SampleWindow(answer.array("pose"), answer.array("twist"))
        if not (np.isfinite(window.pose).all() and np.isfinite(window.twist).all()):
            failed.append(f"{method} where {task.question}: its motion is not finite")
            continue
        values_by_slip = QUESTIONS[task.question].read(window)
        decided += [Ruling(slip, method, task.question, values) for slip, values in values_by_slip.items()]
    return tuple(sorted(decided, key=lambda ruling: ruling.number)), failed


@dataclass(frozen=True)
class Erratum:
    """One slip of the chapter.

    printed, right: the printed and the right formula as text.
    deciding: a description of the derivative that decides.
    dimensions: whether physical dimensions are enough to show the slip.
    quoted, corrected: the printed and the right formula in LaTeX.
    script: the script that computes the values, or "" for a slip of wording.
    """

    number: int
    where: str
    printed: str
    right: str
    reason: str
    unit: str
    deciding: str
    dimensions: bool
    quoted: str
    corrected: str
    script: str

    @cached_property
    def names(self) -> Mapping[str, Any]:
        return run_script(f"slip {self.number}", self.script)

    @property
    def values(self) -> Values:
        return Values(self.names["printed"], self.names["right"], self.names["measured"])

    @property
    def by_tolerance(self) -> Mapping[float, float]:
        """Tolerance -> error, for a slip in which the chapter integrates without stating a tolerance; empty for other
        slips."""
        return self.names.get("by_tolerance", {})


def read_slip(path: Path) -> Erratum:
    text = path.read_text("utf-8")
    fields = dict(re.findall(r"^- ([\w ]+): (.*)$", text, re.MULTILINE))
    quoted, corrected = re.findall(r"```math\n(.*?)\n```", text, re.DOTALL) or ("", "")
    (script,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL) or ("",)
    where, dimensions = text.splitlines()[0].partition(": ")[2], fields.get("shown by") == "dimensions"
    texts = {name: fields.get(name, "") for name in ("printed", "right", "reason", "unit", "deciding")}
    return Erratum(
        int(path.stem), where, **texts, dimensions=dimensions, quoted=quoted, corrected=corrected, script=script
    )


SLIPS_OF_CHAPTER = tuple(map(read_slip, sorted((Path(__file__).parent / "slips").glob("*.md"))))
ERRATA = tuple(slip for slip in SLIPS_OF_CHAPTER if slip.script)
WORD_SLIPS = tuple(slip for slip in SLIPS_OF_CHAPTER if not slip.script)


def digits(values: Iterable[float]) -> str:
    """A vector as a text such as '(-2.2203, 1.5005)', or a single number without brackets."""
    numbers = [f"{value:.5g}" for value in np.where(np.abs(list(values)) < 1e-12, 0.0, list(values))]
    return f"({', '.join(numbers)})" if len(numbers) > 1 else numbers[0]


def missed(erratum: Erratum, pattern: str, between: str) -> str:
    """The errors at the tolerances of `by_tolerance` as text. `pattern` formats an error and a tolerance."""
    errors = erratum.by_tolerance.items()
    return between.join(pattern.format(number(error), number(tolerance)) for tolerance, error in errors)


def verdict(erratum: Erratum, values: Values, ruled: Sequence[Ruling]) -> str:
    """Sentences that compare the printed and the right formula with the derivative and with engines (`ruled`)."""
    right = number(values.agreement)
    misses = f"The printed formula misses it by {number(values.miss)}, the right one by {right}."
    pattern = "the printed one misses their motion by {0} or more, the right one by {1} at most."
    if erratum.by_tolerance:
        integration = missed(erratum, "{} at a relative tolerance of {}", " and ")
        misses = (
            f"The closed form misses it by {right}. The integration misses it by {integration}: "
            "the tolerance is ours, since the chapter states none."
        )
        pattern = "the closed form misses their motion by {1} at most."
    text = f"Decides ({erratum.deciding}): {digits(values.decides)} {erratum.unit}. {misses}"
    if not ruled:
        return text
    methods, motions = (", ".join(dict.fromkeys(getattr(each, name) for each in ruled)) for name in ("method", "about"))
    bounds = min(ruling.values.miss for ruling in ruled), max(ruling.values.agreement for ruling in ruled)
    return f"{text} Engines ({methods}; {motions}): {pattern.format(*map(number, bounds))}"


def slip_rows() -> list[tuple[str, ...]]:
    """A row (number, place, printed formula, right formula, derivative, verdict) for each slip."""
    rows = []
    for slip in SLIPS_OF_CHAPTER:
        formulas, decided, verdict_text = (slip.printed, slip.right), "-", f"words: {slip.reason}"
        if slip.script:
            values, right = slip.values, number(slip.values.agreement)
            formulas = f"{slip.printed}\n= {digits(values.printed)}", f"{slip.right}\n= {digits(values.right)}"
            decided = f"{digits(values.decides)}\n{slip.unit}"
            verdict_text = f"off by {number(values.miss)}, right by {right}"
            if slip.by_tolerance:
                integration = missed(slip, "{} at rtol {}", ", ")
                verdict_text = f"the claim; integration off by {integration} (ours); formula by {right}"
            verdict_text += "; dimensions show it" if slip.dimensions else "; only numbers show it"
        rows.append((str(slip.number), slip.where, *formulas, decided, verdict_text))
    return rows


def engine_rows() -> tuple[list[tuple[str, ...]], list[str]]:
    """Rows with the errors of the printed and the right formula by slip and engine, and messages about failed runs."""
    units, answers = {slip.number: slip.unit for slip in ERRATA}, dict(run_items(TASKS))
    decided, failed = rulings((task, answers[task]) for task in TASKS)
    return [
        (str(r.number), r.method, r.about, units[r.number], number(r.values.miss), number(r.values.agreement))
        for r in decided
        if r.number in units
    ], failed


def context(material: Material) -> Mapping[str, Any]:
    decided, failed = rulings(material.answers.items())
    slips = [
        {
            "erratum": erratum,
            "verdict": verdict(
                erratum, erratum.values, [ruling for ruling in decided if ruling.number == erratum.number]
            ),
            "script": f"reports/pages/errata/slips/{erratum.number:02}.md",
        }
        for erratum in ERRATA
    ]
    return {
        "errata": slips,
        "word_slips": WORD_SLIPS,
        "blind": [erratum.number for erratum in ERRATA if not erratum.dimensions],
        "seen": [erratum.number for erratum in ERRATA if erratum.dimensions],
        "rates": [(r.method, r.values.agreement) for r in decided if r.number == CONFIRMED],
        "lost": failed,
        "rolling": rolling_acceleration(),
    }


PAGE = Page(
    name="errata",
    title="Errata of the chapter",
    lesson="Printed slips of section 18.5 of a textbook, *advanced kinematics of planar motion*: each decided by a "
    "derivative, by engines, and by a few lines to run.",
    companions=COMPANIONS,
    context=context,
    tasks=TASKS,
)
