"""Builds the files of the site from Markdown pages, stored motions and fetched packages."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from engines import Unsupported
from engines.lagrange import Lagrange
from reference.scene import Scene
from reports.model.outcomes import Outcome
from reports.model.tasks import Answer, Motion
from reports.plots.looks import family_of, role
from reports.site.animated import animation, shown
from reports.site.generator import Documents, Extra, build_html, colours, lighten, quote_section, reference_sources
from reports.site.lesson import Experiment, Guess, Lesson, LessonQuantity
from reports.site.lessons import LESSONS, PROBLEMS
from reports.site.live.data import data, first_picture
from reports.site.live.models import own_values
from reports.site.live.scenes import FREE, take_like
from reports.site.live.sliders import ENGINES, NAMES, SHIPPED, Live
from reports.site.markdown import render_html, render_lecture, section, title
from reports.site.munk2d import COMPILED, compiled_from
from reports.site.packages import D3, MUJOCO, PACKAGES, PLOT, NotFetched, Package, fetch_package
from reports.write.columns import COLUMN_OF_VARIANT
from reports.write.csv_files import read_lines
from reports.write.templates import CODE, inert_page

HERE = Path(__file__).parent
MARKER = "site.json"
# A link to a file. Links to pictures are excluded, since Sphinx resolves them.
FILE_LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((?![a-z]+:|#)([^)#\s]+)(#[^)]*)?\)")
DRAGGED = re.compile(r"\{(\w+)\}")  # name of a control in braces, in the text of a lesson
TEMPLATES = jinja2.Environment(undefined=jinja2.StrictUndefined, trim_blocks=True, keep_trailing_newline=True)
ENGINE_FILES = {"munk2d": "packages/munk2d.js", "mujoco": "packages/mujoco.js"}

# Columns of results/rows.json.
COLUMNS = ("scene", "engine", "variant", "outcome", "settings", "step")
NUMBERS = ("position", "angle", "velocity", "gap", "energy", "reaction")
ROW_KEY = ("scene", "engine", "variant", "purpose", "parameters", "settings", "samples", "every")

Files = dict[str, bytes]


@dataclass
class SiteSource:
    """The input of a site. Files are given as name -> text."""

    pages: Mapping[str, str]
    pictures: Mapping[str, str]
    tables: Mapping[str, str]  # CSV files and programs
    answers: Mapping[Motion, Answer]
    cache: Path
    foot: str
    contributing: str = ""  # Text of CONTRIBUTING.md, from which pages quote; empty outside of a checkout.
    api: bool = True  # Whether the site has a reference from docstrings, which takes a minute to build.
    lecture: str = ""  # The notebook as JSON.
    troubles: list[str] = field(default_factory=list)  # A message for each missing file.


def tasks(lessons: Iterable[Lesson] = LESSONS) -> tuple[Motion, ...]:
    """Return all motions of the lessons without duplicates."""
    return tuple(dict.fromkeys(task for lesson in lessons for live in lesson.scenes for task in live.stored().values()))


def build(source: SiteSource, lessons: Iterable[Lesson] = LESSONS) -> Files:
    """Return every file of the site by its path. Raises BadInput if packages of the extra `site` are missing."""
    lessons = tuple(lessons)
    extra = _extra_files(source, lessons)
    documents = _documents(source, lessons)

    context = {"lessons": _grouped(lessons), "foot": source.foot, "colours": Markup(colours())}

    def add_pages(app: Any) -> Iterator[Extra]:
        for lesson in lessons:
            engines = [name for name, path in ENGINE_FILES.items() if path in extra]
            values = _lesson_context(lesson, partial(quote_section, app, lesson.page))
            given = {"up": "../", "engines": engines, "missing": _without(source, MUJOCO)}
            yield f"lessons/{lesson.name}", {**values, **given}, "lesson.html"
        missing = [*_without(source, D3), *_without(source, PLOT)]
        given = {"title": "All stored rows", "up": "../", "charts": not missing, "missing": missing[:1]}
        yield "results/rows", given, "explorer.html"

    files, warnings = build_html(Documents(documents, extra, context, add_pages))
    source.troubles += warnings
    pages = sorted(name for name in files if name.endswith(".html"))
    files[MARKER] = json.dumps({"pages": pages, "troubles": source.troubles}, indent=1).encode()
    return files


def _grouped(lessons: tuple[Lesson, ...]) -> dict[str, list[tuple[str, str]]]:
    """Return pairs (name, title) of the lessons by the type of problem."""
    wanted = {lesson.name for lesson in lessons}
    groups = {
        problem: [(lesson.name, lesson.title) for lesson in group if lesson.name in wanted]
        for problem, group in PROBLEMS.items()
    }
    return {problem: group for problem, group in groups.items() if group}


def _extra_files(source: SiteSource, lessons: tuple[Lesson, ...]) -> Files:
    """Return scripts, packages, data of the lessons and tables. A missing package is reported in `source.troubles`."""
    files: Files = {path.name: path.read_bytes() for path in sorted((HERE / "assets").iterdir())}
    files["front.svg"] = _front_picture(source).encode()
    files[ENGINE_FILES["munk2d"]] = COMPILED.read_bytes()
    release, _ = compiled_from(COMPILED.read_text(encoding="utf-8"))
    if release != version("pymunk"):
        source.troubles.append(f"The page runs pymunk {release}, and Python has pymunk {version('pymunk')}.")
    for package in PACKAGES:
        try:
            files |= fetch_package(package, source.cache)
        except NotFetched as reason:
            source.troubles.append(f"Built without {package.name} ({package.use}): {reason}.")
    for live in {live.key: live for lesson in lessons for live in lesson.scenes}.values():
        files[f"live/{live.key}.json"] = _json(data(live, source.answers))
    files |= {f"results/{name}": text.encode() for name, text in source.tables.items()}
    csv = [source.tables.get(f"{name}.csv", "") for name in ("errors", "timings", "descriptions")]
    files["results/rows.json"] = _json(explored(*csv))
    return files


def _without(source: SiteSource, package: Package) -> list[str]:
    """Return the sentence on a missing package as a list; empty if the package is present."""
    return [trouble for trouble in source.troubles if trouble.startswith(f"Built without {package.name} ")]


def explored(errors: str, timings: str, descriptions: str) -> dict[str, Any]:
    """Return all rows of sweeps for the page of charts, from the texts of three CSV files. A missing number is None.

    "cpu" is the CPU time per simulated second [s]. "looks" has the role of each engine's colour and whether it is an
    exact solver. "headings" has the names of variants.
    """
    times, texts = _by(timings, *ROW_KEY), _by(descriptions, "digest")
    rows = []
    for row in read_lines(errors)[1] if errors else ():
        if row["purpose"] == "sweep":
            cost = times.get(tuple(row[name] for name in ROW_KEY), {}).get("cpu", "nan")
            settings = texts.get((row["settings"],), {}).get("description", "")
            numbers = [float(text or "nan") for text in (*(row[name] for name in NUMBERS), cost)]
            finite = [value if math.isfinite(value) else None for value in numbers]
            rows.append([*(row[name] for name in COLUMNS[:4]), settings, float(row["step"]), *finite])
    names = sorted({row[1] for row in rows})
    looks = {name: {"role": role(family_of(name), names), "exact": name == Lagrange.name} for name in names}
    headings = {name: column.value for name, column in COLUMN_OF_VARIANT.items()}
    return {"columns": [*COLUMNS, *NUMBERS, "cpu"], "rows": rows, "looks": looks, "headings": headings}


def _by(text: str, *key: str) -> dict[tuple[str, ...], dict[str, str]]:
    return {tuple(row[name] for name in key): row for row in read_lines(text)[1]} if text else {}


def _json(value: object) -> bytes:
    return json.dumps(value, separators=(",", ":"), allow_nan=False).encode()


def _documents(source: SiteSource, lessons: tuple[Lesson, ...]) -> Files:
    texts = {f"results/{name}": inert_page(text) for name, text in source.pages.items()}
    guides = {path.stem: path.read_text(encoding="utf-8") for path in sorted((HERE / "howto").glob("*.md"))}
    quoted = {
        "contributing": lambda part: section(source.contributing, part) or "See CONTRIBUTING.md in the repository.",
        "meanings": {str(outcome): outcome.meaning for outcome in Outcome},
    }
    texts |= {f"howto/{name}.md": TEMPLATES.from_string(text).render(quoted) for name, text in guides.items()}
    links = {"../../README.md": "../index.md", "../../CONTRIBUTING.md": "../howto/index.md"}
    links |= {f"../results/{page.removesuffix('.md')}.html": f"../results/{page}" for page in source.pages}
    files = {name: _with_links(text, links, source.pages).encode() for name, text in texts.items()}
    files |= {f"results/{name}": lighten(picture).encode() for name, picture in source.pictures.items()}
    try:
        lecture = render_lecture(source.lecture) if source.lecture else {}
    except NotFetched as reason:
        source.troubles.append(f"Built without the lecture: {reason}.")
        lecture = {}
    files |= {name: text.encode() for name, text in lecture.items()}
    if source.api:
        files |= reference_sources()
    files["howto/index.md"] = _rendered("guides.md", guides=[(name, title(text)) for name, text in guides.items()])
    results = [(name.removesuffix(".md"), title(text)) for name, text in source.pages.items()]
    trees = {"Results": [f"results/{name}" for name, _ in results if name != "index"], "More": ["howto/index", "about"]}
    trees["More"] += ["lecture"] * bool(lecture) + ["reference/index"] * source.api
    missing = _without(source, MUJOCO)
    files["index.md"] = _rendered("front.md", lessons=_grouped(lessons), results=results, trees=trees, missing=missing)
    files["about.md"] = _rendered("about.md", missing=source.troubles, packages=PACKAGES, foot=source.foot)
    return files


def _with_links(text: str, moved: Mapping[str, str], documents: Iterable[str]) -> str:
    """Return a page with links to documents of the site. A link to any other file becomes HTML."""
    for old, new in moved.items():
        text = text.replace(f"({old}", f"({new}")

    def link(match: re.Match[str]) -> str:
        is_document = Path(match[2]).name in documents or match[2].startswith("../")
        if is_document and match[2].endswith(".md"):
            return match[0]
        return f'<a href="{match[2]}{match[3] or ""}">{match[1]}</a>'

    parts = CODE.split(text)
    return "".join(part if index % 2 else FILE_LINK.sub(link, part) for index, part in enumerate(parts))


def _rendered(name: str, **values: Any) -> bytes:
    """Return a Markdown document of the site from its template in this folder."""
    return TEMPLATES.from_string((HERE / name).read_text(encoding="utf-8")).render(values).encode()


def _lesson_context(lesson: Lesson, quote: Callable[[str], str | None]) -> dict[str, Any]:
    """Return the values of lesson.html; `quote` returns the HTML of a section of the results page."""
    parts = []
    for experiment in lesson.experiments:
        live = lesson.scene(experiment.scene)
        start = live.located(experiment.before)
        values, words = _start_texts(live, experiment), live.words()
        guesses = experiment.guesses or (Guess(),) * len(experiment.answers)  # without a change nothing is run
        body = quote(experiment.section) if experiment.section else None
        parts.append(
            {
                "heading": experiment.heading,
                "text": _with_drags(experiment.text, values, words),
                "question": Markup(render_html(experiment.question).removeprefix("<p>").removesuffix("</p>\n")),
                "answers": [_answer(live, *each) for each in zip(experiment.answers, guesses, strict=True)],
                "after_words": _with_drags(experiment.after_words, values, words),
                "scene": lesson.scenes.index(live),
                "before": start,
                "after": live.located(experiment.after),
                "shown": " ".join(
                    ("paths", *experiment.overlays, *(() if "centre" in experiment.overlays else ("enlarged",)))
                ),
                "quantities": [quantity_data(live, each) for each in experiment.quantities],
                "more": None if body is None else {"heading": experiment.section, "body": Markup(body)},
                "widget": experiment.widget,
            }
        )
    return {
        "title": lesson.title,
        "lesson": lesson,
        "parts": parts,
        "render": lambda text: Markup(render_html(text)),
        "scenes": [{"key": live.key, "fields": [slider.field for slider in live.sliders]} for live in lesson.scenes],
        "picture": Markup(first_picture(lesson.scene(lesson.experiments[0].scene))),
        "settings": ENGINES,
        "names": NAMES,
    }


def _answer(live: Live, answer: tuple[str, bool], guess: Guess) -> dict[str, Any]:
    """Return an answer for the template; `change` has the positions of the sliders that it proposes."""
    change = None if guess.change is None else live.located(guess.change)
    return {"words": answer[0], "right": answer[1], "change": change, "times": guess.times, "of": guess.of or ""}


def quantity_data(live: Live, quantity: LessonQuantity) -> dict[str, Any]:
    """Return a quantity for the page, with the indices of its bodies."""
    mechanism = live.scene.mechanism()
    bodies = [mechanism.body_index(body) for body in quantity.bodies]
    return {"kind": quantity.kind, "words": quantity.words, "bodies": bodies}


def _start_texts(live: Live, experiment: Experiment) -> dict[str, str]:
    """Return the texts of all controls before a question; a value that the method chooses is a number, too."""
    controls, start = live.controls(), live.located(experiment.before)
    place = {name: start.get(name, control.start) for name, control in controls.items()}
    changed: Any = {slider.field: slider.values[place[slider.field]] for slider in live.sliders}
    scene: Scene = replace(live.scene, **changed)  # type: ignore[type-var]
    munk, mujoco = (live.methods(name)[place[name]][1] for name in ENGINES)
    step = scene.duration / live.steps[place["steps"]]
    try:
        own = own_values(munk, mujoco, scene.mechanism(), step, scene.duration)
    except Unsupported:
        own = {}
    texts = {name: control.texts[place[name]] for name, control in controls.items()}
    return {
        name: own.get(name, text) if controls[name].values[place[name]] is None else text
        for name, text in texts.items()
    }


def _with_drags(text: str, values: Mapping[str, str], words: Mapping[str, str]) -> Markup:
    """Return the HTML of a text; the name of a control in braces becomes a number that the reader can drag."""
    number = (
        '<span class="drag" role="slider" tabindex="0" data-name="{0}" aria-label="{2}" aria-valuemin="0" '
        'aria-valuenow="0" aria-valuetext="{1}">{1}</span>'
    )

    def drag(match: re.Match[str]) -> str:
        return number.format(match[1], escape(values[match[1]]), escape(words[match[1]]))

    return Markup(DRAGGED.sub(drag, render_html(text)))


def _front_picture(source: SiteSource) -> str:
    stored = FREE.stored()
    cells = {label: stored[name, 0].cell for name, label in NAMES.items()}
    methods = tuple((f"{label} {SHIPPED}", cell.engine, cell.every) for label, cell in cells.items())
    take = replace(take_like(FREE.scene, methods), samples=FREE.frames)
    return animation(shown(take, source.answers), "A four-bar linkage falls")
