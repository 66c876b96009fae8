"""The four-bar's page: its scenes, its failure experiments, and the nine configurations of Fig. 18.66."""

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
from reports.model.page import Failure, Material, Observation, Page
from reports.model.tasks import Answer, Motion, Task, Values
from reports.pages.common import ALL, cells, described, deviations, read_answers, refusals
from reports.plots import mechanisms as drawings
from reports.plots.theme import svg
from reports.versions.table import released
from reports.write.rows import lookups
from reports.write.tables import markdown, number, step_words
from reports.write.unmeasured import UNMEASURED

SAMPLES = 50  # a revolution


@dataclass(frozen=True)
class PrintedRates(Task):
    """(18.70) and (18.71) under RK45 at a relative tolerance, the absolute one a thousandth of it."""

    revolutions: int
    tolerance: float
    seconds: ClassVar[float] = 0.5
    words: ClassVar[str] = "printed rates over {0.revolutions} revolutions at {0.tolerance:g}"

    def run(self) -> Values:
        """`error`: the largest of beta [rad]; `evaluations` of the rates; `stopped`: why, if before the end."""
        scene = DrivenFourBar()
        t = np.linspace(0, self.revolutions * scene.duration, SAMPLES * self.revolutions + 1)
        beta, _ = scene.four_bar.angles(scene.start + scene.rate * t)
        found = scene.four_bar.integrate_rates(
            t, scene.rate, scene.start, rtol=self.tolerance, atol=self.tolerance * 1e-3
        )
        alive = np.isfinite(found.beta)
        return {
            "error": np.max(np.abs(found.beta - beta)[alive]),
            "evaluations": np.asarray(float(found.evaluations)),
            "stopped": found.stopped or "",
        }


EVERY: tuple[Engine, ...] = (*ALL, Lagrange("rk4", "projection"))
# The first tolerance is the default of solve_ivp.
DRIFTS = tuple(PrintedRates(revolutions, tolerance) for revolutions in (1, 100) for tolerance in (1e-3, 1e-6, 1e-9))


def rates_drift(material: Material) -> list[Observation]:
    """The chapter's pseudocode at several tolerances over 1 and 100 revolutions, against the closed form."""

    def read(answer: Answer) -> str:
        error, count, stopped = number(answer.number("error")), answer.number("evaluations"), answer.values["stopped"]
        return rf"$\beta$ off by {error} rad after {count:.0f} evaluations{f', {stopped}' if stopped else ''}"

    turns = {1: "one revolution", 100: "100 revolutions"}
    settings = [(task, f"{turns[task.revolutions]}, rtol {number(task.tolerance, 1)}") for task in DRIFTS]
    return read_answers(material, "RK45 on the printed rates", settings, read)


def refusal(material: Material) -> list[Observation]:
    """The reference's sentence on a crank that is driven beyond its limit."""
    scene = OverdrivenFourBar()
    return refusals({f"{scene.duration:.3g} s": lambda: scene.motion([scene.duration])})


SWEEPS = tuple(
    replace(pymunk.TUNED, variant=f"tuned, {count} sweep{'s' if count > 1 else ''}", iterations=count, error_bias=0.0)
    for count in (1, 2, 5, 20)
)

# The drive by overwriting with the tuned loop, beside `mujoco.DRIVES`, which has it with the loop as shipped.
OVERWRITTEN = replace(mujoco.TUNED, variant="tuned, overwritten crank", drive="overwrite")

FAILURES = described(
    __file__,
    Failure("Rates without feedback", tasks=DRIFTS, observations=rates_drift),
    Failure(
        "A parallelogram through its change points",
        cells=cells(Parallelogram(), EVERY[:-1], (1, 10, 100)) + cells(Parallelogram(), EVERY[-1:], (1, 10)),
    ),
    Failure("A crank driven into its limit", cells=cells(OverdrivenFourBar(), EVERY, (1, 10)), observations=refusal),
    Failure(
        "Five ways to drive a crank",
        cells=cells(DrivenFourBar(), (mujoco.TUNED, *mujoco.DRIVES, pymunk.TUNED, OVERWRITTEN), (1, 10, 100)),
    ),
    Failure(
        "Steps far too large",
        cells=tuple(cell for samples in (20, 10, 5) for cell in cells(SpinningFourBar(), EVERY, (1,), samples)),
    ),
    Failure("Too few iterations", cells=cells(SpinningFourBar(), SWEEPS, (1, 10, 100))),
    Failure(
        "Worse as the step shrinks", cells=cells(SpinningFourBar(), (mujoco.DEFAULT, mujoco.TUNED), (1, 10, 100, 1000))
    ),
    stops=f"{OverdrivenFourBar().stopping_time:.4f}",
)


