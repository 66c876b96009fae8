"""The page of the four-bar with its scenes, its experiments, and the nine configurations of figure 18.66."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from engines import Engine, method_name, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.registry import ENGINES, VARIANTS
from reference.scene import Scene
from reference.scenes.four_bar.scenes import (
    DrivenFourBar,
    FreeFourBar,
    OverdrivenFourBar,
    Parallelogram,
    SpinningFourBar,
)
from reports.model.cells import Cell
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Answer, Motion, Task, Values
from reports.pages.common import CLOSED_IN_1_MS, MAIN_METHODS, cells, described, read_answers, refusals, scene_page
from reports.plots import mechanisms as drawings
from reports.plots.theme import svg
from reports.versions.table import error_before_term
from reports.write.tables import markdown, number, step_words

SAMPLES_PER_REVOLUTION = 50


@dataclass(frozen=True)
class PrintedRates(Task):
    """RK45 integrates equations (18.70) and (18.71). `tolerance` is the relative tolerance; the absolute tolerance is a
    thousandth of it."""

    revolutions: int
    tolerance: float
    seconds: ClassVar[float] = 0.5
    words: ClassVar[str] = "printed rates over {0.revolutions} revolutions at {0.tolerance:g}"

    def run(self) -> Values:
        """`error`: the largest error of beta [rad]. `stopped`: the reason of an early end, or ""."""
        scene = DrivenFourBar()
        t = np.linspace(0, self.revolutions * scene.duration, SAMPLES_PER_REVOLUTION * self.revolutions + 1)
        beta, _ = scene.four_bar.angles(scene.start + scene.rate * t)
        integrated = scene.four_bar.integrate_rates(
            t, scene.rate, scene.start, rtol=self.tolerance, atol=self.tolerance * 1e-3
        )
        finite = np.isfinite(integrated.beta)
        return {
            "error": np.max(np.abs(integrated.beta - beta)[finite]),
            "evaluations": np.asarray(float(integrated.evaluations)),
            "stopped": integrated.stopped or "",
        }


WITH_EXACT: tuple[Engine, ...] = (*MAIN_METHODS, Lagrange("rk4", "projection"))
# The first tolerance is the default of scipy's solve_ivp.
DRIFTS = tuple(PrintedRates(revolutions, tolerance) for revolutions in (1, 100) for tolerance in (1e-3, 1e-6, 1e-9))


def rates_drift(material: Material) -> list[Observation]:
    def read(answer: Answer) -> str:
        error, count, stopped = number(answer.number("error")), answer.number("evaluations"), answer.values["stopped"]
        return rf"$\beta$ has an error of {error} rad after {count:.0f} evaluations{f', {stopped}' if stopped else ''}"

    turns = {1: "one revolution", 100: "100 revolutions"}
    settings = [(task, f"{turns[task.revolutions]}, rtol {number(task.tolerance, 1)}") for task in DRIFTS]
    return read_answers(material, "RK45 on the printed rates", settings, read)


def refusal(material: Material) -> list[Observation]:
    scene = OverdrivenFourBar()
    return refusals({f"{scene.duration:.3g} s": lambda: scene.motion([scene.duration])})


FEW_ITERATIONS = tuple(
    replace(pymunk.TUNED, variant=f"tuned, {count} sweep{'s' if count > 1 else ''}", iterations=count, error_bias=0.0)
    for count in (1, 2, 5, 20)
)


RECOMMENDED = "free_four_bar"

# The printed figure has nine poses at the ends of eight equal intervals, and the last pose equals the first.
INTERVALS = 8
SAMPLES_PER_INTERVAL = 8  # with this number, engines have a step of about 1e-2 s
DRAWN_OVER_TRUTH = {"pymunk default": ("first", "--"), "mujoco default": ("second", ":")}

# The readme's animation shows MOVING_METHODS and the exact motion, with steps of 1 ms.
MOVING_PICTURE = "moving.svg"
MOVING_EVERY = 10  # steps between samples
MOVING_METHODS = {
    "pymunk as shipped": pymunk.DEFAULT,
    "MuJoCo as shipped": mujoco.DEFAULT,
    "MuJoCo with the lines below": mujoco.TUNED,
}
MOVING_TASKS = tuple(Motion(Cell(FreeFourBar(), engine, MOVING_EVERY, "failure")) for engine in MOVING_METHODS.values())

POSED = {
    method_name(engine): Cell(DrivenFourBar(), engine, 1, samples=INTERVALS * SAMPLES_PER_INTERVAL)
    for engine in ENGINES
    if method_name(engine) in DRAWN_OVER_TRUTH
}


def figures(material: Material) -> dict[str, str]:
    scene = DrivenFourBar()
    motions = material.motions(POSED.values())
    truth = scene.motion(np.arange(INTERVALS + 1) * scene.duration / INTERVALS)
    others = {
        f"{name}, step {step_words(cell.step)}": (motions[cell].pose[::SAMPLES_PER_INTERVAL], *DRAWN_OVER_TRUTH[name])
        for name, cell in POSED.items()
        if cell in motions
    }
    titles = [f"$t_{i}$ = {t:.3f} s" for i, t in enumerate(truth.t)]
    figure = drawings.configurations(scene.mechanism(), truth.pose, titles, others, columns=5)
    return {"configurations": svg(figure, "The nine configurations of Fig. 18.66, from the closed form")}


def assemblies() -> str:
    """A Markdown table of the two assemblies at the first crank angle, with the gap at C."""
    scene = DrivenFourBar()
    bars, theta = scene.four_bar, scene.start
    b = bars.crank * np.exp(1j * theta)
    body = []
    for branch in (1, -1):
        beta, phi = bars.angles(theta, branch)
        gap = abs(b + bars.coupler * np.exp(1j * beta) - complex(*bars.ground) - bars.rocker * np.exp(1j * phi))
        body.append([f"{branch:+d}", *(f"{np.degrees(angle):.2f}" for angle in (theta, beta, phi)), number(gap)])
    return markdown(["assembly", "θ [°]", "β [°]", "φ [°]", "gap at C [m]"], body)


def context(material: Material) -> Mapping[str, Any]:
    """Numbers for the text, such as the compliance of MuJoCo's loops and the fraction of a gap that pymunk closes."""
    soft, hard = mujoco.Shipped().impedance, mujoco.TiedToStep().impedance
    return {
        "assemblies": assemblies(),
        "soft_share": [1 / d - 1 for d in soft[:2]],  # values without a gap and with a gap of 1 mm or more
        "stiff_share": 1 / hard[0] - 1,
        "before_term": error_before_term(),  # rad
        "closed_in_a_millisecond": CLOSED_IN_1_MS,
    }


