"""The skate's page: every construction of one that we found, on the sleigh, and what else a skate teaches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from engines import Engine
from engines.registry import VARIANTS
from reference.chapter.integrability import freedoms_by_brackets, mechanism_is_integrable
from reference.chapter.parking import commutator_displacement
from reference.scene import Scene
from reference.scenes.skates.pinned_body import FreelyPinnedBody, PinnedBody
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.trajectory import Trajectory
from reports.charts import work_precision as charts
from reports.charts.plane_panels import Blades, Panel, Path, paths
from reports.charts.theme import svg
from reports.grid.cells import Cell
from reports.grid.convergence import best_of, by_method, groups, sweeps
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.grid.tasks import Motion
from reports.pages.page import FEATURED, Material, Page
from reports.pages.skate import pictures as skate_pictures
from reports.pages.skate.expectations import KNOWN, ORDERS
from reports.pages.skate.experiments import FAILURES, MAPS
from reports.pages.skate.methods import CONSTRUCTIONS, known
from reports.text import tables
from reports.text.holders import holders
from reports.text.lookups import nearest_step
from reports.text.unmeasured import UNMEASURED

NAME = "skate"
SCENES = (ChaplyginSleigh(), SleighBackwards(), PinnedBody(), FreelyPinnedBody())
SLEIGH = ChaplyginSleigh()

# The step at which constructions are compared [s]: about that of a user who has refined once.
COMPARED = 1e-3
BLADES = 7  # skates drawn on the way
# Name -> colour, dashes. A construction that is not visibly off is not worth a line.
OVERLAID: dict[str, tuple[str, Any]] = {
    "pymunk skate: centre's velocity zeroed": ("first", "--"),
    "pymunk skate: point's velocity zeroed": ("first", ":"),
    "pymunk tuned": ("first", "-"),
    "mujoco default": ("second", "--"),
    "mujoco tuned": ("second", ":"),
}
# One of each kind: five looks an engine are what a chart can tell apart.
CHARTED = (
    "pymunk skate: groove, stale heading",
    "pymunk skate: groove, predicted heading",
    "pymunk skate: groove, extrapolated",
    "mujoco friction blade",
    "mujoco thin wheel",
    "mujoco tendon",
    "mujoco leapfrog",
    "mujoco passive force",
)
# Beside the variants: "pymunk default" is the centre's velocity zeroed, "tuned" the groove that is predicted.
LISTED = {*CHARTED, "pymunk skate: point's velocity zeroed"} - {"pymunk skate: groove, predicted heading"}


def featured(row: Measurement) -> bool:
    """The variants of every scene, and the cheap construction of second order."""
    return row.variant in FEATURED or row.method == "mujoco leapfrog"


def compared(scene: Scene, engine: Engine) -> bool:
    """Constructions of a skate on the sleigh alone: backwards they are an experiment, and a pin needs none."""
    return scene == SLEIGH or engine not in CONSTRUCTIONS


def skate_path(scene: ChaplyginSleigh, trajectory: Trajectory) -> np.ndarray:
    """Poses (times, 3) of the skate from those of the sleigh's body."""
    pose = trajectory.pose[:, 0]
    arm = np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2]), np.zeros(len(pose))], axis=-1)
    return pose - scene.offset * arm


PATHS = tuple(
    (title, scene, {name: Cell(scene, engine, 1) for name, engine in known(OVERLAID).items()})
    for title, scene in (
        ("ahead for 3 s, steps of 1e-2 s", SLEIGH),
        ("backwards for 10 s: it turns round", SleighBackwards()),
    )
)


