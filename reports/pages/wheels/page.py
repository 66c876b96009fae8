"""The page of ideal wheels: coasting vehicles, towed wheels and casters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from engines import pymunk
from engines.registry import VARIANTS
from reference.scenes.wheels.trailers import CarWithTrailers, Tow
from reference.scenes.wheels.vehicles import CarAndTrailer, Cart, Casters
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.page import Material, Observation
from reports.model.tasks import Motion, Task, Values
from reports.pages.common import ENGINES_ALONE, described, scene_page, steps_for, to_rounding
from reports.pages.skate.experiments import known
from reports.pages.skate.page import counted
from reports.plots.plane_panels import Blades, Panel, Path, paths
from reports.plots.theme import svg
from reports.write.columns import displayed_variant
from reports.write.experiments import observe_each
from reports.write.unmeasured import UNMEASURED

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Folding(Task):
    """A task with the reference motion of a reversing car with a trailer, which coasts or is driven for `driven`
    [s]."""

    scene: CarAndTrailer
    driven: float

    seconds: ClassVar[float] = 0.1  # measured
    words: ClassVar[str] = "the reference on a reversing trailer"

    def run(self) -> Values:
        """`jackknifed`: time [s] at which the driven car's trailer is bent by a right angle. `t`, `pose`: motion of the
        coasting car."""
        scene = self.scene
        car = CarWithTrailers(scene.wheelbase, (scene.length,), (scene.hitch,))
        convoy = car.drive(scene.speed, scene.steering, scene.pose, (scene.bend,), [self.driven])
        when = np.nan if convoy.jackknifed_at is None else convoy.jackknifed_at
        t = np.linspace(0, scene.duration, scene.samples + 1)
        return {"jackknifed": np.asarray(when), "t": t, "pose": scene.motion(t).pose}


VEHICLE_QUANTITIES = ("position", "angle", "gap", "slip", "energy")

BACKING = CarAndTrailer(speed=-1.0, steering=0.0, bend=0.05, hitch=0.0)
PUSHED_CART = Cart(speed=-1.0, turning_rate=0.0, angles=(0.05, -1e-3))
FOLDED = math.pi / 2  # rad


def crossing(t: np.ndarray, values: np.ndarray, limit: float) -> float | None:
    """The linearly interpolated time at which |values| first exceeds a limit, or None if it never does."""
    over = np.flatnonzero(np.abs(values) > limit)
    if not over.size or over[0] == 0:
        return None
    end = int(over[0])
    low, high = abs(values[end - 1]), abs(values[end])
    return float(t[end - 1] + (t[end] - t[end - 1]) * (limit - low) / (high - low))


# If the car reverses straight at the speed v, the bend b follows b' = (v/L) sin b, and tan(b/2) grows as exp(v t/L).
FOLDS = BACKING.length * math.log(1 / math.tan(BACKING.bend / 2)) / abs(BACKING.speed)  # s.
REFERENCE = Folding(BACKING, FOLDS + 1)
RUNS = tuple(Cell(BACKING, engine, every) for engine in ENGINES_ALONE for every in steps_for(engine, (1, 10)))


def folding(material: Material) -> list[Observation]:
    """The time at which the trailer is bent by a right angle, from a closed form, from kinematics, and in engines."""
    bent = float(Tow(BACKING.length, BACKING.bend).relative_angle(-FOLDS * abs(BACKING.speed)))
    observations = [Observation("closed form, at a constant speed", "", f"{FOLDS:.4f} s")]
    reference = material.finished(REFERENCE)
    if reference:
        driven = f"{reference.number('jackknifed'):.4f} s"
        observations.append(Observation("the reference, driven at a constant speed", "", driven))
    observations.append(Observation("the drawbar, pushed along this distance", "", f"bent by {bent:.4f} rad"))
    if answer := material.answers.get(REFERENCE):
        coasting = _folded(answer.array("t"), answer.array("pose")) if reference else answer.told
        observations.append(Observation("the reference, coasting", "", coasting))
    return [*observations, *observe_each(material, RUNS, lambda cell, run: _folded(run.t, run.pose))]


def lateness(material: Material) -> dict[str, Any]:
    """`late`: the delays [s] of the folding in the naive method at two steps; the larger step is first."""
    truth = material.finished(REFERENCE)
    exact = crossing(truth.array("t"), bend_of(truth.array("pose")), FOLDED) if truth else None
    motions = material.motions(cell for cell in RUNS if cell.engine == pymunk.DEFAULT)
    folds = [crossing(run.t, bend_of(run.pose), FOLDED) for run in motions.values()]
    late = [when - exact for when in folds if when is not None and exact is not None]
    return {"late": late if len(late) == 2 else UNMEASURED}


def bend_of(pose: np.ndarray) -> np.ndarray:
    """The trailer's angle relative to the car (times,) [rad]."""
    return pose[:, 1, 2] - pose[:, 0, 2]


