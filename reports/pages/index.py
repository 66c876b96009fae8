"""The index of all pages with what users see go wrong, in their words; and the readme's parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

from engines import Engine
from reports.model.cells import USUAL_STEPS
from reports.model.convergence import judged
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages import comparison
from reports.pages.findings import findings
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.write import unmeasured
from reports.write.columns import BUDGET, equal_cost, equal_error, equal_step
from reports.write.page_tables import TARGETS
from reports.write.provenance import machine, versions
from reports.write.templates import environment, inert_page, link, with_part


@dataclass(frozen=True)
class Symptom:
    """`seen` as a user would say it, a short `answer`, and the page that has the rest, under `heading` if not empty."""

    seen: str
    answer: str
    page: str
    heading: str


@cache
def symptoms() -> tuple[Symptom, ...]:
    """The table of `symptoms.md`."""
    _, _, *lines = Path(__file__).with_name("symptoms.md").read_text(encoding="utf-8").splitlines()
    return tuple(Symptom(*(cell.strip() for cell in line.strip("|").split("|"))) for line in lines)


def foot(command: str, engines: Iterable[Engine] = ()) -> str:
    """What the page was made with, its engines that are not registered included."""
    return f"Made by `{command}` with {versions(engines)}; timings on {machine()}."


def engines_of(pages: Iterable[Page]) -> list[Engine]:
    """Every engine that these pages compare."""
    return list(dict.fromkeys(engine for page in pages for engine in page.engines))


def render_index(pages: Mapping[Page, Material], command: str, files: Mapping[str, str] = MappingProxyType({})) -> str:
    """The index: findings, symptoms, every scene in a line, every page with its lesson. `files`: what is beside it."""
    entries = [
        (page, judged([*material.sweep(page.scenes), *material.usual(page.scenes)], page.quantity))
        for page, material in pages.items()
    ]
    known = {page.name for page in pages}
    text = (
        environment()
        .get_template("index.md")
        .render(
            pages=list(pages),
            titles={page.name: page.title for page in pages},
            findings=findings(pages),
            symptoms=[(each, link(each.page, each.heading, files)) for each in symptoms() if each.page in known],
            compared=comparison.table(comparison.compared_lines(pages)),
            equal_cost=equal_cost(entries),
            equal_error=equal_error(entries),
            equal_step=equal_step(entries),
            budget=1e3 * BUDGET,
            targets=TARGETS,
            steps=list(USUAL_STEPS),
            outcomes=list(Outcome),
            files=files,
            foot=foot(command, engines_of(pages)),
        )
    )
    return inert_page(unmeasured.without_marks(text))


def render_readme(text: str, pages: Mapping[Page, Material]) -> str:
    """The readme with the lines of `your_loop` and their errors. Nothing in it depends on timings.

    Raises ValueError where the marks of the part are missing.
    """
    material = next((given for page, given in pages.items() if page.name == YOUR_LOOP.name), Material({}))
    told = environment().get_template(f"{YOUR_LOOP.name}/readme.md").render(dict(YOUR_LOOP.context(material)))
    return with_part(text, "loop", unmeasured.without_marks(told).strip())
