"""Shared by experiments of several pages: their methods, their cells, and the texts of `experiments.md`."""

from __future__ import annotations

import contextlib
import io
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

from engines import Engine, method_name, mujoco, pymunk
from engines.registry import VARIANTS
from reference.scene import Scene
from reports.model.cells import Cell
from reports.model.checks import Deviation
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Answer, Task

PUBLIC: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
ALL: tuple[Engine, ...] = (*PUBLIC, pymunk.EXTENDED, mujoco.EXTENDED)
# What is run in every scene, without ideal constraints.
ENGINES_ALONE: tuple[Engine, ...] = tuple(engine for engine in VARIANTS if engine.name != "lagrange")


def sweeps(count: int) -> Engine:
    """pymunk closing every gap in one step, by this many sweeps."""
    return replace(pymunk.DEFAULT, variant=f"{count} sweeps, all of the gap", iterations=count, error_bias=0.0)


def cells(
    scene: Scene, engines: Iterable[Engine], every: Iterable[int], samples: int | None = None
) -> tuple[Cell, ...]:
    """The cells of an experiment: a scene in engines with so many steps between samples."""
    steps = tuple(every)
    return tuple(Cell(scene, engine, count, "failure", samples) for engine in engines for count in steps)


def steps_for(engine: Engine, every: tuple[int, ...]) -> tuple[int, ...]:
    """What runs a cell at many steps is at rounding with the longest already."""
    return every[:1] if engine.variant == "extended" else every


def to_rounding(
    title: str,
    scene: Scene,
    every: tuple[int, ...],
    columns: tuple[str, ...],
    samples: int | None = None,
    engines: Iterable[Engine] = ENGINES_ALONE,
    **fields: Any,
) -> Failure:
    """An experiment in which each engine runs a scene at `steps_for` it; fields: others of the experiment."""
    run = tuple(cell for engine in engines for cell in cells(scene, (engine,), steps_for(engine, every), samples))
    return Failure(title, cells=run, columns=columns, **fields)


def described(source: str, *failures: Failure, **values: Any) -> tuple[Failure, ...]:
    """The experiments with their texts from `experiments.md` beside the file `source`.

    A section has the experiment's title, a paragraph with the expectation, paragraphs with the lesson if there is one,
    and a list of the claims in it (`reports.pages.claims`). All are templates of `values` and of the experiment's own
    words. An experiment that is run no more has its last numbers there as a table. Raises ValueError unless each
    experiment has a section and each section an experiment.
    """
    text = Path(source).with_name("experiments.md").read_text(encoding="utf-8")
    sections = {}
    for section in text.removeprefix("## ").split("\n## "):
        title, *paragraphs = section.strip().split("\n\n")
        sections[title] = paragraphs
    if list(sections) != (titles := [failure.title for failure in failures]):
        raise ValueError(f"{source}: experiments.md has the sections {list(sections)}; the experiments are {titles}")
    return tuple(_with_text(failure, sections[failure.title], values) for failure in failures)


def _with_text(failure: Failure, paragraphs: Iterable[str], values: Mapping[str, Any]) -> Failure:
    def context(material: Material) -> Mapping[str, Any]:
        return {**values, **failure.context(material)}

    texts = [
        paragraph if paragraph.startswith("|") else " ".join(paragraph.split())
        for paragraph in paragraphs
        if not paragraph.startswith("- ")
    ]
    claims = [line.removeprefix("- ") for each in paragraphs if each.startswith("- ") for line in each.splitlines()]
    return replace(
        failure,
        expected=texts[0],
        remark="\n\n".join(texts[1:]),
        claims=tuple(claims),
        context=context if values else failure.context,
    )


@dataclass(frozen=True)
class OfMethod(Task):
    """What one method gives; subclasses say in a few words `what` that is."""

    what: ClassVar[str]

    method: Engine

    @property
    def label(self) -> str:
        return f"{method_name(self.method)}: {self.what.format(self)}"

    @property
    def engine(self) -> Engine:
        return self.method


def run_script(name: str, text: str) -> dict[str, Any]:
    """The names that a script of a document has at its end; what it prints is dropped."""
    names: dict[str, Any] = {"__name__": "__main__"}
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(text, name, "exec"), names)
    return names


def refusals(attempts: Mapping[str, Callable[[], object]]) -> list[Observation]:
    """The reference's sentences on settings that can't be, by setting; AssertionError where it goes along."""
    lines = []
    for setting, attempt in attempts.items():
        try:
            attempt()
        except ValueError as sentence:
            lines.append(Observation("the reference", setting, f"refuses: {sentence}"))
        else:
            raise AssertionError(f"the reference went along with {setting}")
    return lines


def read_answers(
    material: Material, method: str, settings: Iterable[tuple[Task, str]], read: Callable[[Answer], str]
) -> list[Observation]:
    """A line for each task that was run: what `read` finds in its answer, or why it did not finish."""
    answers = {setting: material.answers.get(task) for task, setting in settings}
    return [
        Observation(method, setting, read(answer) if answer.finished else answer.told)
        for setting, answer in answers.items()
        if answer is not None
    ]


@cache
def _written_deviations() -> dict[str, list[dict[str, Any]]]:
    return tomllib.loads(Path(__file__).with_name("deviations.toml").read_text(encoding="utf-8"))


def deviations(page: str) -> dict[tuple[str, str, str], Deviation]:
    """The known deviations of a page, from `deviations.toml`."""
    known: dict[tuple[str, str, str], Deviation] = {}
    for entry in _written_deviations()[page]:
        scenes = dict(entry)
        reason, rounding = scenes.pop("reason"), scenes.pop("rounding", False)
        for scene, methods in scenes.items():
            for method, factors in methods.items():
                if isinstance(factors, str):
                    known[scene, method, "outcome"] = Deviation(reason, outcome=Outcome(factors))
                    continue
                for check, factor in factors.items():
                    known[scene, method, check] = Deviation(reason, factor, rounding=rounding)
    return known
