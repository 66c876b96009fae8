"""Functions that the pages of scenes share: methods, cells, experiments with their texts, known deviations."""

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
from reports.model.page import Failure, Material, Observation, Page, no_context
from reports.model.tasks import Answer, Task
from reports.write.rows import lookups

PUBLIC: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
MAIN_METHODS: tuple[Engine, ...] = (*PUBLIC, pymunk.EXTENDED, mujoco.EXTENDED)
# `lagrange` is left out, because its constraints are ideal.
ENGINES_ALONE: tuple[Engine, ...] = tuple(engine for engine in VARIANTS if engine.name != "lagrange")

CLOSED_IN_1_MS = 1 - pymunk.SHIPPED_ERROR_BIAS**1e-3  # fraction of a gap that a step of pymunk as shipped closes


def sweeps(count: int) -> Engine:
    """pymunk with `count` iterations and `error_bias = 0`, so that each step closes the whole gap."""
    return replace(pymunk.DEFAULT, variant=f"{count} sweeps, all of the gap", iterations=count, error_bias=0.0)


def cells(
    scene: Scene, engines: Iterable[Engine], every: Iterable[int], samples: int | None = None
) -> tuple[Cell, ...]:
    """The cells of a scene for all engines and all numbers of steps between samples (`every`)."""
    steps = tuple(every)
    return tuple(Cell(scene, engine, count, "failure", samples) for engine in engines for count in steps)


def steps_for(engine: Engine, every: tuple[int, ...]) -> tuple[int, ...]:
    """The numbers of steps between samples with which an engine is run. An extrapolated variant is run at the largest
    step only, because its error is then already at rounding.
    """
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
    """An experiment in which each engine runs a scene at the steps of `steps_for`. `fields`: further fields of
    `Failure`."""
    run = tuple(cell for engine in engines for cell in cells(scene, (engine,), steps_for(engine, every), samples))
    return Failure(title, cells=run, columns=columns, **fields)


def described(source: str, *failures: Failure, **values: Any) -> tuple[Failure, ...]:
    """The experiments with their texts from `experiments.md` in the folder of the file `source`. A section consists of
    the experiment's title, a paragraph with the expectation, optional paragraphs with the lesson, and an optional list
    of claims (`reports.pages.claims`). All texts are templates with `values` and the experiment's context. A value
    that is a function is called when the page is written. Raises ValueError unless the sections have the titles of the
    experiments, in the same order."""
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
        computed = {name: value() if callable(value) else value for name, value in values.items()}
        return {**computed, **failure.context(material)}

    texts = [
        paragraph if paragraph.startswith("|") else " ".join(paragraph.split())
        for paragraph in paragraphs
        if not paragraph.startswith("- ")
    ]
    lists = [paragraph for paragraph in paragraphs if paragraph.startswith("- ")]
    claims = [line.removeprefix("- ") for claim_list in lists for line in claim_list.splitlines()]
    return replace(
        failure,
        expected=texts[0],
        remark="\n\n".join(texts[1:]),
        claims=tuple(claims),
        context=context if values else failure.context,
    )


def scene_page(
    name: str,
    *,
    scenes: tuple[Scene, ...],
    context: Callable[[Material], Mapping[str, Any]] = no_context,
    **fields: Any,
) -> Page:
    """A page on scenes. The template can look up rows of the scenes. `deviations.toml` has the known deviations.
    `context` adds variables for the template. `fields`: further fields of `Page`."""

    def with_lookups(material: Material) -> Mapping[str, Any]:
        return {**lookups(material, scenes), **context(material)}

    return Page(name=name, scenes=scenes, context=with_lookups, known=deviations(name), **fields)


@dataclass(frozen=True)
class MethodTask(Task):
    """A task that runs one method. `description` is a format string with the task as its argument."""

    description: ClassVar[str]

    method: Engine

    @property
    def label(self) -> str:
        return f"{method_name(self.method)}: {self.description.format(self)}"

    @property
    def engine(self) -> Engine:
        return self.method


def run_script(name: str, text: str) -> dict[str, Any]:
    """Run a script, discard its output, and return its global names."""
    names: dict[str, Any] = {"__name__": "__main__"}
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(text, name, "exec"), names)
    return names


def refusals(attempts: Mapping[str, Callable[[], object]]) -> list[Observation]:
    """The reference's error messages for invalid settings. Raises AssertionError if the reference accepts a setting."""
    observations = []
    for setting, attempt in attempts.items():
        try:
            attempt()
        except ValueError as error:
            observations.append(Observation("the reference", setting, f"refuses: {error}"))
        else:
            raise AssertionError(f"the reference accepted {setting}")
    return observations


def read_answers(
    material: Material, method: str, settings: Iterable[tuple[Task, str]], read: Callable[[Answer], str]
) -> list[Observation]:
    """An observation for each task that was run. The observation is `read(answer)` or the reason why the task did not
    finish."""
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
    """The known deviations of a page from `deviations.toml`, by (scene, method, check). A page without an
    entry, such as a third party's page, has no known deviations."""
    by_check: dict[tuple[str, str, str], Deviation] = {}
    for entry in _written_deviations().get(page, ()):
        scenes = dict(entry)
        reason, rounding = scenes.pop("reason"), scenes.pop("rounding", False)
        for scene, methods in scenes.items():
            for method, factors in methods.items():
                if isinstance(factors, str):
                    by_check[scene, method, "outcome"] = Deviation(reason, outcome=Outcome(factors))
                    continue
                for check, factor in factors.items():
                    by_check[scene, method, check] = Deviation(reason, factor, rounding=rounding)
    return by_check
