"""A page's material to its files, as texts by file name; nothing here writes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from reports.charts import stability as maps
from reports.charts import work_precision as charts
from reports.charts.theme import svg
from reports.grid.convergence import judged
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.pages.page import Material, Page, StabilityMap
from reports.text import tables, unmeasured
from reports.text.experiments import told_experiment
from reports.text.holders import holders
from reports.text.links import anchor
from reports.text.overview import overview, with_overview
from reports.text.provenance import machine, today, versions
from reports.text.told_scene import told_scene

TEMPLATES = Path(__file__).parents[1] / "pages"


def environment() -> Environment:
    """Templates fail loudly on a name that has no value, and print a mark for a number that is not known."""
    out = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
        finalize=unmeasured.marked,
    )
    out.filters |= unmeasured.FILTERS | {"anchor": anchor}
    return out


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
    told_maps = [_told_map(page, picture, material, keep) for picture in page.maps]
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
        "maps": [told for told in told_maps if told],
        "outcomes": [outcome for outcome in Outcome if outcome in met],
        "foot": foot(command),
        **page.words(material),
    }
    texts = {f"{page.name}.md": _written([f"{page.name}/page.md", "base.md"], given)}
    if page.scenes:
        texts[page.data_page] = _written([f"{page.name}/data.md", "data.md"], given)
    return files | texts


def _written(templates: list[str], given: Mapping[str, Any]) -> str:
    return unmeasured.without_marks(environment().select_template(templates).render(given))


def _told_map(page: Page, picture: StabilityMap, material: Material, keep: Any) -> dict[str, str] | None:
    rows = [(value, material.rows[cell]) for value, cell in picture.cells if cell in material.rows]
    if not rows:
        return None
    keep(picture.name, svg(maps.stability_map(rows, picture.parameter), picture.title))
    return {"title": picture.title, "remark": picture.remark, "picture": f"{page.name}_{picture.name}.svg"}


def foot(command: str) -> str:
    """What the page was made with."""
    return f"Made by `{command}` with {versions()}; timings on {machine()}."


def render_index(pages: Iterable[tuple[Page, Material]], command: str) -> str:
    """The index: every scene in a line, then every page with its lesson."""
    pages = list(pages)
    return (
        environment()
        .get_template("index.md")
        .render(
            pages=[page for page, _ in pages],
            overview=overview((page, judged(material.sweep(page.scenes), page.quantity)) for page, material in pages),
            outcomes=list(Outcome),
            foot=foot(command),
        )
    )


def render_readme(text: str, pages: Mapping[Page, Material]) -> str:
    """The readme with the line of each page's first scene in it; raises ValueError where its marks are missing."""
    firsts = [(page, judged(material.sweep(page.scenes[:1]), page.quantity)) for page, material in pages.items()]
    return with_overview(text, overview(firsts, "reports/results/"))


def render_all(pages: Mapping[Page, Material], command: str) -> dict[str, str]:
    """Every file of the results by name; only timings.csv and the pages' CPU columns differ between machines."""
    files: dict[str, str] = {}
    rows: dict[str, Measurement] = {}
    for page, material in pages.items():
        files.update(render_page(page, material, command))
        rows.update({row.key: row for row in material.rows.values()})
    files["index.md"] = render_index(pages.items(), command)
    files["errors.csv"] = tables.as_csv(rows.values(), timings=False)
    header = f"{today()}\n{machine()}\n{versions()}\n{command}\nCPU seconds: cpu per simulated second; build once"
    files["descriptions.csv"] = tables.descriptions_csv(rows.values())
    files["timings.csv"] = tables.as_csv(rows.values(), timings=True, header=header)
    return files