def path_picture(material: Material) -> Figure:
    """The skate's path in truth and in several methods, forwards and backwards."""
    panels = []
    for title, scene, cells in PATHS:
        found = material.motions(cells.values())
        truth = scene.skate_pose(np.linspace(0, scene.duration, scene.samples + 1))
        lines = [Path(truth[:, :2], "truth", "ink", "-", 3.0)]
        for name, cell in cells.items():
            if cell in found:
                colour, dashes = OVERLAID[name]
                points = skate_path(scene, found[cell])[:, :2]
                lines.append(Path(points, name, colour, dashes, 1.6, framed=False, dot=True))
        some = truth[:: max(1, scene.samples // (BLADES - 1))]
        panels.append(Panel(title, lines, [Blades(some, 0.12 * float(np.ptp(truth[:, :2])), "ink", 3.0)]))
    return paths(panels, columns=2)


def figures(material: Material) -> dict[str, str]:
    """Paths, parking, the slope, and every construction's error against the step."""
    rows = [row for row in material.sweep((SLEIGH,)) if row.method in CHARTED]
    found = {
        "paths": svg(path_picture(material), "The skate's path, ahead and backwards, in truth and in several methods"),
        "parking": svg(skate_pictures.parking(), "Parallel parking by turns and slides, and the commutator"),
        "slope": svg(skate_pictures.slope(), "An ideal skate that turns on a slope"),
    }
    if any(Outcome(row.outcome).comparable for row in rows):
        chart = charts.error_against_step(rows, lambda row: True, "position")
        found["constructions"] = svg(chart, "Constructions of a skate: position error against step")
    return found


def constructions(rows: Sequence[Measurement], held: Mapping[str, str] | None = None) -> str:
    """One line a construction: what it gives at about the compared step and costs there, and what its error does.

    Constructions that were run at other steps alone have no line; the text is empty if none has one.
    """
    verdicts = by_method(sweeps(rows), "position")
    told = []
    for key, members in groups(rows).items():
        if all(row.outcome == Outcome.UNSUPPORTED for row in members):
            told.append((np.inf, [members[0].method, "can't be built", *[tables.NOTHING] * 4, ""]))
            continue
        row = nearest_step((row for row in members if row.outcome != Outcome.UNSUPPORTED), COMPARED)
        if row is None:
            continue
        numbers = [tables.number(value) for value in (row.position, row.slip, row.energy, row.reaction)]
        if not Outcome(row.outcome).comparable:
            numbers[0] = f"**{row.outcome}** {numbers[0]}"
        wrong = all(Outcome(member.outcome).wrong for member in members)
        words = "wrong at every step" if wrong else tables.sweep_words(verdicts[key])
        error = row.position if np.isfinite(row.position) else np.inf
        told.append((error, [row.method, *numbers, tables.milliseconds(row.cpu), words]))
    if not told:
        return ""
    header = [
        "construction",
        "position [m]",
        "slip [m/s]",
        "energy [relative]",
        "reaction [relative]",
        "CPU [ms/s]",
        "as the step shrinks, plateau in m",
    ]
    return tables.markdown(header, [line for _, line in sorted(told, key=lambda pair: pair[0])], left=1, held=held)


@cache
def counted(scenes: tuple[Scene, ...], names: tuple[str, ...] | None = None) -> str:
    """Freedoms of scenes by rank and by brackets, as a table; `names` stand for the scenes' own."""
    body = []
    for name, scene in zip(names or tuple(scene.name for scene in scenes), scenes, strict=True):
        mechanism = scene.mechanism()
        configuration, velocity = mechanism.degrees_of_freedom()
        growth = " -> ".join(map(str, freedoms_by_brackets(mechanism)))
        kind = "integrable" if mechanism_is_integrable(mechanism) else "not integrable"
        body.append([name, str(mechanism.row_count), f"({configuration}, {velocity})", growth, kind])
    header = ["scene", "rows", "(configuration, velocity) by rank", "reachable, by brackets", "by Frobenius"]
    return tables.markdown(header, body, left=5)


def words(material: Material) -> Mapping[str, Any]:
    """`constructions` (one of each kind), `all_constructions` and `counted` as tables.

    Of the sleigh, UNMEASURED where there is none: `at(method, step)`, the
    row at about that step; `least(engine, variant)`, the row with the least position error; `finest(method)`, the row
    at the smallest step that has a position error.
    """
    rows = material.sweep((SLEIGH,))

    def at(name: str, step: float = COMPARED) -> Any:
        own = (row for row in rows if row.method == name and np.isfinite(row.position))
        return nearest_step(own, step) or UNMEASURED

    def least(engine: str, variant: str) -> Any:
        return best_of(rows, engine, variant, "position") or UNMEASURED

    def finest(name: str) -> Any:
        own = (row for row in rows if row.method == name and np.isfinite(row.position))
        return min(own, key=lambda row: row.step, default=UNMEASURED)

    commutator = commutator_displacement(0.1, 0.1)
    held = holders(cell for cell in material.rows if cell.scene == SLEIGH and cell.purpose == "sweep")
    return {
        "constructions": constructions([row for row in rows if featured(row) or row.method in LISTED], held),
        "all_constructions": constructions(rows, held),
        "counted": counted(SCENES),
        "at": at,
        "least": least,
        "finest": finest,
        "sleigh": SLEIGH,
        "end": SLEIGH.motion([SLEIGH.duration]).pose[0, 0],
        "commutator": commutator,
    }


PAGE = Page(
    name=NAME,
    title="The skate",
    lesson="A skate forbids velocities but no position. Engines have no such joint; here is what can stand for it.",
    scenes=SCENES,
    engines=(*VARIANTS, *CONSTRUCTIONS),
    failures=FAILURES,
    maps=MAPS,
    compared=compared,
    quantity="position",
    featured=featured,
    figures=figures,
    words=words,
    orders=ORDERS,
    known=KNOWN,
    tasks=tuple(Motion(cell) for _, _, cells in PATHS for cell in cells.values()),
)
