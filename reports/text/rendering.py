"""A page's material to its files, as texts by file name; nothing here writes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, FileSystemLoader, PrefixLoader, StrictUndefined, Template

from reference.scene import Scene
from reports.charts import stability as maps
from reports.charts import work_precision as charts
from reports.charts.theme import svg
from reports.grid.convergence import judged, sweeps
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.pages.page import Failure, Material, Page, StabilityMap
from reports.text import tables, unmeasured
from reports.text.overview import overview, with_overview
from reports.text.provenance import machine, today, versions

TEMPLATES = Path(__file__).parents[1] / "pages"


@dataclass(frozen=True)
class Told:
    """A failure or a map with its table or picture, ready for the template."""

    title: str
    expected: str
    grid: str
    details: str
    observations: str
    remark: str
    picture: str = ""


def environment(folder: Path = TEMPLATES) -> Environment:
    """Templates fail loudly on a name that has no value, and print a mark for a number that is not known.

    Those of another folder are found as "own/NAME"; so none of them hides "base.md".
    """
    out = Environment(
        loader=ChoiceLoader([FileSystemLoader(TEMPLATES), PrefixLoader({"own": FileSystemLoader(folder)})]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
        finalize=unmeasured.marked,
    )
    out.filters |= unmeasured.FILTERS
    return out


def template_of(page: Page) -> Template:
    """The page's own template, that of its name here, or the generic one."""
    if page.template is not None:
        return environment(page.template.parent).get_template(f"own/{page.template.name}")
    return environment().select_template([f"{page.name}/page.md", "base.md"])


def parameters(scene: Scene) -> str:
    """A table of the scene's fields, which are the only place where its numbers stand."""
    body = [[field.name, _value(getattr(scene, field.name))] for field in fields(scene)]  # type: ignore[arg-type]
    return tables.markdown(["parameter", "value"], body)


def _value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(_value, value)) + ")"
    return str(value)


def render_page(page: Page, material: Material, command: str) -> dict[str, str]:
    """The page's Markdown and its SVG pictures by file name.

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
    scenes = [_told_scene(scene, [row for row in rows if row.scene == scene.name], page) for scene in page.scenes]
    text = template_of(page).render(
        page=page,
        scenes=scenes,
        pictures=unmeasured.Known(pictures),
        failures=[_told_failure(failure, material) for failure in page.failures],
        maps=[told for told in told_maps if told],
        outcomes=[outcome for outcome in Outcome if outcome in met],
        foot=foot(command),
        **page.words(material),
    )
    return files | {f"{page.name}.md": unmeasured.without_marks(text)}


def _told_scene(scene: Scene, rows: list[Measurement], page: Page) -> dict[str, Any]:
    """The scene's tables: of the page's featured methods, and of `all` of them where there are others."""
    told = [row for row in rows if row.outcome == Outcome.UNSUPPORTED]
    featured = [row for row in rows if page.featured(row)]
    return {
        **_compared(featured, page.quantity),
        "all": _compared(rows if len(featured) < len(rows) else [], page.quantity),
        "name": scene.name,
        "source": scene.source,
        "summary": " ".join((type(scene).__doc__ or "").split("\n\n")[0].split()),
        "parameters": parameters(scene),
        "errors": tables.error_table(rows),
        "sizes": tables.size_table(rows),
        "unsupported": [(row.method, row.sentence) for row in told if row.every == min(r.every for r in told)],
        "missing": not rows,
    }


def _compared(rows: list[Measurement], quantity: str) -> dict[str, str]:
    """The tables that compare methods; empty without rows."""
    if not rows:
        return {"orders": "", "work": "", "reactions": ""}
    return {
        "orders": tables.order_table(sweeps(rows)),
        "work": tables.work_table(rows, quantity),
        "reactions": tables.reaction_table(rows),
    }


def _told_failure(failure: Failure, material: Material) -> Told:
    rows = material.of(failure.cells)
    seen = failure.observations() if failure.observations else ()
    observations = tables.markdown(
        ["method", "setting", "outcome"], [[o.method, o.setting, o.outcome] for o in seen], left=3
    )
    grid = tables.cell_table(rows, failure.columns) if failure.columns else tables.outcome_grid(rows)
    return Told(
        failure.title,
        failure.expected,
        grid if rows else "",
        tables.outcome_table(rows) if any(row.sentence for row in rows) else "",
        observations if seen else "",
        failure.remark,
    )


def _told_map(page: Page, picture: StabilityMap, material: Material, keep: Any) -> Told | None:
    rows = [(value, material.rows[cell]) for value, cell in picture.cells if cell in material.rows]
    if not rows:
        return None
    keep(picture.name, svg(maps.stability_map(rows, picture.parameter), picture.title))
    return Told(picture.title, "", "", "", "", picture.remark, f"{page.name}_{picture.name}.svg")


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
