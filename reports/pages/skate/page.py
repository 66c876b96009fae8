"""The page of the skate: comparison of constructions on the sleigh, and theory."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from engines import ConvergenceOrder, Engine
from engines.registry import VARIANTS
from reference.chapter import skates as theory
from reference.chapter.integrability import freedoms_by_brackets, mechanism_is_integrable
from reference.joints import Triple
from reference.scene import Scene
from reference.scenes.skates import ChaplyginSleigh, FreelyPinnedBody, PinnedBody, SkateOnSlope, SleighBackwards
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.convergence import by_method, groups, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, usual_series
from reports.model.tasks import Motion
from reports.pages.common import scene_page
from reports.pages.skate.experiments import SKATE_CONSTRUCTIONS, SKATE_EXPERIMENTS, known
from reports.plots.plane_panels import Blades, Panel, PanelNote, Path, paths
from reports.plots.theme import svg
from reports.write import row_tables, tables
from reports.write.columns import enforcement_by_method
from reports.write.page_tables import COMPARED_STEP
from reports.write.rows import Rows

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLADE_LENGTH = 0.35  # m
PARKED: Triple = (0.0, 1.0, 0.0)


def parking() -> Figure:
    """Manoeuvres that move a skate sideways, and a commutator's displacement against the size of its moves."""
    start: Triple = (0.0, 0.0, 0.0)
    panels = [
        _manoeuvre("turn, slide, turn", start, theory.park(start, PARKED)),
        _manoeuvre("sidestep, at most 0.6 rad", start, theory.sidestep(PARKED[1], 0.5, 0.6)),
        _manoeuvre("the commutator: 0.8 rad, 1 m", start, theory.commutator(0.8, 1.0)),
    ]
    sizes = np.geomspace(1.0, 1e-3, 60)
    moved = theory.commutator_displacement(sizes, sizes) / sizes[:, None] ** 2
    sideways = Path(np.column_stack([sizes, moved[:, 1]]), "sideways, towards 1", "third")
    along = Path(np.column_stack([sizes, moved[:, 0]]), "along, towards 0", "first", "--")
    title, across = "displacement of a commutator / product of its moves", "size of both moves [rad, m]"
    panels.append(Panel(title, [sideways, along], plane=False, x_label=across, logarithmic_across=True))
    return paths(panels, columns=2, height=2.6)


def _manoeuvre(title: str, start: Triple, moves: tuple[theory.Move, ...]) -> Panel:
    path, poses = theory.trace(start, moves), theory.stops(start, moves)
    blades = [Blades(poses[1:-1], BLADE_LENGTH, "quiet", 1.6), Blades(poses[[0, -1]], BLADE_LENGTH, "ink", 3.4)]
    (x, y), (end_x, end_y) = poses[0][:2], poses[-1][:2]
    notes = [PanelNote((x, y - 0.16), "from", "center"), PanelNote((end_x, end_y + 0.16), "to", "center")]
    return Panel(title, [Path(path[:, :2], "path of C", "second", "-", 1.6)], blades, notes)


def slope() -> Figure:
    """An ideal skate that turns on a slope and moves across it on cycloids."""
    panels, label = [], "path of C; the slope descends downwards"
    for title, scene in (
        ("turning at 1 rad/s from rest, blade across the slope", SkateOnSlope(turning_rate=1.0)),
        ("the same with a push of 0.5 m/s", SkateOnSlope(turning_rate=1.0, speed=0.5)),
    ):
        poses = scene.motion(np.linspace(0, 2 * math.pi, 721)).pose[:, 0]
        line = Path(poses[:, :2], label, "second", "-", 1.6, dot=True)
        panels.append(Panel(title, [line], [Blades(poses[::60], BLADE_LENGTH, "ink", 2.2)]))
    return paths(panels, columns=2)


SKATE_SCENES = (ChaplyginSleigh(), SleighBackwards(), PinnedBody(), FreelyPinnedBody())
SLEIGH_AHEAD = ChaplyginSleigh()

