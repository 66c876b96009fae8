"""What the page of engines tells of: rows of other pages, compiled models at one step, and the gap that stays open."""

from __future__ import annotations

from dataclasses import dataclass

from engines import Engine, registry
from engines.box2d import Box2D
from engines.bullet import Bullet
from engines.mujoco.engine import MuJoCo
from engines.mujoco.stiffness import TiedToStep
from engines.pinocchio import Pinocchio
from engines.pymunk.contraction import Sweeping
from engines.pymunk.engine import SHIPPED_ERROR_BIAS, Pymunk
from engines.pymunk.model import Model
from reference.mechanism import Mechanism
from reference.scene import Scene
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model.cells import FULL, SLOW_TO_BUILD, Cell, beside_cells, sweep_cells

FREE = FreeFourBar()
MILLISECOND = round(FREE.spacing / 1e-3)  # steps between samples

# A scene of every mechanism, by the quantity that its own page compares.
CHARTED = {
    "angle": (
        "free_four_bar",
        "driven_slider_crank",
        "pendulum_2",
        "pendulum_10",
        "n_four_bar_2",
        "person_two_feet",
        "rolling_disc",
    ),
    "position": ("sleigh", "cart"),
}
BY_NAME: dict[str, Scene] = {scene.name: scene for scene in SCENES}
CHARTED_SCENES = tuple(BY_NAME[name] for names in CHARTED.values() for name in names)

# A model that is compiled for tens of seconds is run at one step of two scenes: one with a loop, one without.
COMPILED = tuple(
    Cell(BY_NAME[name], engine, MILLISECOND, "beside")
    for name in ("free_four_bar", "pendulum_2")
    for engine in registry.OTHERS
    if engine.building >= SLOW_TO_BUILD
)
BORROWED = sweep_cells(CHARTED_SCENES, registry.VARIANTS, FULL)
SWEPT = beside_cells(CHARTED_SCENES, registry.OTHERS, sweep=True)

# The share of a gap that is closed in a step of a millisecond; the second is about pymunk's as shipped.
SHARES = (0.002, 1 - SHIPPED_ERROR_BIAS**1e-3, 0.02, 0.06, 0.2, 0.6, 1.0)
SUBSTEPS = (1, 4, 16, 64, 256)
# Box2D's pins at a frequency of their own, times the length of a sub-step; 0 as shipped, and as many sub-steps.
FREQUENCIES = (0.0, 0.02, 0.05, 0.1, 0.25)
FEW = (1, 4)
CORRECTIONS = (0.0, 10.0, 100.0, 300.0)  # 1/s; explicit steps of a millisecond bear no more than about 500
OPEN = ("A", "B", "C", "D")


@dataclass(frozen=True)
class SomePins(Pymunk):
    """All gaps are closed in every step but those of the pins named `shipped`, which are closed as shipped."""

    shipped: tuple[str, ...] = ()

    def swept_model(self, mechanism: Mechanism, dt: float, sweeping: Sweeping) -> Model:
        """Pins stand in the space in the order of the joints, where nothing is driven."""
        model = super().swept_model(mechanism, dt, sweeping)
        for joint, constraint in zip(mechanism.joints, model.space.constraints, strict=True):
            if joint.name in self.shipped:
                constraint.error_bias = SHIPPED_ERROR_BIAS
        return model


def _cell(engine: Engine) -> Cell:
    return Cell(FREE, engine, MILLISECOND, "failure")


# By engine: the share that a setting closes in a step, and the cell.
CLOSING: dict[str, dict[float, Cell]] = {
    "pymunk, all four pins": {
        share: _cell(Pymunk(f"closes {share:.2g} of a gap", 30, (1 - share) ** 1000)) for share in SHARES
    },
    "bullet, the pin of the loop": {
        share: _cell(Bullet(f"closes {share:.2g} of a gap", 200, 0.0, share)) for share in SHARES
    },
}
SUBSTEPPED = {count: _cell(Box2D(f"{count} sub-steps", count)) for count in SUBSTEPS}
PINS = {
    name: _cell(SomePins(f"gap left at {name or 'none'}", 30, 0.0, shipped=tuple(name))) for name in ("", *OPEN, "ABCD")
}
CLOSED_AT = {
    (count, share): _cell(Box2D(f"{count} sub-steps, pins of {share:g} a sub-step", count, share))
    for count in FEW
    for share in FREQUENCIES[1:]
} | {(count, 0.0): SUBSTEPPED[count] for count in FEW}
CORRECTED = {
    (integrator, rate): _cell(Pinocchio(f"{integrator}, correction {rate:g}", integrator, rate))
    for integrator in ("euler", "rk4")
    for rate in CORRECTIONS
}
# All pins as springs of some steps, and only that of the loop.
SPRUNG = {
    (coordinates, steps): _cell(
        MuJoCo(
            f"{coordinates} coordinates, springs of {steps:g} steps",
            stiffness=TiedToStep(steps),
            coordinates=coordinates,
        )
    )
    for coordinates in ("free", "tree")
    for steps in (20.0, 2.0)
}
# What moves each engine from one family to the other: in words, as it was, and with one setting turned.
MOVES: tuple[tuple[str, str, Cell, Cell], ...] = (
    (
        "pymunk",
        "share of a gap that a step closes",
        CLOSING["pymunk, all four pins"][SHARES[1]],
        CLOSING["pymunk, all four pins"][1.0],
    ),
    ("box2d", "frequency of the pins", CLOSED_AT[4, 0.0], CLOSED_AT[4, 0.25]),
    (
        "mujoco, pins that are all springs",
        "their time constant, 20 steps and 2",
        SPRUNG["free", 20.0],
        SPRUNG["free", 2.0],
    ),
    ("mujoco, the loop's pin alone", "its time constant, 20 steps and 2", SPRUNG["tree", 20.0], SPRUNG["tree", 2.0]),
    (
        "bullet, the loop's pin alone",
        "share of a gap that a step closes",
        CLOSING["bullet, the pin of the loop"][SHARES[0]],
        CLOSING["bullet, the pin of the loop"][1.0],
    ),
    (
        "pinocchio, Euler steps, the loop's pin alone",
        "correction of the loop, none and 300 / s",
        CORRECTED["euler", 0.0],
        CORRECTED["euler", 300.0],
    ),
)
CLOSED_BY = tuple(cell for cells in CLOSING.values() for cell in cells.values())
