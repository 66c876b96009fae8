"""A page's material to its files, as texts by file name; nothing here writes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

from engines import Engine, registry
from reference.scene import Scene
from reports.model.convergence import judged
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.usual_steps import USUAL_STEPS
from reports.pages.atlas.subjects import SUBJECTS
from reports.pages.findings.findings import findings, pictures
from reports.pages.symptoms import SYMPTOMS
from reports.pages.told_scene import told_scene
from reports.plots import work_precision as charts
from reports.plots.theme import svg
from reports.write import unmeasured
from reports.write.csv_files import as_csv, descriptions_csv
from reports.write.experiments import told_experiment
from reports.write.holders import holders
from reports.write.links import link
from reports.write.overview import overviews
from reports.write.parts import with_part
from reports.write.provenance import machine, row_versions, today, versions
from reports.write.templates import environment, inert_page, template_of

FEW = 100  # steps: a scene of fewer is no example of a step


def render_page(page: Page, material: Material, command: str) -> dict[str, str]:
    """The page's Markdown, that of its data page where it has scenes, and its SVG pictures, by file name.

    Raises jinja2.UndefinedError when the template names what the page does not give.
    """
    rows = judged(material.sweep(page.scenes), page.quantity)
    met = {row.outcome for row in (*rows, *material.of(page.extra_cells()))}
    files: dict[str, str] = {}
    pictures: dict[str, str] = {}

    def keep(name: str, text: str) -> None:
        files[f"{page.name}_{name}.svg"] = text
        pictures[name] = f"{page.name}_{name}.svg"

    drawable = charts.drawable(rows, page.quantity)
    if any(row.cpu > 0 for row in drawable):
        keep(
            "work",
            svg(charts.work_precision(rows, page.featured, page.quantity), f"{page.title}: error against CPU time"),
        )
    if any(page.featured(row) for row in drawable):
        keep(
            "steps",
            svg(charts.error_against_step(rows, page.featured, page.quantity), f"{page.title}: error against step"),
        )
    for name, text in page.figures(material).items():
        keep(name, text)
    scenes = [
        told_scene(scene, [row for row in rows if row.scene == scene.name], page, material) for scene in page.scenes
    ]
    given = {
        "page": page,
        "scenes": scenes,
        "advised": next((scenes[i] for i, scene in enumerate(page.scenes) if scene is page.advised_scene), None),
        "pictures": unmeasured.Known(pictures),
        "failures": [told_experiment(failure, material, holders(failure.cells)) for failure in page.failures],
        "maps": [subject for subject in SUBJECTS if subject.page == page.name],
        "outcomes": [outcome for outcome in Outcome if outcome in met],
        "foot": foot(command, (*page.engines, *registry.INSTALLED)),
        **page.words(material),
    }
    texts = {f"{page.name}.md": template_of(page, "page.md", "base.md").render(given)}
    if page.scenes:
        texts[page.data_page] = template_of(page, "data.md", "data.md").render(given)
    return files | {name: inert_page(unmeasured.without_marks(text)) for name, text in texts.items()}


def foot(command: str, engines: Iterable[Engine] = ()) -> str:
    """What the page was made with, its engines that are not registered included."""
    return f"Made by `{command}` with {versions(engines)}; timings on {machine()}."


def engines_of(pages: Iterable[Page]) -> list[Engine]:
    """Every engine that these pages compare."""
    return list(dict.fromkeys(engine for page in pages for engine in page.engines))


def render_index(pages: Mapping[Page, Material], command: str, files: Mapping[str, str] = MappingProxyType({})) -> str:
    """The index: findings, symptoms, every scene in a line, every page with its lesson. `files`: what is beside it."""
    entries = [(page, _overview_rows(page, material, page.scenes)) for page, material in pages.items()]
    told = findings(pages)
    known = {page.name for page in pages}
    text = (
        environment()
        .get_template("index.md")
        .render(
            pages=list(pages),
            titles={page.name: page.title for page in pages},
            findings=[found for found in told if found.page in known],
            symptoms=[(each, link(each.page, each.heading, files)) for each in SYMPTOMS if each.page in known],
            overviews=overviews(entries),
            steps=list(USUAL_STEPS),
            outcomes=list(Outcome),
            files=files,
            foot=foot(command, engines_of(pages)),
        )
    )
    return inert_page(unmeasured.without_marks(text))


def _overview_rows(page: Page, material: Material, scenes: Sequence[Scene]) -> list[Measurement]:
    return judged([*material.sweep(scenes), *material.usual(scenes)], page.quantity)


def render_readme(text: str, pages: Mapping[Page, Material]) -> str:
    """The readme with its parts: what was found, and the line of each page's first scene in engines as shipped and set.

    Nothing in it depends on timings. A scene that is over within a hundred of the steps is left to the index: at such a
    step nobody would run it. Raises ValueError where the marks of a part are missing.
    """
    step = USUAL_STEPS["1 ms"]
    firsts = [
        (page, _overview_rows(page, material, page.scenes[:1]))
        for page, material in pages.items()
        if page.scenes and page.scenes[0].duration > FEW * step
    ]
    shipped = {(row.engine, row.variant) for _, rows in firsts for row in rows}
    told = overviews(firsts, {"1 ms": step}, "reports/results/")
    text = with_part(text, "findings", "\n".join(f"- {found.title}." for found in findings(pages)))
    return with_part(text, "overview", "\n\n".join(told[engine] for engine in told if (engine, "default") in shipped))


def render_all(
    pages: Mapping[Page, Material],
    command: str,
    further: Mapping[str, str] = MappingProxyType({}),
    made: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
) -> dict[str, str]:
    """Every file of the results by name; only timings.csv and the pages' CPU columns differ between machines.

    `further`: files of another kind beside them, which the index may name. `made`: what `render_page` gives, by the
    names of the pages for which that was done already.
    """
    files: dict[str, str] = dict(further)
    rows: dict[str, Measurement] = {}
    made_by: dict[str, Engine] = {}
    for page, material in pages.items():
        files.update(made[page.name] if page.name in made else render_page(page, material, command))
        rows.update({row.key: row for row in material.rows.values()})
        made_by.update({row.key: cell.engine for cell, row in material.rows.items()})
    files |= pictures(findings(pages))
    files["index.md"] = render_index(pages, command, files)
    # A stored row counts only where the versions are those that it was made with, so these are its own.
    of_engine = {engine: row_versions(engine) for engine in dict.fromkeys(made_by.values())}
    own_versions = {key: of_engine[engine] for key, engine in made_by.items()}
    files["errors.csv"] = as_csv(rows.values(), timings=False, made_with=own_versions)
    made_with = versions(engines_of(pages))
    header = f"{today()}\n{machine()}\n{made_with}\n{command}\nCPU seconds: cpu per simulated second; build once"
    files["descriptions.csv"] = descriptions_csv(rows.values(), own_versions)
    files["timings.csv"] = as_csv(rows.values(), timings=True, header=header)
    return files
