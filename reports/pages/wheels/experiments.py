"""Where vehicles on ideal wheels go wrong: reversing, casters that swing round, and a wheel too many."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from engines import pymunk
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart
from reference.scenes.wheels.tractrix import Tow
from reference.scenes.wheels.trailers import CarWithTrailers
from reports.model.cells import Cell
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Motion, Task, Values
from reports.pages.common import ENGINES_ALONE, cells_to_rounding, steps_for
from reports.write.experiments import observe
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED


@dataclass(frozen=True)
class Folding(Task):
    """A car with a trailer that starts backwards; driven it is looked at for `driven` [s]."""

    scene: CarAndTrailer
    driven: float

    @property
    def cost(self) -> float:
        return 0.1  # measured

    @property
    def label(self) -> str:
        return "the reference on a reversing trailer"

    def run(self) -> Values:
        """`jackknifed` [s]: when the trailer is square to the driven car; `t`, `pose`: of the truth, coasting."""
        scene = self.scene
        car = CarWithTrailers(scene.wheelbase, (scene.length,), (scene.hitch,))
        convoy = car.drive(scene.speed, scene.steering, scene.pose, (scene.bend,), [self.driven])
        when = np.nan if convoy.jackknifed_at is None else convoy.jackknifed_at
        t = np.linspace(0, scene.duration, scene.samples + 1)
        return {"jackknifed": np.asarray(when), "t": t, "pose": scene.motion(t).pose}


MOTION = ("position", "angle", "gap", "slip", "energy")

BACKING = CarAndTrailer(speed=-1.0, steering=0.0, bend=0.05, hitch=0.0)
PUSHED = Cart(speed=-1.0, turning_rate=0.0, angles=(0.05, -1e-3))
FOLDED = math.pi / 2  # rad


def crossing(t: np.ndarray, values: np.ndarray, limit: float) -> float | None:
    """When |values| first passes a limit, linear between samples; None if it never does."""
    over = np.flatnonzero(np.abs(values) > limit)
    if not over.size or over[0] == 0:
        return None
    late = int(over[0])
    before, after = abs(values[late - 1]), abs(values[late])
    return float(t[late - 1] + (t[late] - t[late - 1]) * (limit - before) / (after - before))


# Straight back the bend b obeys b' = (v/L) sin b: tan(b/2) grows as exp(v t/L).
FOLDS = BACKING.length * math.log(1 / math.tan(BACKING.bend / 2)) / abs(BACKING.speed)  # s
REFERENCE = Folding(BACKING, FOLDS + 1)
RUNS = tuple(Cell(BACKING, engine, every) for engine in ENGINES_ALONE for every in steps_for(engine, (1, 10)))


def folding(material: Material) -> list[Observation]:
    """When the reversing trailer is bent beyond a right angle: closed form, kinematics, and methods that coast."""
    bent = float(Tow(BACKING.length, BACKING.bend).relative_angle(-FOLDS * abs(BACKING.speed)))
    found = [Observation("closed form, at an even speed", "", f"{FOLDS:.4f} s")]
    pushed = Observation("the drawbar pushed along by that way", "", f"bent by {bent:.4f} rad")
    driven, coasting = "the reference, driven at an even speed", "the reference, coasting"
    answer = material.answers.get(REFERENCE)
    if answer is None:
        found.append(pushed)
    elif answer.finished:
        found.append(Observation(driven, "", f"{answer.number('jackknifed'):.4f} s"))
        found.append(pushed)
        found.append(Observation(coasting, "", _folded(answer.array("t"), answer.array("pose"))))
    else:
        found += [pushed, Observation(coasting, "", answer.told)]
    for cell in RUNS:
        found += observe(material, cell, f"step {number(cell.step)} s", lambda run: _folded(run.t, run.pose))
    return found


def lateness(material: Material) -> dict[str, Any]:
    """`late` [s]: how much later than in the truth the trailer folds with the naive zeroing, larger step first."""
    truth = material.finished(REFERENCE)
    exact = crossing(truth.array("t"), bend_of(truth.array("pose")), FOLDED) if truth else None
    motions = material.motions(cell for cell in RUNS if cell.engine == pymunk.DEFAULT)
    folds = [crossing(run.t, bend_of(run.pose), FOLDED) for run in motions.values()]
    late = [when - exact for when in folds if when is not None and exact is not None]
    return {"late": late if len(late) == 2 else UNMEASURED}


def bend_of(pose: np.ndarray) -> np.ndarray:
    """The trailer's angle against the car (times,) [rad]."""
    return pose[:, 1, 2] - pose[:, 0, 2]


def _folded(t: np.ndarray, pose: np.ndarray) -> str:
    bend = bend_of(pose)
    when = crossing(t, bend, FOLDED)
    return f"{when:.4f} s" if when is not None else f"never folds: bent by at most {np.abs(bend).max():.3f} rad"


FAILURES: tuple[Failure, ...] = (
    Failure(
        title="A reversing trailer jack-knifes",
        expected=(
            f"A car that backs straight from a bend of {BACKING.bend:g} rad: the bend grows as $e^{{v t / L}}$, at "
            f"{abs(BACKING.speed) / BACKING.length:g} per second, and passes a right angle. A coasting car slows down "
            "by what it gives to the trailer."
        ),
        cells=cells_to_rounding(BACKING, ENGINES_ALONE, (1, 10)),
        columns=MOTION,
        tasks=(REFERENCE, *map(Motion, RUNS)),
        observations=folding,
        words=lateness,
        remark=(
            "Ideal wheels go on through the fold; real bodies would touch. The naive zeroing (`pymunk naive`, "
            "a user's trick and no part of pymunk) computes another vehicle: its trailer folds late{% filter "
            "if_measured %}, by {{ late[0] | number }} s at the larger step and {{ late[1] | number }} s at the "
            "smaller{% endfilter %}."
        ),
    ),
    Failure(
        title="Casters swing round when the cart is pushed back",
        expected=(
            "A caster that stands straight behind its kingpin is unstable as soon as the cart goes back, and swings "
            "round by half a turn: the left one first, which stood less straight."
        ),
        cells=cells_to_rounding(PUSHED, ENGINES_ALONE, (1, 10)),
        columns=MOTION,
    ),
    Failure(
        title="Both wheels of every axle: the car and its trailer",
        expected=(
            "The two wheels of an axle stop the same motion, so the second one changes only the number of rows. How "
            "the two share the force is not determined; the reference gives each half."
        ),
        cells=cells_to_rounding(CarAndTrailer(redundant=True), ENGINES_ALONE, (1, 10)),
        columns=("position", "slip", "energy", "reaction"),
        remark=(
            "Compare with the same vehicle with one row an axle, in the tables above: each method has the same "
            "position error as there, apart from rounding. That holds for MuJoCo's soft default friction too. The "
            "errors of the forces differ more than those of the motion."
        ),
    ),
    Failure(
        title="Both wheels of the fixed axle: the cart",
        expected="As above: one row would do.",
        cells=cells_to_rounding(Cart(redundant=True), ENGINES_ALONE, (1, 10)),
        columns=("position", "slip", "energy", "reaction"),
    ),
)