def compared(scene: Scene, engine: Engine) -> bool:
    """Whether a method is run in a scene. Methods with one changed setting are run in one scene only."""
    return engine in VARIANTS or engine not in ENGINES or scene.name == RECOMMENDED


PAGE = scene_page(
    "four_bar",
    title="The four-bar linkage",
    lesson="Three bars and four pins: the loop that the chapter closes exactly and an engine closes by forces.",
    scenes=(DrivenFourBar(), FreeFourBar(), SpinningFourBar()),
    advised=RECOMMENDED,
    engines=ENGINES,
    compared=compared,
    failures=described(
        __file__,
        Failure("Rates without feedback", tasks=DRIFTS, observations=rates_drift),
        Failure(
            "A parallelogram through its change points",
            cells=cells(Parallelogram(), WITH_EXACT[:-1], (1, 10, 100))
            + cells(Parallelogram(), WITH_EXACT[-1:], (1, 10)),
        ),
        Failure(
            "A crank driven into its limit",
            cells=cells(OverdrivenFourBar(), WITH_EXACT, (1, 10)),
            observations=refusal,
        ),
        Failure(
            "Four ways to drive a crank",
            cells=cells(DrivenFourBar(), (mujoco.TUNED, pymunk.TUNED), (1, 10, 100)),
        ),
        Failure(
            "Steps far too large",
            cells=tuple(
                cell for samples in (20, 10, 5) for cell in cells(SpinningFourBar(), WITH_EXACT, (1,), samples)
            ),
        ),
        Failure("Too few iterations", cells=cells(SpinningFourBar(), FEW_ITERATIONS, (1, 10, 100))),
        Failure(
            "Worse as the step shrinks",
            cells=cells(SpinningFourBar(), (mujoco.DEFAULT, mujoco.TUNED), (1, 10, 100, 1000)),
        ),
        stops=lambda: f"{OverdrivenFourBar().stopping_time:.4f}",
    ),
    figures=figures,
    context=context,
    tasks=(*map(Motion, POSED.values()), *MOVING_TASKS),
)