def _folded(t: np.ndarray, pose: np.ndarray) -> str:
    bend = bend_of(pose)
    when = crossing(t, bend, FOLDED)
    return f"{when:.4f} s" if when is not None else f"never folds: bent by at most {np.abs(bend).max():.3f} rad"


FORCE_QUANTITIES = ("position", "slip", "energy", "reaction")
CAR, CART = CarAndTrailer(redundant=True), Cart(redundant=True)


DRAWBAR = 1.0  # m.
RADII = (1.6, 1.0, 0.6)  # m; radii of the hitch's circles.
DRAWBARS = 7


def tows() -> Figure:
    """A wheel that is towed along a straight line and round circles with radii larger than, equal to and below
    DRAWBAR."""
    panels = [_tow("straight: the tractrix", math.inf, 4 * DRAWBAR)]
    for radius, sign in zip(RADII, (">", "=", "<"), strict=True):
        panels.append(_tow(f"R {sign} L", radius, 2.5 * 2 * math.pi * radius))
    return paths(panels, columns=4)


def _tow(title: str, radius: float, distance: float) -> Panel:
    tow = Tow(DRAWBAR, math.pi / 2, radius)
    along, stops = np.linspace(0, distance, 800), np.linspace(0, min(distance, 4 * DRAWBAR), DRAWBARS)
    once = along if math.isinf(radius) else np.linspace(0, 2 * math.pi * radius, 200)
    drawbars = np.column_stack([0.5 * (tow.hitch(stops) + tow.wheel(stops)), tow.heading(stops)])
    lines = [
        Path(tow.hitch(once), "hitch", "quiet", "--", 1.2),
        Path(tow.wheel(along), "towed wheel", "second", "-", 1.8, dot=True),
    ]
    return Panel(title, lines, [Blades(drawbars, DRAWBAR, "quiet", 0.9, "drawbar")])


def casters() -> Figure:
    """The casters of a cart trail behind when it moves ahead, and swing round when it is pushed back."""
    cart = Casters(((0.7, 0.2), (0.7, -0.2)), 0.1)
    # distance from the fixed axle to the kingpins
    corners = np.array([[0.0, 0.2], *cart.places, [0.0, -0.2], [0.0, 0.2]])
    t = np.linspace(0, 2, 801)
    panels = []
    for title, speed, start in (
        ("going ahead at 0.5 m/s", 0.5, (2.5, -0.8)),
        ("pushed back, from 0.05 and -0.001 rad", -0.5, (0.05, -0.001)),
    ):
        angles, _ = cart.swing(start, speed, 0.0, t)
        lines = [Path(corners + np.array([speed * t[-1], 0.0]), "cart, at the end", "ink", "-", 1.2)]
        curves = []
        for index, (side, colour, dashes) in enumerate((("left", "second", "-"), ("right", "first", "--"))):
            x, y = cart.places[index]
            place, angle = np.column_stack([x + speed * t, np.full_like(t, y)]), angles[:, index]
            wheel = place - cart.trail * np.column_stack([np.cos(angle), np.sin(angle)])
            name = f"{side} caster's wheel"
            lines += [Path(place, "kingpins", "quiet", ":", 1.0), Path(wheel, name, colour, dashes, 1.8, dot=True)]
            curves.append(Path(np.column_stack([t, angle]), name, colour, dashes))
        curves += [Path(np.column_stack([t, 0 * t + level]), "", "quiet", ":", 1.0) for level in (-math.pi, 0, math.pi)]
        panels.append(Panel(title, lines))
        panels.append(Panel("angles against the cart [rad]", curves, plane=False, x_label="time [s]"))
    return paths(panels, columns=2, height=1.9)