SCENES = (DrivenFourBar(), FreeFourBar(), SpinningFourBar())
ADVISED = "free_four_bar"

# The nine poses of Fig. 18.66 stand at the ends of eight equal parts: the last is the first again.
PARTS = 8
SAMPLES_A_PART = 8  # so that the engines' step is about 1e-2 s
OVERLAID = {"pymunk default": ("first", "--"), "mujoco default": ("second", ":")}


# The moving picture of README, over the exact motion, at this many steps between samples: a millisecond.
MOVING_PICTURE = "moving.svg"
MOVING_EVERY = 10
MOVING = {
    "pymunk as shipped": pymunk.DEFAULT,
    "MuJoCo as shipped": mujoco.DEFAULT,
    "MuJoCo with the lines below": mujoco.TUNED,
}
MOVED = tuple(Motion(Cell(FreeFourBar(), engine, MOVING_EVERY, "failure")) for engine in MOVING.values())

POSED = {
    method_name(engine): Cell(DrivenFourBar(), engine, 1, samples=PARTS * SAMPLES_A_PART)
    for engine in ENGINES
    if method_name(engine) in OVERLAID
}


def figures(material: Material) -> dict[str, str]:
    """The nine configurations, with each engine as shipped overlaid where it differs visibly."""
    scene = DrivenFourBar()
    found = material.motions(POSED.values())
    truth = scene.motion(np.arange(PARTS + 1) * scene.duration / PARTS)
    others = {
        f"{name}, step {step_words(cell.step)}": (found[cell].pose[::SAMPLES_A_PART], *OVERLAID[name])
        for name, cell in POSED.items()
        if cell in found
    }
    titles = [f"$t_{i}$ = {t:.3f} s" for i, t in enumerate(truth.t)]
    figure = drawings.configurations(scene.mechanism(), truth.pose, titles, others, columns=5)
    return {"configurations": svg(figure, "The nine configurations of Fig. 18.66, from the closed form")}


def assemblies() -> str:
    """Both positions of the sample's loop at its first crank angle, each with the gap that is left at C."""
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
    """Rows and sweeps by method, for sentences; what MuJoCo's regularisation yields, and how pymunk closes a gap."""
    soft, hard = mujoco.Shipped().impedance, mujoco.TiedToStep().impedance
    before = [
        e.error for e in released().entries if (e.version, e.scene, e.variant) == ("3.6.0", "free_four_bar", "tuned")
    ]
    return {
        **lookups(material, SCENES),
        "assemblies": assemblies(),
        "soft_share": [1 / d - 1 for d in soft[:2]],  # with a closed gap, and with one of a millimetre or more
        "stiff_share": 1 / hard[0] - 1,
        "before_term": before[0] if before else UNMEASURED,  # rad, of the last release without the loops' velocity term
        "closed_in_a_millisecond": 1 - float(pymunk.DEFAULT.error_bias) ** 1e-3,
    }


def compared(scene: Scene, engine: Engine) -> bool:
    """Methods between the variants on the advised scene alone: what each setting buys is the same in all three."""
    return engine in VARIANTS or engine not in ENGINES or scene.name == ADVISED


PAGE = Page(
    name="four_bar",
    title="The four-bar linkage",
    lesson="Three bars and four pins: the loop that the chapter closes exactly and an engine closes by forces.",
    scenes=SCENES,
    advised=ADVISED,
    engines=ENGINES,
    compared=compared,
    failures=FAILURES,
    figures=figures,
    context=context,
    known=deviations("four_bar"),
    tasks=(*map(Motion, POSED.values()), *MOVED),
)