BLADES = 7  # Blades drawn along a path.
# Methods with visible errors, with the colour and the dashes of their paths.
DRAWN_PATHS: dict[str, tuple[str, Any]] = {
    "pymunk skate: centre's velocity zeroed": ("first", "--"),
    "pymunk skate: point's velocity zeroed": ("first", ":"),
    "pymunk tuned": ("first", "-"),
    "mujoco default": ("second", "--"),
    "mujoco tuned": ("second", ":"),
}
# Methods in the table in addition to the usual variants. "pymunk naive" sets the centre's velocity across the blade to
# zero.
LISTED = ("pymunk naive", "pymunk skate: groove, extrapolated", "pymunk skate: point's velocity zeroed")
LISTED += ("mujoco friction blade",)


def compared(scene: Scene, engine: Engine) -> bool:
    """Whether a method is run in a scene. Constructions of a skate are run only on the sleigh that moves ahead."""
    return scene == SLEIGH_AHEAD or engine not in SKATE_CONSTRUCTIONS


def skate_path(scene: ChaplyginSleigh, trajectory: Trajectory) -> np.ndarray:
    """Poses (times, 3) of the skate in a motion of the sleigh."""
    pose = trajectory.pose[:, 0]
    arm = np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2]), np.zeros(len(pose))], axis=-1)
    return pose - scene.offset * arm


PATHS = tuple(
    (title, scene, {name: Cell(scene, engine, 1) for name, engine in known(DRAWN_PATHS).items()})
    for title, scene in (
        ("ahead for 3 s, steps of 10 ms", SLEIGH_AHEAD),
        ("backwards for 10 s: it turns round", SleighBackwards()),
    )
)