def reversing() -> Figure:
    """A car that reverses straight with a slightly bent trailer, until the trailer folds."""
    car = CarWithTrailers(1.0, (0.8,), (0.2,))
    t = np.linspace(0, 3.2, 321)
    panels = []
    for bend in (0.05, 0.5):
        convoy, title = car.drive(-1.0, 0.0, (0.0, 0.0, 0.0), (bend,), t), f"bent by {bend:g} rad"
        if convoy.jackknifed_at is not None:
            title += f": folded beyond a right angle at {convoy.jackknifed_at:.3f} s"
        back, trailer = convoy.pose[::40, 0], convoy.pose[::40, 1]
        bodies, drawbars = (
            pose + length * np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2]), 0 * pose[:, 2]], axis=-1)
            for pose, length in ((back, 0.5), (trailer, 0.4))
        )
        lines = [
            Path(convoy.pose[:, 0, :2], "car's rear axle", "quiet", "--", 1.2),
            Path(convoy.pose[:, 1, :2], "trailer's axle", "second", "-", 1.8, dot=True),
        ]
        blades = [Blades(bodies, 1.0, "grid", 4.0, "car"), Blades(drawbars, 0.8, "first", 1.6, "drawbar")]
        panels.append(Panel(title, lines, blades))
    return paths(panels, columns=2)


VEHICLES = (CarAndTrailer(), Cart())

VEHICLE_METHODS: dict[str, tuple[str, Any]] = {
    "pymunk default": ("first", "--"),
    "pymunk tuned": ("first", "-"),
    "mujoco default": ("second", "--"),
    "mujoco tuned": ("second", ":"),
}


COASTING_VEHICLES = tuple(
    (title, scene, {name: Cell(scene, engine, 1) for name, engine in known(VEHICLE_METHODS).items()})
    for title, scene in (
        ("car and trailer, 5 s, steps of 10 ms", CarAndTrailer()),
        ("cart with two casters, 3 s", Cart()),
    )
)


def coasting(material: Material) -> Figure:
    """The paths of the bodies of both vehicles in the reference motion and in several methods."""
    panels = []
    for title, scene, cells in COASTING_VEHICLES:
        truth = scene.motion(np.linspace(0, scene.duration, scene.samples + 1))
        motions = material.motions(cells.values())
        lines = [Path(pose, "exact", "ink", "-", 3.0) for pose in _of_bodies(truth)]
        for name, cell in cells.items():
            if cell in motions:
                label = f"{cell.engine.name} {displayed_variant(scene, cell.engine)}"
                style = (label, *VEHICLE_METHODS[name], 1.5)
                lines += [Path(pose, *style, framed=False, dot=True) for pose in _of_bodies(motions[cell])]
        panels.append(Panel(title, lines))
    return paths(panels, columns=2)


def _of_bodies(motion: Trajectory) -> np.ndarray:
    return motion.pose[:, :, :2].swapaxes(0, 1)


def figures(material: Material) -> dict[str, str]:
    return {
        "coasting": svg(coasting(material), "Paths of the centres of mass: exact, and in several methods"),
        "tows": svg(tows(), "A towed wheel: the tractrix, and tows round circles"),
        "casters": svg(casters(), "Casters that trail, and that swing round"),
        "reversing": svg(reversing(), "A reversing trailer folds"),
    }


def context(material: Material) -> Mapping[str, Any]:
    scenes = (*VEHICLES, CAR, CART)
    doubled = ("car_and_trailer, both wheels of each axle", "cart, both wheels of the fixed axle")
    return {"counted": counted(scenes, (*(scene.name for scene in VEHICLES), *doubled))}


PAGE = scene_page(
    "wheels",
    title="Ideal wheels",
    lesson="Cars, trailers and carts consist of pins and skates. Here they coast in the ways that their wheels allow.",
    scenes=VEHICLES,
    engines=VARIANTS,
    failures=described(
        __file__,
        to_rounding(
            "A reversing trailer jack-knifes",
            *(BACKING, (1, 10), VEHICLE_QUANTITIES),
            tasks=(REFERENCE, *map(Motion, RUNS)),
            observations=folding,
            context=lateness,
        ),
        to_rounding("Casters swing round when the cart is pushed back", PUSHED_CART, (1, 10), VEHICLE_QUANTITIES),
        to_rounding("Both wheels of every axle: the car and its trailer", CAR, (1, 10), FORCE_QUANTITIES),
        to_rounding("Both wheels of the fixed axle: the cart", CART, (1, 10), FORCE_QUANTITIES),
    ),
    quantity="position",
    figures=figures,
    context=context,
    tasks=tuple(Motion(cell) for _, _, cells in COASTING_VEHICLES for cell in cells.values()),
)
