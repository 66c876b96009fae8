"""The page that walks through three models of a user's: what `crosscheck check` finds in each, in words."""

from __future__ import annotations

import csv
import json
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from engines.reading import ReadingTerms
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.check.checked import Checked, Plan, Tried, check, read, readers
from reports.check.document import data
from reports.check.pictures import from_text, pictures, shown_of
from reports.model.page import Material, Page
from reports.model.tasks import Task, Values
from reports.write.tables import markdown, number

MODELS = Path(__file__).parent / "models"


@dataclass(frozen=True)
class Walk(Task):
    """One of the models beside this file, by its text, so that another text is another task."""

    file: str
    text: str
    word: str  # as on the command line
    duration: float  # s
    tolerance: float
    step: float | None = None
    seconds: ClassVar[float] = 15.0
    words: ClassVar[str] = "check: {0.file}"

    @property
    def stem(self) -> str:
        """The model's name in the template and in the names of its pictures."""
        return self.file.split(".")[0]

    def run(self) -> Values:
        """All that `crosscheck check --json` tells but CPU times, others on every machine; and what is drawn."""
        with tempfile.TemporaryDirectory(prefix="crosscheck-") as folder:
            (Path(folder) / self.file).write_text(self.text, encoding="utf-8")
            reading = read(self.word, Path(folder), ReadingTerms(step=self.step))
            found = check(reading, self.file, self.duration, self.tolerance, plan=Plan(float("inf")))
        told = data(found)
        for setting in (told, *told["tried"]):
            setting.pop("cpu")
            setting.pop("front", None)
        # What is cheapest by the clock differs between machines; the largest step that is enough does not.
        coarsest = coarsest_enough(found)
        told["advised"] = coarsest and {
            "words": coarsest.change.words,
            "step": coarsest.change.dt,
            "error": coarsest.error,
            "lines": list(coarsest.change.lines),
        }
        del told["next_decade"], told["over_time"]
        return {"found": json.dumps(told, sort_keys=True), "shown": shown_of(found, coarsest).as_text()}


def coarsest_enough(found: Checked) -> Tried | None:
    """The setting of the largest step within the tolerance, the first of equal ones."""
    enough = [each for each in found.table if each.error <= found.tolerance]
    return max(enough, key=lambda each: each.change.dt, default=None)


def walk(file: str, name: str = "", **settings: float) -> Walk:
    """The task of a model of the page."""
    text = (MODELS / file).read_text(encoding="utf-8")
    return Walk(file, text, f"{file}:{name}" if name else file, **settings)  # type: ignore[arg-type]


FOUR_BAR = walk("four_bar.xml", duration=2.0, tolerance=1e-4)
CART = walk("cart_and_pole.xml", duration=2.0, tolerance=1e-4)
SWING = walk("swing.py", "space", duration=2.0, tolerance=1e-3, step=1 / 60)
WALKS = (FOUR_BAR, CART, SWING)

TABLE = MODELS / "of_others.csv"
SOURCES = {
    "mujoco": "MuJoCo's package",
    "gymnasium": "Gymnasium",
    "dm_control": "dm_control's suite",
    "pymunk": "pymunk's examples",
}


def rows() -> list[dict[str, str]]:
    """Every model that was tried, by its name."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def other_models() -> dict[str, object]:
    """How many were tried and read, as they are and with something switched off, and the table."""
    found = rows()
    read = [row for row in found if row["bodies"]]
    body = [[SOURCES[row["source"]], f"`{row['model']}`", _sentence(row)] for row in found]
    return {
        "count": len(found),
        "as_is": sum(not row["without"] for row in read),
        "switched": sum(bool(row["without"]) for row in read),
        "table": markdown(["from", "model", "what became of it"], body),
    }


def read_elements() -> str:
    """What the readers of models read, from their own tables."""
    body = [
        [key, element, taken] for key, reader in sorted(readers().items()) for element, taken in reader.elements.items()
    ]
    return markdown(["in", "element", "is read as"], body, left=3)


def _sentence(row: dict[str, str]) -> str:
    off = "".join(f" `--without {word}`" for word in row["without"].split())
    if row["bodies"]:
        bodies = f"read: {row['bodies']} {'body' if row['bodies'] == '1' else 'bodies'}"
        return f"{bodies}, with{off}" if off else bodies
    return f"refused{f', with{off} too' if off else ''}: {row['reason']}"


NAME = "your_model"


def found_of(material: Material, walk: Walk) -> dict[str, Any] | None:
    """The results of a check with their table; None if it was not run or not finished."""
    if (answer := material.finished(walk)) is None:
        return None
    found = json.loads(str(answer.values["found"]))
    return {**found, "table": table(found)}


def figures(material: Material) -> dict[str, str]:
    """Errors over time, and the worst moment, of each model."""
    return {
        f"{walk.stem}_{key}": drawing
        for walk in WALKS
        if (answer := material.finished(walk)) is not None
        for key, (_, drawing) in pictures(from_text(str(answer.values["shown"]))).items()
    }


def table(found: Mapping[str, Any]) -> str:
    """The settings that were tried, with their errors."""
    body = [
        [each["words"], *("gave up" if each[key] is None else number(each[key]) for key in ("error", "reaction"))]
        for each in found["tried"]
    ]
    return markdown(["setting", "largest error", "reaction error"], body)


def context(material: Material) -> Mapping[str, Any]:
    """By a model's name what was found in it, its text and its table; None for one that was not run."""
    return {
        "read": read_elements(),
        "others": other_models(),
        "found": {walk.stem: found_of(material, walk) for walk in WALKS},
        "walks": {walk.stem: walk for walk in WALKS},
    }


PAGE = Page(
    name=NAME,
    title="Your own model",
    lesson="What `crosscheck check` tells of a model of your own: how wrong it is, why, and which settings are enough.",
    companions=(FreeFourBar(),),  # a full run of it runs the checks too
    figures=figures,
    context=context,
    tasks=WALKS,
)
