"""The page of engines: elements that each engine builds, error against CPU time, and the velocity term of loops.

The velocity term of a loop is the right-hand side of J q'' = -J' q' in the tree's coordinates q. An engine that omits
this term solves J q'' = 0. The engine's reactions at instants of the exact motion are compared with the solutions of
both equations. The equations differ only in rows that the engine declares as regularised.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported, method_name, registry
from engines.tree import spanning_tree
from reference.joints import Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.scene import Scene
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model.cells import FULL, SLOW_TO_BUILD, Cell, beside_cells, sweep_cells
from reports.model.ending import describe
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.model.tasks import Answer, Values
from reports.pages.common import CLOSED_IN_1_MS, MethodTask
from reports.plots.theme import svg
from reports.plots.work_precision import work_precision
from reports.write.columns import Column, column_of
from reports.write.provenance import engine_versions
from reports.write.rows import Rows
from reports.write.tables import markdown, number

Array = NDArray[np.float64]


class BuildingTask(MethodTask):
    @property
    def cost(self) -> float:
        return 0.1 + self.method.build_time


BUILD_STEP = 1e-2  # s
YES, CONTACT, CODE = "yes", "by contact", "with our code"
HAS_NONE, NOT_BUILT, TOO_OLD = "**has none**", "not built", "too old"


@dataclass(frozen=True)
class Capabilities(BuildingTask):
    """The elements that an engine builds. Each line of `examples.ELEMENT_EXAMPLES` has a word for the table. The reason
    of a refusal has the key `reason_key(line)`. A run determines `reactions` and `width`."""

    description: ClassVar[str] = "what it builds"

    def run(self) -> Values:
        from reports.pages.engines.examples import (  # A run of other cells does not need these mechanisms.
            ELEMENT_EXAMPLES,
            WORLD,
        )

        values: dict[str, str] = {}
        for line, mechanism in ELEMENT_EXAMPLES.items():
            values[line], values[reason_key(line)] = self._build(mechanism)
        run = self.method.build(WORLD["swinging bar"], BUILD_STEP)(4, 1)
        finite = [bool(np.isfinite(reaction).all()) for reaction in run.reaction]
        values["reactions"] = "yes" if all(finite) else "not at the start" if all(finite[1:]) else "no"
        # Velocities are the engine's numbers, whereas our code may compute poses from the engine's coordinates.
        velocity = run.twist[1:]
        is_single = self.method.precision > 0 or np.array_equal(velocity, velocity.astype(np.float32))
        values["width"] = "32 bits" if is_single else "64 bits"
        return values

    def _build(self, mechanism: Mechanism) -> tuple[str, str]:
        try:
            self.method.build(mechanism, BUILD_STEP)
        except Unsupported as reason:
            return _word_of(reason), str(reason)
        except (AttributeError, ImportError, TypeError) as error:
            return TOO_OLD, f"this release lacks a function that our adapter calls: {describe(error)}"
        rolls = any(isinstance(joint, Skate | Roll) for joint in mechanism.joints)
        result = CONTACT if rolls and self.method.uses_contacts else YES
        with suppress(ValueError):
            enforcement = {self.method.enforcement(joint, mechanism) for joint in mechanism.joints}
            if mechanism.forces:
                enforcement.add(self.method.forces_by)
            result = result if enforcement == {"engine"} else CODE
        return result, ""


def _word_of(refusal: Unsupported) -> str:
    return HAS_NONE if refusal.documentation else NOT_BUILT


def reason_key(line: str) -> str:
    return f"{line}: reason"


COMPARED_INSTANTS = 12
TERM_STEP = 1e-3  # s


def started_at(mechanism: Mechanism, pose: Array, twist: Array) -> Mechanism:
    """The mechanism with another initial state: poses and twists (bodies, 3)."""
    bodies = tuple(
        replace(body, pose=tuple(body_pose.tolist()), twist=tuple(body_twist.tolist()))
        for body, body_pose, body_twist in zip(mechanism.bodies, pose, twist, strict=True)
    )
    return replace(mechanism, bodies=bodies)


def reactions_with(
    mechanism: Mechanism, soft: tuple[bool, ...], complete: bool, compliance: Array | float = 0.0
) -> Array:
    """The reactions (rows,) [N, N m] in the initial state.

    Args:
        soft: whether each row is regularised (rows,).
        complete: whether regularised rows have their velocity term.
        compliance: compliance of each row [1/kg, 1/(kg m^2)] (rows,).
    """
    rows = mechanism.rows(mechanism.pose)
    bias = mechanism.bias(mechanism.pose, mechanism.twist)
    if not complete:
        tree = spanning_tree(mechanism)
        zero = np.zeros((1, tree.coordinates))
        _, _, acceleration = tree.motion(zero, tree.start_rates()[None], zero)
        bias = np.where(soft, rows @ acceleration.reshape(-1), bias)
    weight = 1 / mechanism.inertias.reshape(-1)
    right: Array = bias - rows @ mechanism.free_fall.reshape(-1)
    inverse = (rows * weight) @ rows.T + np.diag(np.broadcast_to(compliance, right.shape))
    return np.asarray(np.linalg.solve(inverse, right), dtype=np.float64)


@dataclass(frozen=True)
class VelocityTerm(BuildingTask):
    """Relative differences (instants,) of an engine's reactions from the equations with and without the velocity
    term."""

    description: ClassVar[str] = "the velocity term of a loop"

    def run(self) -> Values:
        scene = FreeFourBar()
        mechanism = scene.mechanism()
        regularisation = self.method.regularisation(mechanism, TERM_STEP)
        if regularisation is None:
            raise ValueError(f"{method_name(self.method)} declares no regularised rows: its loops are exact")
        t = np.linspace(0.2, 1.0, COMPARED_INSTANTS) * scene.duration
        truth = scene.motion(t)
        differences: dict[str, list[float]] = {"with": [], "without": []}
        for pose, twist in zip(truth.pose, truth.twist, strict=True):
            started = started_at(mechanism, pose, twist)
            reaction = self.method.build(started, TERM_STEP)(1, 1).reaction[0]
            for name, complete in (("with", True), ("without", False)):
                expected = reactions_with(started, regularisation.rows, complete)
                differences[name].append(float(np.abs(reaction - expected).max() / np.abs(expected).max()))
        return {"t": t, **{name: np.array(values) for name, values in differences.items()}}


FREE_LOOP = FreeFourBar()
MILLISECOND = round(FREE_LOOP.spacing / 1e-3)  # number of steps of 1 ms between samples

# Quantity -> scenes of its chart. Each mechanism has a scene in the chart if its page compares this quantity.
CHARTED = {
    "angle": (
        *("free_four_bar", "driven_slider_crank", "pendulum_2", "pendulum_10", "n_four_bar_2"),
        *("person_two_feet", "rolling_disc"),
    ),
    "position": ("sleigh", "cart"),
}
SCENE_BY_NAME: dict[str, Scene] = {scene.name: scene for scene in SCENES}
CHARTED_SCENES = tuple(SCENE_BY_NAME[name] for names in CHARTED.values() for name in names)

# Engines that compile slowly are run at one step only, in a scene with a loop and in a scene without a loop.
COMPILED_CELLS = tuple(
    Cell(SCENE_BY_NAME[name], engine, MILLISECOND, "beside")
    for name in ("free_four_bar", "pendulum_2")
    for engine in registry.OTHERS
    if engine.build_time >= SLOW_TO_BUILD
)

# There is one task for each engine, because variants of an engine build almost the same elements.
FIRST_VARIANTS = {engine.name: engine for engine in reversed((*registry.VARIANTS, *registry.OTHERS))}
MATRIX = tuple(map(Capabilities, reversed(FIRST_VARIANTS.values())))
# The variants "tuned" of engines that declare compliant loops, since their compliance is small.
VELOCITY_TERMS = tuple(
    VelocityTerm(engine)
    for engine in (*registry.VARIANTS, *registry.OTHERS)
    if engine.variant == "tuned"
    and (regularisation := engine.regularisation(FREE_LOOP.mechanism(), TERM_STEP)) is not None
    and regularisation.compliance
)


def rows_of(material: Material, scenes: Iterable[str]) -> list[Measurement]:
    """The rows of all engines in `scenes`, without naive methods. The rows get the purpose "sweep"."""
    names = {*scenes}
    return [
        replace(row, purpose="sweep")
        for cell, row in material.rows.items()
        if cell.scene.name in names
        and cell.purpose in ("sweep", "beside")
        and column_of(cell.scene, cell.engine) is not Column.NAIVE
    ]


def comparable_error(row: Measurement | None, field: str = "angle") -> float:
    """The run's error; infinite if the run can't be compared."""
    usable = row is not None and Outcome(row.outcome).comparable and getattr(row, field) > 0
    return getattr(row, field) if usable else inf


def word_and_reason(task: Capabilities, answer: Answer, line: str) -> tuple[str, str]:
    """The word of a line and the reason of a refusal, from the capability table or from the stored answer."""
    from reports.pages.engines.examples import ELEMENT_EXAMPLES

    capability = task.method.capability
    if capability and (refusal := capability.refusal(ELEMENT_EXAMPLES[line])):
        return _word_of(refusal), str(refusal)
    return str(answer.values[line]), str(answer.values.get(reason_key(line), ""))


def matrix(answers: Mapping[Capabilities, Answer]) -> str:
    """A Markdown table with a column for each engine and a line for each element; empty without answers."""
    from reports.pages.engines.examples import ELEMENT_EXAMPLES

    engines = [task.method for task in answers]
    body = [[line, *(word_and_reason(*pair, line)[0] for pair in answers.items())] for line in ELEMENT_EXAMPLES]
    body += [[line, *(str(answer.values[line]) for answer in answers.values())] for line in ("reactions", "width")]
    body.append(["version", *(engine_versions([engine]) for engine in engines)])
    return markdown(["", *(engine.name for engine in engines)], body, left=len(engines) + 1) if engines else ""


def refusals_of(answers: Mapping[Capabilities, Answer]) -> list[tuple[str, str, str, str]]:
    """A row (engine, line, word of the table, reason) for each element that is not built."""
    from reports.pages.engines.examples import ELEMENT_EXAMPLES

    found = [
        (task, line, *word_and_reason(task, answer, line))
        for task, answer in answers.items()
        for line in ELEMENT_EXAMPLES
    ]
    return [(task.method.name, line, word, reason) for task, line, word, reason in found if reason]


def charted_methods(rows: Sequence[Measurement], field: str) -> set[tuple[str, str]]:
    """Pairs (scene, method). For each scene, an engine has its default and its most accurate method."""
    chosen: set[tuple[str, str]] = set()
    for scene, engine in dict.fromkeys((row.scene, row.engine) for row in rows):
        of_engine = [row for row in rows if (row.scene, row.engine) == (scene, engine)]
        best = min(of_engine, key=lambda row: comparable_error(row, field))
        chosen |= {(scene, best.method)} | {(scene, row.method) for row in of_engine if row.variant == "default"}
    return chosen


def figures(material: Material) -> dict[str, str]:
    pictures: dict[str, str] = {}
    for field, names in CHARTED.items():
        rows = [row for row in rows_of(material, names) if comparable_error(row, field) < inf and row.cpu > 0]
        if rows:
            chosen = charted_methods(rows, field)
            figure = work_precision(rows, lambda row, chosen=chosen: (row.scene, row.method) in chosen, field)
            title = f"Each engine as shipped and at its best: {field} error against CPU time"
            pictures[f"work_{field}"] = svg(figure, title)
    return pictures


def velocity_terms(material: Material) -> str:
    """A Markdown table of the largest relative differences of VELOCITY_TERMS; empty without answers."""
    body = [
        [method_name(task.method), *(number(float(answer.array(name).max())) for name in ("with", "without"))]
        for task in VELOCITY_TERMS
        if (answer := material.finished(task)) is not None
    ]
    header = ["method", "to the equation with the velocity term", "to the equation without it"]
    return markdown(header, body) if body else ""


def context(material: Material) -> Mapping[str, Any]:
    answers = {task: answer for task in MATRIX if (answer := material.finished(task)) is not None}
    four_bar = Rows(rows_of(material, [FREE_LOOP.name]))
    return {
        "matrix": matrix(answers),
        "refused": refusals_of(answers),
        "terms": velocity_terms(material),
        "absent": list(registry.ABSENT.values()),
        "at_1_ms": lambda method: four_bar.of(method=method).at(1e-3),
        "closed_in_a_millisecond": CLOSED_IN_1_MS,
    }


PAGE = Page(
    name="engines",
    title="Engines side by side",
    lesson="What each engine builds, its cost and error, and why engines of equal order differ by a factor of twenty.",
    companions=(FREE_LOOP,),
    borrowed=sweep_cells(CHARTED_SCENES, registry.VARIANTS, FULL),
    cells=beside_cells(CHARTED_SCENES, registry.OTHERS, sweep=True),
    failures=(
        Failure(
            title="Compiled models",
            expected="The same model as in C; where a loop rotates, its error does not fall with the step.",
            cells=COMPILED_CELLS,
            columns=("angle", "gap", "reaction"),
        ),
    ),
    figures=figures,
    context=context,
    tasks=(*MATRIX, *VELOCITY_TERMS),
)
