"""The one screen: what to paste into a model of one's own, and what it wins, for MuJoCo and pymunk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from engines import Engine, mujoco, pymunk
from reference.scene import Scene
from reference.scenes.catalogue import scene
from reports.model.cells import Cell
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.pages.versions.page import table as versions
from reports.write.programs import program
from reports.write.tables import NOTHING, error_words, markdown, milliseconds
from reports.write.unmeasured import UNMEASURED

NAME = "your_loop"
LINES = Path(__file__).parent / "lines"
EVERY = 10  # samples of these scenes are 1e-2 s apart: steps of a millisecond
LOOP, SLIDER, CHAIN, DISC, SKATE = map(
    scene, ("free_four_bar", "free_slider_crank", "pendulum_10", "rolling_disc", "sleigh")
)


@dataclass(frozen=True)
class Case:
    """What a user builds: `before` as shipped, None without such a joint; `after`: with the lines of the page."""

    what: str
    page: str
    scene: Scene
    before: Engine | None
    after: tuple[Engine, ...]
    quantity: str = "angle"


MUJOCO = (
    Case("closed linkage", "four_bar", LOOP, mujoco.DEFAULT, (mujoco.TUNED,)),
    Case("slider", "slider_crank", SLIDER, mujoco.DEFAULT, (mujoco.TUNED,)),
    Case("chain of ten", "pendulum", CHAIN, mujoco.DEFAULT, (mujoco.TUNED,)),
    Case("disc that rolls", "rolling", DISC, mujoco.DEFAULT, (mujoco.TUNED,)),
    Case("skate", "skate", SKATE, mujoco.DEFAULT, (mujoco.TUNED,), "position"),
)
PYMUNK = (
    Case("closed linkage", "four_bar", LOOP, pymunk.DEFAULT, (pymunk.TUNED, pymunk.LEAPFROG)),
    Case("slider", "slider_crank", SLIDER, pymunk.DEFAULT, (pymunk.TUNED, pymunk.LEAPFROG)),
    Case("chain of ten", "pendulum", CHAIN, pymunk.DEFAULT, (pymunk.TUNED, pymunk.LEAPFROG)),
    Case("disc that rolls", "rolling", DISC, pymunk.DEFAULT, (pymunk.TUNED,)),
    Case("skate", "skate", SKATE, None, (pymunk.TUNED,), "position"),
)


def cell(case: Case, engine: Engine) -> Cell:
    """At this page's one step; beside the grid where no other page runs the method in this scene."""
    own = engine == pymunk.LEAPFROG and case.scene != LOOP
    return Cell(case.scene, engine, EVERY, "beside" if own else "sweep")


ASKED = tuple(cell(case, engine) for case in (*MUJOCO, *PYMUNK) for engine in (case.before, *case.after) if engine)
OWN = tuple(each for each in ASKED if each.purpose == "beside")


def table(material: Material, cases: tuple[Case, ...], heads: tuple[str, ...]) -> str:
    """A line a case: errors before and after, and CPU times; empty without rows."""

    def told(case: Case, engine: Engine | None) -> tuple[str, str]:
        if engine is None:
            return "*no such joint*", NOTHING
        row = material.rows.get(cell(case, engine))
        return error_words(row, case.quantity), NOTHING if row is None else milliseconds(row.cpu)

    body = []
    for case in cases:
        pairs = [told(case, engine) for engine in (case.before, *case.after)]
        pairs += [(NOTHING, NOTHING)] * (len(heads) - len(pairs))
        costs = " → ".join(dict.fromkeys(cost for _, cost in pairs if cost != NOTHING))
        name = f"[{case.what}]({case.page}.md), {quantity(case.quantity).unit}"
        body.append([name, *(error for error, _ in pairs), costs or NOTHING])
    known = any(each in material.rows for each in ASKED)
    return markdown(["at 1 ms", *heads, "CPU [ms/s]"], body, left=1) if known else ""


def error_at(material: Material, case: Case, engine: Engine) -> Any:
    """The error of a case that can be compared, else UNMEASURED."""
    row = material.rows.get(cell(case, engine))
    return getattr(row, case.quantity) if row is not None and Outcome(row.outcome).comparable else UNMEASURED


def aimed(engine: str) -> str:
    """What our code does before each step of a skate, from the program that a test runs."""
    source = program("sleigh", f"{engine} tuned")
    return source[source.index("def aim():") : source.index("end = ")].rstrip()


def words(material: Material) -> Mapping[str, Any]:
    """The lines and tables; `reactions`: relative errors of the joints' forces on the loop, by engine."""
    old = [e.error for e in versions().entries if (e.version, e.scene, e.variant) == ("3.6.0", LOOP.name, "tuned")]
    rows = {
        "mujoco": material.rows.get(cell(MUJOCO[0], mujoco.TUNED)),
        "pymunk": material.rows.get(cell(PYMUNK[0], pymunk.LEAPFROG)),
    }
    return {
        "mujoco": table(material, MUJOCO, ("as shipped", "with the lines")),
        "pymunk": table(material, PYMUNK, ("as shipped", "with the first lines", "and started ahead")),
        "lines": {path.stem: path.read_text(encoding="utf-8").rstrip() for path in sorted(LINES.iterdir())},
        "aimed": {engine: aimed(engine) for engine in ("mujoco", "pymunk")},
        "reactions": {engine: UNMEASURED if row is None else row.reaction for engine, row in rows.items()},
        "linkage": {
            "mujoco": [error_at(material, MUJOCO[0], engine) for engine in (mujoco.DEFAULT, mujoco.TUNED)],
            "pymunk": [error_at(material, PYMUNK[0], engine) for engine in (pymunk.DEFAULT, pymunk.LEAPFROG)],
        },
        "before_term": old[0] if old and rows["mujoco"] is not None else UNMEASURED,
    }


PAGE = Page(
    name=NAME,
    title="Your loop in MuJoCo, your loop in pymunk",
    lesson="The lines to paste, the error and the cost before and after, the release, and what they do not cure.",
    scenes=(),
    engines=(),
    companions=(LOOP,),
    borrowed=tuple(each for each in ASKED if each not in OWN),
    cells=OWN,
    words=words,
)
