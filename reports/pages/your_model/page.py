"""The page that explains the results of `crosscheck check` with three models."""

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
from reports.check.checked import SweepPlan, check, read_user_model, readers
from reports.check.document import check_data
from reports.check.pictures import picture_data_from_text, picture_data_of, render_pictures
from reports.model.page import Material, Page
from reports.model.tasks import Task, Values
from reports.write.tables import markdown, number

MODEL_FILES = Path(__file__).parent / "models"


@dataclass(frozen=True)
class ModelCheck(Task):
    """A task with the check of a model in MODEL_FILES. The task's key depends on the model's text, which is a field."""

    file: str
    text: str
    argument: str  # Argument of the command line.
    duration: float  # s.
    tolerance: float
    step: float | None = None
    seconds: ClassVar[float] = 15.0
    words: ClassVar[str] = "check: {0.file}"

    @property
    def stem(self) -> str:
        """The model's name in the template and in names of pictures."""
        return self.file.split(".")[0]

    def run(self) -> Values:
        """The output of `crosscheck check --json` without CPU times, and the data of the pictures."""
        with tempfile.TemporaryDirectory(prefix="crosscheck-") as folder:
            (Path(folder) / self.file).write_text(self.text, encoding="utf-8")
            reading = read_user_model(self.argument, Path(folder), ReadingTerms(step=self.step))
            checked = check(reading, self.file, self.duration, self.tolerance, plan=SweepPlan(float("inf")))
        document = check_data(checked)
        for setting in (document, *document["tried"]):
            setting.pop("cpu")
            setting.pop("front", None)
        # The largest sufficient step is chosen, because the cheapest sufficient setting depends on the machine.
        enough = [setting for setting in checked.table if setting.error <= checked.tolerance]
        coarsest = max(enough, key=lambda setting: setting.change.dt, default=None)
        document["advised"] = coarsest and {
            "words": coarsest.change.words,
            "step": coarsest.change.dt,
            "error": coarsest.error,
            "lines": list(coarsest.change.lines),
        }
        del document["next_decade"], document["over_time"]
        return {"found": json.dumps(document, sort_keys=True), "shown": picture_data_of(checked, coarsest).as_text()}


def model_check(file: str, name: str = "", **settings: float) -> ModelCheck:
    text = (MODEL_FILES / file).read_text(encoding="utf-8")
    return ModelCheck(file, text, f"{file}:{name}" if name else file, **settings)  # type: ignore[arg-type]


FOUR_BAR_CHECK = model_check("four_bar.xml", duration=2.0, tolerance=1e-4)
CART_CHECK = model_check("cart_and_pole.xml", duration=2.0, tolerance=1e-4)
SWING_CHECK = model_check("swing.py", "space", duration=2.0, tolerance=1e-3, step=1 / 60)
MODEL_CHECKS = (FOUR_BAR_CHECK, CART_CHECK, SWING_CHECK)

TRIED_MODELS = MODEL_FILES / "of_others.csv"
MODEL_SOURCES = {
    "mujoco": "MuJoCo's package",
    "gymnasium": "Gymnasium",
    "dm_control": "dm_control's suite",
    "pymunk": "pymunk's examples",
}


def rows() -> list[dict[str, str]]:
    with TRIED_MODELS.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def other_models() -> dict[str, object]:
    """A table of the models that were tried, and how many can be read unchanged or with elements switched off."""
    tried = rows()
    readable = [row for row in tried if row["bodies"]]
    body = [[MODEL_SOURCES[row["source"]], f"`{row['model']}`", _sentence(row)] for row in tried]
    return {
        "count": len(tried),
        "as_is": sum(not row["without"] for row in readable),
        "switched": sum(bool(row["without"]) for row in readable),
        "table": markdown(["from", "model", "what became of it"], body),
    }


def read_elements() -> str:
    """A Markdown table of the elements that `check` reads, and of their meaning."""
    body = [
        [key, element, meaning]
        for key, reader in sorted(readers().items())
        for element, meaning in reader.elements.items()
    ]
    return markdown(["in", "element", "is read as"], body, left=3)


def _sentence(row: dict[str, str]) -> str:
    off = "".join(f" `--without {option}`" for option in row["without"].split())
    if row["bodies"]:
        bodies = f"read: {row['bodies']} {'body' if row['bodies'] == '1' else 'bodies'}"
        return f"{bodies}, with{off}" if off else bodies
    return f"refused{f', with{off} too' if off else ''}: {row['reason']}"


def result_of(material: Material, task: ModelCheck) -> dict[str, Any] | None:
    """The results of a check with their table, or None if the check did not finish."""
    if (answer := material.finished(task)) is None:
        return None
    document = json.loads(str(answer.values["found"]))
    return {**document, "table": table(document)}


def figures(material: Material) -> dict[str, str]:
    return {
        f"{task.stem}_{key}": drawing
        for task in MODEL_CHECKS
        if (answer := material.finished(task)) is not None
        for key, (_, drawing) in render_pictures(picture_data_from_text(str(answer.values["shown"]))).items()
    }


def table(document: Mapping[str, Any]) -> str:
    body = [
        [
            setting["words"],
            *("gave up" if setting[key] is None else number(setting[key]) for key in ("error", "reaction")),
        ]
        for setting in document["tried"]
    ]
    return markdown(["setting", "largest error", "reaction error"], body)


def context(material: Material) -> Mapping[str, Any]:
    return {
        "read": read_elements(),
        "others": other_models(),
        "found": {task.stem: result_of(material, task) for task in MODEL_CHECKS},
        "walks": {task.stem: task for task in MODEL_CHECKS},
    }


PAGE = Page(
    name="your_model",
    title="Your own model",
    lesson="What `crosscheck check` reports on your own model: its error, its causes, and settings that suffice.",
    companions=(FreeFourBar(),),
    figures=figures,
    context=context,
    tasks=MODEL_CHECKS,
)
