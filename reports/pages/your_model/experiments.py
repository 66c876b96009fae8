"""The models of the page, checked: what is run and kept, apart from words and pictures."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from pathlib import Path

from reports.check.checked import Checked, Plan, Tried, check, read
from reports.check.document import data
from reports.check.picture_data import shown_of
from reports.model.tasks import Task, Values

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

    @property
    def cost(self) -> float:
        return 15.0

    @property
    def label(self) -> str:
        return f"check: {self.file}"

    def run(self) -> Values:
        """All that `crosscheck check --json` tells but CPU times, others on every machine; and what is drawn."""
        with tempfile.TemporaryDirectory(prefix="crosscheck-") as folder:
            (Path(folder) / self.file).write_text(self.text, encoding="utf-8")
            reading = read(self.word, Path(folder), step=self.step)
            found = check(reading, self.file, self.duration, self.tolerance, plan=Plan(float("inf")))
        told = data(found)
        for setting in (told, *told["tried"]):
            setting.pop("cpu")
            setting.pop("front", None)
        # What is cheapest by the clock differs between machines; the largest step that is enough does not.
        coarsest = coarsest_enough(found)
        told["advised"] = None if coarsest is None else {**_setting(coarsest)}
        del told["next_decade"], told["over_time"]
        return {"found": json.dumps(told, sort_keys=True), "shown": shown_of(found, coarsest).as_text()}


def coarsest_enough(found: Checked) -> Tried | None:
    """The setting of the largest step within the tolerance, the first of equal ones."""
    enough = [each for each in found.table if each.error <= found.tolerance]
    return max(enough, key=lambda each: each.change.dt, default=None)


def _setting(each: Tried) -> dict[str, object]:
    change = each.change
    return {"words": change.words, "step": change.dt, "error": each.error, "lines": list(change.lines)}


def walk(file: str, name: str = "", **settings: float) -> Walk:
    """The task of a model of the page."""
    text = (MODELS / file).read_text(encoding="utf-8")
    return Walk(file, text, f"{file}:{name}" if name else file, **settings)  # type: ignore[arg-type]


FOUR_BAR = walk("four_bar.xml", duration=2.0, tolerance=1e-4)
CART = walk("cart_and_pole.xml", duration=2.0, tolerance=1e-4)
SWING = walk("swing.py", "space", duration=2.0, tolerance=1e-3, step=1 / 60)
WALKS = (FOUR_BAR, CART, SWING)
