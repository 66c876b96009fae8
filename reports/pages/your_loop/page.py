"""The page with lines to paste into a model of MuJoCo or pymunk, and with errors without and with these lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from engines import Engine, mujoco, pymunk
from reference.scene import Scene
from reference.scenes.catalogue import scene
from reports.model.cells import Cell
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.pages.your_loop.experiments import COMMIT, COUNT, LINKAGES, MILLISECONDS_PER_SAMPLE, BeforeAndAfter, Fresh
from reports.versions.table import error_before_term
from reports.write.page_tables import program
from reports.write.row_tables import error_words
from reports.write.tables import DASH, markdown, milliseconds, number
from reports.write.unmeasured import UNMEASURED

LINE_FILES = Path(__file__).parent / "lines"
LOOP, SLIDER, CHAIN, DISC, SKATE = map(
    scene, ("free_four_bar", "free_slider_crank", "pendulum_10", "rolling_disc", "sleigh")
)


@dataclass(frozen=True)
class PastedCase:
    """A mechanism in an engine, without and with the lines of the page. before: the engine with default settings, or
    None if it lacks the joint. after: the engine with the lines of the page."""

    title: str
    page: str
    scene: Scene
    before: Engine | None
    after: Engine
    quantity: str = "angle"

    @property
    def engines(self) -> tuple[Engine, ...]:
        return (self.after,) if self.before is None else (self.before, self.after)

    @property
    def fresh(self) -> tuple[Fresh, ...]:
        return tuple(Fresh(engine, self.scene, self.quantity) for engine in self.engines)


MECHANISM_KINDS = (
    ("closed linkage", "four_bar", LOOP),
    ("slider", "slider_crank", SLIDER),
    ("chain of ten", "pendulum", CHAIN),
    ("disc that rolls", "rolling", DISC),
)
SKATING = ("skate, by our code in every step", "skate", SKATE)
MUJOCO_CASES = (
    *(PastedCase(*kind, mujoco.DEFAULT, mujoco.TUNED) for kind in MECHANISM_KINDS),
    PastedCase(*SKATING, mujoco.DEFAULT, mujoco.TUNED, "position"),
)
PYMUNK_CASES = (
    *(
        PastedCase(*kind, pymunk.DEFAULT, pymunk.TUNED if kind[2] == DISC else pymunk.LEAPFROG)
        for kind in MECHANISM_KINDS
    ),
    PastedCase(*SKATING, None, pymunk.TUNED, "position"),
)


def cell(case: PastedCase, engine: Engine) -> Cell:
    """The cell of a case at 1 ms. The cell has the purpose "beside" if no other page runs the method in this scene."""
    beside = engine == pymunk.LEAPFROG and case.scene != LOOP
    return Cell(case.scene, engine, MILLISECONDS_PER_SAMPLE, "beside" if beside else "sweep")


PASTED_CELLS = tuple(cell(case, engine) for case in (*MUJOCO_CASES, *PYMUNK_CASES) for engine in case.engines)
CELLS_BESIDE_GRID = tuple(cell for cell in PASTED_CELLS if cell.purpose == "beside")
FRESH = tuple(dict.fromkeys(task for case in (*MUJOCO_CASES, *PYMUNK_CASES) for task in case.fresh))
PYMUNK_LINES = "\n\n".join((LINE_FILES / f"{name}.txt").read_text(encoding="utf-8") for name in ("close", "choose"))
BUILT = tuple(BeforeAndAfter(name, PYMUNK_LINES.replace("(space, 1e-3)", "(space, 1 / 240)")) for name in LINKAGES)


def table(material: Material, cases: tuple[PastedCase, ...]) -> str:
    """A Markdown table with a line for each case: errors in random mechanisms, and the example's errors and CPU
    times."""
    body = []
    for case in cases:
        rows = [material.rows.get(cell(case, engine)) for engine in case.engines]
        texts = [[number(value, infinite="gave up") for value in spread(material, task)] for task in case.fresh]
        spreads = [DASH if median == DASH else f"{median} ({least} to {most})" for median, least, most in texts]
        if case.before is None:
            spreads.insert(0, "*no such joint*")
        example = " → ".join(error_words(row, case.quantity) for row in rows)
        costs = " → ".join(DASH if row is None else milliseconds(row.cpu) for row in rows)
        body.append([f"[{case.title}]({case.page}.md), {quantity(case.quantity).unit}", *spreads, example, costs])
    has_rows = any(pasted in material.rows for pasted in PASTED_CELLS)
    head = ["at 1 ms", "as shipped", "with the lines", "the page's example", "CPU of the example [ms/s]"]
    return markdown(head, body, left=1) if has_rows else ""


def spread(material: Material, task: Fresh) -> list[float]:
    """The median, the least and the largest error of the random mechanisms, or UNMEASURED if the task was not run."""
    answer = material.finished(task)
    if answer is None:
        return [UNMEASURED] * 3
    error = answer.array("error")
    return [float(np.median(error)), float(error.min()), float(error.max())]


def before_and_after(material: Material) -> str:
    """A Markdown table of BUILT; empty if no task has finished."""
    body = []
    for task in BUILT:
        answer = material.finished(task)
        if answer is not None:
            count = round(answer.number("iterations"))
            gap, angle = (
                " → ".join(number(value, infinite=DASH) for value in answer.array(name).tolist())
                for name in ("gap", "angle")
            )
            angle = DASH if angle == f"{DASH} → {DASH}" else angle
            body.append([task.linkage, str(count) if count else "as shipped", gap, angle])
    return markdown(["linkage", "iterations", "largest gap, px", "angle error, rad"], body, left=1) if body else ""


def code_before_step(engine: str) -> str:
    source = program("sleigh", f"{engine} tuned")
    return source[source.index("def aim():") : source.index("end = ")].rstrip()


def context(material: Material) -> Mapping[str, Any]:
    """The lines and tables. reactions: engine -> relative error of the joint forces in the closed linkage. fresh:
    engine -> `spread` of the errors in random closed linkages, without and with the lines."""
    first = {"mujoco": MUJOCO_CASES[0], "pymunk": PYMUNK_CASES[0]}
    rows = {name: material.rows.get(cell(case, case.after)) for name, case in first.items()}
    counts = [answer.number("iterations") for answer in map(material.finished, BUILT) if answer is not None]
    return {
        "mujoco": table(material, MUJOCO_CASES),
        "pymunk": table(material, PYMUNK_CASES),
        "built": before_and_after(material),
        "built_count": len(LINKAGES),
        "left_as_shipped": sum(not count for count in counts) if counts else UNMEASURED,
        "lines": {path.stem: path.read_text(encoding="utf-8").rstrip() for path in sorted(LINE_FILES.iterdir())},
        "aimed": {engine: code_before_step(engine) for engine in ("mujoco", "pymunk")},
        "reactions": {engine: UNMEASURED if row is None else row.reaction for engine, row in rows.items()},
        "fresh": {name: [spread(material, task) for task in case.fresh] for name, case in first.items()},
        "fresh_count": COUNT,
        "fresh_commit": COMMIT,
        "before_term": UNMEASURED if rows["mujoco"] is None else error_before_term(),
    }


PAGE = Page(
    name="your_loop",
    title="Your loop in MuJoCo, your loop in pymunk",
    lesson="Lines to paste, errors and costs before and after, the release that they need, and their limits.",
    companions=(LOOP,),
    borrowed=tuple(cell for cell in PASTED_CELLS if cell not in CELLS_BESIDE_GRID),
    cells=CELLS_BESIDE_GRID,
    context=context,
    tasks=(*FRESH, *BUILT),
)