def path_picture(material: Material) -> Figure:
    """The skate's path in the reference motion and in several methods, ahead and backwards."""
    panels = []
    for title, scene, cells in PATHS:
        motions = material.motions(cells.values())
        truth = scene.skate_pose(np.linspace(0, scene.duration, scene.samples + 1))
        lines = [Path(truth[:, :2], "exact", "ink", "-", 3.0)]
        for name, cell in cells.items():
            if cell in motions:
                colour, dashes = DRAWN_PATHS[name]
                points = skate_path(scene, motions[cell])[:, :2]
                lines.append(Path(points, name, colour, dashes, 1.6, framed=False, dot=True))
        drawn = truth[:: max(1, scene.samples // (BLADES - 1))]
        panels.append(Panel(title, lines, [Blades(drawn, 0.12 * float(np.ptp(truth[:, :2])), "ink", 3.0)]))
    return paths(panels, columns=2)


def figures(material: Material) -> dict[str, str]:
    return {
        "paths": svg(path_picture(material), "The skate's path, ahead and backwards: exact, and in several methods"),
        "parking": svg(parking(), "Parallel parking by turns and slides, and the commutator"),
        "slope": svg(slope(), "An ideal skate that turns on a slope"),
    }


CONSTRUCTION_HEADER = (
    "construction",
    "position [m]",
    "slip [m/s]",
    "energy [relative]",
    "reaction [relative]",
    "CPU [ms/s]",
)


def constructions(rows: Sequence[Measurement], enforcement: Mapping[str, str] | None = None) -> str:
    """A Markdown table of errors and cost at COMPARED_STEP, and of convergence; the best construction is first.
    Constructions without a run near that step are left out."""
    verdicts = by_method(sweeps(rows), "position")
    lines = []
    for key, members in groups(rows).items():
        built = Rows(row for row in members if row.outcome != Outcome.UNSUPPORTED)
        row = built.near(COMPARED_STEP)
        if not built:
            lines.append((np.inf, [members[0].method, "can't be built", *[tables.DASH] * 4, ""]))
        elif row:
            numbers = [tables.number(value) for value in (row.position, row.slip, row.energy, row.reaction)]
            if not Outcome(row.outcome).comparable:
                numbers[0] = f"**{row.outcome}** {numbers[0]}"
            wrong = all(Outcome(member.outcome).wrong for member in members)
            convergence = "wrong at every step" if wrong else row_tables.sweep_words(verdicts[key])
            error = row.position if np.isfinite(row.position) else np.inf
            lines.append((error, [row.method, *numbers, tables.milliseconds(row.cpu), convergence]))
    header = [*CONSTRUCTION_HEADER, "order as the step shrinks, plateau in m"]
    body = [line for _, line in sorted(lines, key=lambda pair: pair[0])]
    return tables.markdown(header, body, left=1, enforcement=enforcement) if lines else ""


@cache
def counted(scenes: tuple[Scene, ...], names: tuple[str, ...] | None = None) -> str:
    """A Markdown table of degrees of freedom by rank and by Lie brackets. `names` replace the names of the scenes."""
    body = []
    for name, scene in zip(names or tuple(scene.name for scene in scenes), scenes, strict=True):
        mechanism = scene.mechanism()
        configuration, velocity = mechanism.degrees_of_freedom()
        growth = " -> ".join(map(str, freedoms_by_brackets(mechanism)))
        kind = "integrable" if mechanism_is_integrable(mechanism) else "not integrable"
        body.append([name, str(mechanism.row_count), f"({configuration}, {velocity})", growth, kind])
    header = ["scene", "rows", "(configuration, velocity) by rank", "reachable, by brackets", "by Frobenius"]
    return tables.markdown(header, body, left=5)


def uniform_conditions() -> str:
    """A Markdown table of velocity conditions w = (a, b, c) on a body, with the equivalent skates and w · curl w."""
    body = []
    for row in ((0.0, 1.0, 0.5), (1.0, 0.0, 0.0), (3.0, 4.0, -2.0), (0.0, 0.0, 1.0)):
        skate, curl = theory.skate_of(row), theory.frobenius(row, np.array([0.3, -0.2, 0.8]))
        equivalent = "none"
        if skate is not None:  # adding 0.0 changes -0 into 0
            numbers = (*skate.second_point, math.degrees(skate.angle))
            equivalent = "({:.3g}, {:.3g}) m, {:.3g}°".format(*(number + 0.0 for number in numbers))
        body.append([f"({', '.join(f'{factor:g}' for factor in row)})", equivalent, f"{curl + 0:.6g}"])
    return tables.markdown(["(a, b, c)", "skate: its point, its blade's angle", "w · curl w"], body, left=2)


def context(material: Material) -> Mapping[str, Any]:
    """Tables, and functions that return UNMEASURED or a row of the sleigh. at: the method's row with the step nearest
    to a step [s]. least: the row with the least position error. finest: a method's row at the smallest step with a
    position error."""
    rows = Rows(material.sweep((SLEIGH_AHEAD,)))
    enforcement = enforcement_by_method(
        cell for cell in material.rows if cell.scene == SLEIGH_AHEAD and cell.purpose == "sweep"
    )
    return {
        "only": uniform_conditions(),
        "coriolis": theory.coriolis_factors(1.3, 1.7, -0.6),
        "constructions": constructions([row for row in rows if usual_series(row) or row.method in LISTED], enforcement),
        "counted": counted(SKATE_SCENES),
        "at": lambda method, step=COMPARED_STEP: rows.of(method=method).known("position").near(step),
        "least": lambda engine, variant: rows.of(method=f"{engine} {variant}").best("position"),
        "finest": lambda method: rows.of(method=method).known("position").finest(),
        "sleigh": SLEIGH_AHEAD,
        "end": SLEIGH_AHEAD.motion([SLEIGH_AHEAD.duration]).pose[0, 0],
        "commutator": theory.commutator_displacement(0.1, 0.1),
    }


# The order of an ideal row is declared for the naive method, although it does not converge to the ideal motion. So the
# gate compares the error of the naive method with a bound.
DECLARED_ORDERS = {("sleigh_backwards", "pymunk default"): ConvergenceOrder(1, differences=1)}

PAGE = scene_page(
    "skate",
    title="The skate",
    lesson="A skate constrains velocities but no position. Engines have no such joint; the page compares replacements.",
    scenes=SKATE_SCENES,
    engines=(*VARIANTS, *SKATE_CONSTRUCTIONS),
    failures=SKATE_EXPERIMENTS,
    compared=compared,
    quantity="position",
    figures=figures,
    context=context,
    orders=DECLARED_ORDERS,
    tasks=tuple(Motion(cell) for _, _, cells in PATHS for cell in cells.values()),
)
