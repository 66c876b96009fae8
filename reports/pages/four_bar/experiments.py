"""Where methods fail on the four-bar: experiments with a statement of what should happen."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from engines import Engine, mujoco, pymunk
from engines.lagrange import Lagrange
from reference.scenes.four_bar.scenes import DrivenFourBar, OverdrivenFourBar, Parallelogram, SpinningFourBar
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Task, Values
from reports.pages.common import ALL, cells
from reports.write.tables import number

SAMPLES = 50  # a revolution
EVALUATION = 10e-6  # s


@dataclass(frozen=True)
class PrintedRates(Task):
    """(18.70) and (18.71) under RK45 at a relative tolerance, the absolute one a thousandth of it."""

    revolutions: int
    tolerance: float

    @property
    def cost(self) -> float:
        # About a hundred evaluations a revolution at 1e-3; a method of order 5 takes steps as the fifth root.
        return self.revolutions * 100 * (1e-3 / self.tolerance) ** 0.2 * EVALUATION

    @property
    def label(self) -> str:
        return f"printed rates over {self.revolutions} revolutions at {self.tolerance:g}"

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
RATE_TOLERANCE = 1e-3  # what solve_ivp takes when nobody says otherwise


DRIFTS = tuple(
    PrintedRates(revolutions, tolerance) for revolutions in (1, 100) for tolerance in (RATE_TOLERANCE, 1e-6, 1e-9)
)


def rates_drift(material: Material) -> list[Observation]:
    """The chapter's pseudocode at several tolerances over 1 and 100 revolutions, against the closed form."""
    found = []
    for task in DRIFTS:
        if (answer := material.answers.get(task)) is None:
            continue
        told = answer.told
        if answer.finished:
            stopped = f", {answer.values['stopped']}" if answer.values["stopped"] else ""
            told = (
                rf"$\beta$ off by {number(answer.number('error'))} rad after {answer.number('evaluations'):.0f} "
                f"evaluations{stopped}"
            )
        turns = "one revolution" if task.revolutions == 1 else f"{task.revolutions} revolutions"
        found.append(Observation("RK45 on the printed rates", f"{turns}, rtol {number(task.tolerance, 1)}", told))
    return found


def _refusal(material: Material) -> list[Observation]:
    scene = OverdrivenFourBar()
    try:
        scene.motion([scene.duration])
    except ValueError as sentence:
        return [Observation("the reference", f"{scene.duration:.3g} s", f"refuses: {sentence}")]
    raise AssertionError("a crank was driven beyond its limit and the reference went along")


SWEEPS = tuple(
    replace(pymunk.TUNED, variant=f"tuned, {count} sweep{'s' if count > 1 else ''}", iterations=count, error_bias=0.0)
    for count in (1, 2, 5, 20)
)

# The drive by overwriting with the tuned loop, beside `mujoco.DRIVES`, which has it with the loop as shipped.
OVERWRITTEN = replace(mujoco.TUNED, variant="tuned, overwritten crank", drive="overwrite")

FAILURES: tuple[Failure, ...] = (
    Failure(
        title="Rates without feedback",
        expected="The angles follow the closed form; only the rates were integrated, so nothing closes the loop again.",
        tasks=DRIFTS,
        observations=rates_drift,
        remark=(
            "A linkage is a position constraint. An integration of (18.70) and (18.71) keeps every error that was ever "
            "made, and makes the same errors again in every revolution. A smaller tolerance only delays the drift. A "
            "closed form, or a projection onto closed positions, removes it."
        ),
    ),
    Failure(
        title="A parallelogram through its change points",
        expected=(
            "Twice a revolution all four bars lie in line. There the loop closes in two ways, parallel and crossed, "
            "and the rows lose rank. Only the inertia of the bars decides which way the motion goes on: parallel."
        ),
        cells=cells(Parallelogram(), EVERY[:-1], (1, 10, 100)) + cells(Parallelogram(), EVERY[-1:], (1, 10)),
        remark=(
            "Methods differ here. pymunk, as shipped and tuned, and exact multipliers get through at each step. The "
            "errors of pymunk fall by a factor of five or more from step to step. MuJoCo as shipped gets through as "
            "well, and its softness leaves the same error at each step. MuJoCo tuned and extended start anew at one "
            "step and are accurate at the others: it depends on where the samples fall. The extended variant of pymunk "
            "needs an error that is smooth in the step. At the largest step it says that its error is not resolved."
        ),
    ),
    Failure(
        title="A crank driven into its limit",
        expected=(
            f"The bars of this triple-rocker can follow the crank for {OverdrivenFourBar().stopping_time:.4f} s. After "
            "that no position closes the loop; the reference refuses."
        ),
        cells=cells(OverdrivenFourBar(), EVERY, (1, 10)),
        observations=_refusal,
        remark=(
            "No engine says that the task is impossible. The loop is torn, usually without a warning, or the engine "
            "starts anew by itself. Look at the largest gap over the whole run: a torn loop may close again, on either "
            "branch."
        ),
    ),
    Failure(
        title="Five ways to drive a crank",
        expected="The crank turns at 10 rad/s exactly, and the other bars follow: there is nothing to be simulated.",
        cells=cells(DrivenFourBar(), (mujoco.TUNED, *mujoco.DRIVES, pymunk.TUNED, OVERWRITTEN), (1, 10, 100)),
        remark=(
            "The common trick is to overwrite the crank's state after every step. The solver still computes as if the "
            "loop's forces accelerated the crank, so it finds wrong forces. With the loop as shipped the error does "
            "not fall with the step. With the tuned loop, whose spring is tied to the step, the largest step tears the "
            "loop, and the error falls from there. But it is far larger than with a crank that nothing can accelerate. "
            "A servo lags behind by torque over gain, at every step. For a prescribed rate take a kinematic body, or "
            "an armature that nothing can accelerate."
        ),
    ),
    Failure(
        title="Steps far too large",
        expected=(
            "At 10 rad/s the crank turns by a radian in a step of 0.1 s. No method is accurate here; an engine could "
            "warn."
        ),
        cells=tuple(cell for samples in (20, 10, 5) for cell in cells(SpinningFourBar(), EVERY, (1,), samples)),
        remark=(
            'A finite number is not an answer{% filter if_measured %}: {{ count("torn") }} of these {{ count() }} runs '
            "end with finite numbers, on a loop that is torn{% endfilter %}, and no engine says so."
        ),
    ),
    Failure(
        title="Too few iterations",
        expected="Sweeps over the joints should go on until these agree. What they leave is closed in the next step.",
        cells=cells(SpinningFourBar(), SWEEPS, (1, 10, 100)),
        remark=(
            "Where the whole gap is closed in every step, the speed of the correction is the gap over the step. So "
            "what the sweeps leave grows as the step shrinks: two sweeps are enough at 1 ms, and tear the loop at "
            "0.1 ms."
        ),
    ),
    Failure(
        title="Worse as the step shrinks",
        expected="Each step a tenth of the last: an error of first order should fall tenfold every time.",
        cells=cells(SpinningFourBar(), (mujoco.DEFAULT, mujoco.TUNED), (1, 10, 100, 1000)),
        remark=(
            "MuJoCo as shipped has two errors here: Euler's, which falls with the step, and that of a soft loop, "
            "which does not. At 1 ms they happen to cancel, so a user who takes a smaller step sees the answer "
            'become worse{% filter if_measured %}: {{ at("mujoco default", 1e-3).angle | number }} rad there, '
            '{{ at("mujoco default", 1e-4).angle | number }} rad at a tenth of that step{% endfilter %}. The smaller '
            "error was luck; the plateau is the model."
        ),
    ),
)
