"""What the page of engines tells of: rows of other pages, compiled models at one step, and the gap that stays open."""

from __future__ import annotations

from dataclasses import dataclass

from engines import Engine, registry
from engines.box2d import Box2D
from engines.bullet import Bullet
from engines.pymunk.contraction import Sweeping
from engines.pymunk.engine import SHIPPED_ERROR_BIAS, Pymunk
from engines.pymunk.model import Model
from reference.four_bar.scenes import FreeFourBar
from reference.mechanism import Mechanism
from reference.scene import Scene
from reference.scenes import SCENES
from reports.grid.cells import FULL, SLOW_TO_BUILD, Cell, beside_cells, sweep_cells

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
    if getattr(engine, "building", 0.0) >= SLOW_TO_BUILD
)
BORROWED = (*sweep_cells(CHARTED_SCENES, registry.VARIANTS, FULL), *beside_cells(CHARTED_SCENES, registry.OTHERS))

# The share of a gap that is closed in a step of a millisecond; the second is about pymunk's as shipped.
SHARES = (0.002, 1 - SHIPPED_ERROR_BIAS**1e-3, 0.02, 0.06, 0.2, 0.6, 1.0)
SUBSTEPS = (1, 4, 16, 64, 256)
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
CLOSED_BY = tuple(cell for cells in CLOSING.values() for cell in cells.values())
