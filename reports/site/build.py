"""The whole site as files by name, from rendered Markdown pages, stored motions, and packages that were fetched."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import jinja2
from markupsafe import Markup

from reports.grid.tasks import Answer, Motion
from reports.site import live, markdown
from reports.site.embed import data, picture, shown
from reports.site.formulas import rendered
from reports.site.lesson import Lesson
from reports.site.lessons import LESSONS
from reports.site.markdown import Formulas
from reports.site.munk2d.compiling import compiled
from reports.site.packages import NotFetched, Package, fetched
from reports.site.packages_used import D3, KATEX, MUJOCO, PLOT
from reports.site.reference_pages import reference_pages
from reports.site.rows import explored, stored_rows
from reports.site.style import colours

HERE = Path(__file__).parent
ASSETS = HERE / "assets"
MARKER = "site.json"
OWN_FILE = re.compile(r'(href|src)="(?!https?:|#|mailto:|\.\./)([^"]+)"')
CHART_TITLE = re.compile(r"<h1[^>]*>(.*?)</h1>", re.DOTALL)

Files = dict[str, bytes]


@dataclass
class Source:
    """What a site is built from: Markdown pages and pictures by file name, and the answers to the lessons' tasks."""

    pages: Mapping[str, str]
    pictures: Mapping[str, str]
    tables: Mapping[str, str]  # CSV files by name
    answers: Mapping[Motion, Answer]
    cache: Path
    foot: str
    contributing: str = ""  # CONTRIBUTING.md, of which how-to pages quote parts; empty outside of a checkout
    api: bool = True  # whether pdoc makes the reference, which takes some ten seconds
    troubles: list[str] = field(default_factory=list)  # what could not be built, and why, a sentence each


def tasks(lessons: Iterable[Lesson] = LESSONS) -> tuple[Motion, ...]:
    """All motions that the lessons show, each once."""
    return tuple(dict.fromkeys(task for lesson in lessons for task in lesson.tasks()))


def build(source: Source, lessons: Iterable[Lesson] = LESSONS) -> Files:
    """Every file of the site, by its path in it."""
    lessons = tuple(lessons)
    formulas = Formulas()
    taken = _packages((D3, PLOT), source)
    running, missing = _engines(source, any(lesson.live for lesson in lessons))
    environment = _environment()
    pages: dict[str, str] = {}
    files: Files = {path.relative_to(ASSETS).as_posix(): path.read_bytes() for path in _assets()}
    files["colours.css"] = colours().encode()
    files |= taken | running
    names = {name.removesuffix(".md"): name.removesuffix(".md") + ".html" for name in source.pages}

    def write(path: str, template: str, **given: object) -> None:
        up = "../" * path.count("/")
        text = environment.get_template(template).render(
            up=up, path=path, lessons=lessons, foot=source.foot, charts="packages/plot.min.js" in taken, **given
        )
        pages[path] = text

    for name, text in source.pages.items():
        body = markdown.linked(markdown.html(text, formulas), names, _elsewhere)
        title = CHART_TITLE.search(body)
        title_text = re.sub(r"<[^>]+>", "", title[1]) if title else name
        write(f"results/{names[name.removesuffix('.md')]}", "article.html", title=title_text, body=Markup(body))
    for lesson in lessons:
        write(
            f"lessons/{lesson.name}.html",
            "lesson.html",
            **_lesson(lesson, source, formulas, names),
            **_running(running, missing),
        )
    api = _reference(source)
    files |= api
    guides = [(path.stem, path.read_text(encoding="utf-8")) for path in sorted((HERE / "howto").glob("*.md"))]
    below = {f"../results/{name}": f"../results/{page}" for name, page in names.items()}
    for name, text in guides:
        told = environment.from_string(text).render(contributing=lambda part: Markup(_quoted(source, part)))
        body = markdown.linked(markdown.html(told, formulas), below, _elsewhere)
        write(f"howto/{name}.html", "article.html", title=_title(text), body=Markup(body))
    titles = [(name, _title(text)) for name, text in guides]
    write("howto/index.html", "howto.html", title="How to", guides=titles, api=bool(api))
    write("results/rows.html", "explorer.html", title="All stored rows")
    write("index.html", "index.html", title="How far from ideal?", **_front(lessons, source))
    listed, why = rendered(formulas, source.cache)
    if why:
        source.troubles.append(f"Formulas are shown as TeX, since {why}.")
    write(
        "about.html",
        "about.html",
        title="About this site",
        packages=(D3, PLOT, MUJOCO, KATEX),
        troubles=source.troubles,
    )
    files |= {path: markdown.with_formulas(text, listed).encode() for path, text in pages.items()}
    files |= {f"results/{name}": text.encode() for name, text in {**source.pictures, **source.tables}.items()}
    csv = [source.tables.get(f"{name}.csv", "") for name in ("errors", "timings", "descriptions")]
    files["results/rows.json"] = json.dumps(explored(*csv), separators=(",", ":"), allow_nan=False).encode()
    files[MARKER] = json.dumps({"pages": sorted(pages), "troubles": source.troubles}, indent=1).encode()
    return files


def _packages(packages: Iterable[Package], source: Source) -> Files:
    found: Files = {}
    for package in packages:
        try:
            content = fetched(package, source.cache)
        except NotFetched as reason:
            source.troubles.append(f"Built without {package.name} ({package.use}): {reason}.")
            continue
        found |= {name: content[path] for path, name in package.files if name}
    return found


def _engines(source: Source, wanted: bool) -> tuple[Files, list[str]]:
    """The files with which pages run engines themselves, and what to say of those that are missing."""
    files: Files = {}
    missing = []
    if not wanted:
        return files, missing
    try:
        content = fetched(MUJOCO, source.cache)
        files |= {name: content[path] for path, name in MUJOCO.files}
    except NotFetched as reason:
        missing.append(f"This site was built without MuJoCo: {reason}.")
    try:
        files["packages/munk2d.js"] = compiled(source.cache)
    except NotFetched as reason:
        missing.append(f"This site was built without Munk2D, the engine in pymunk: {reason}.")
    source.troubles += missing
    if files:
        files["live/four_bar.json"] = json.dumps(live.data(), separators=(",", ":")).encode()
        files["live/rows.json"] = json.dumps(stored_rows(source.tables.get("errors.csv", ""))).encode()
    return files, missing


def _reference(source: Source) -> Files:
    if not source.api:
        return {}
    try:
        return reference_pages()
    except NotFetched as reason:
        source.troubles.append(f"Built without the reference: {reason}.")
        return {}


def _quoted(source: Source, part: str) -> str:
    """A part of CONTRIBUTING.md; where that is not there, a sentence that says so."""
    if not source.contributing:
        return "The steps stand in CONTRIBUTING.md of the checkout."
    return markdown.section(source.contributing, part)


def _running(files: Files, missing: list[str]) -> dict[str, object]:
    """What a page says of the engines that it can run."""
    known = {"packages/munk2d.js": ("munk2d", "Munk2D"), "packages/mujoco.js": ("mujoco", "MuJoCo")}
    there = [told for path, told in known.items() if path in files]
    words = ["Munk2D, the engine in pymunk", "MuJoCo"]
    figure = {"motions": {word: None for word in words if any(name in word for _, name in there)}, "lost": {}}
    return {
        "engines": [word for word, _ in there],
        "names": [name for _, name in there],
        "missing": missing,
        "nothing": figure,
        "places": {
            "cranks": live.CRANKS,
            "couplers": [round(length, 4) for length in live.COUPLERS],
            "ratios": live.RATIOS,
        },
    }


def _assets() -> list[Path]:
    return sorted(path for path in ASSETS.rglob("*") if path.is_file())


def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def _elsewhere(name: str) -> str:
    """Where a file stands that is no page of results."""
    return {"../../README.md": "../index.html", "../../CONTRIBUTING.md": "../howto/index.html"}.get(name, name)


def _front(lessons: tuple[Lesson, ...], source: Source) -> dict[str, object]:
    lesson = lessons[0]
    take = shown(lesson.takes["free"] if "free" in lesson.takes else next(iter(lesson.takes.values())), source.answers)
    return {
        "figure": Markup(picture(take, "A four-bar linkage falls: the truth, and two engines over it")),
        "take": _json(data(take)),
        "shown": take,
        "results": [(name, _title(text)) for name, text in source.pages.items() if not name.endswith("_data.md")],
    }


def _title(text: str) -> str:
    return next((line[2:].strip() for line in text.splitlines() if line.startswith("# ")), "")


def _lesson(lesson: Lesson, source: Source, formulas: Formulas, names: Mapping[str, str]) -> dict[str, object]:
    takes = {name: shown(take, source.answers) for name, take in lesson.takes.items()}

    def words(text: str) -> str:
        return markdown.html(text, formulas)

    def quoted(text: str) -> Markup:
        """A part of a page of results, without the anchors that it has there; its files stand in another folder."""
        told = markdown.linked(re.sub(r' id="[^"]*"', "", words(text)), names, _elsewhere)
        return Markup(OWN_FILE.sub(r'\1="../results/\2"', told))

    steps = []
    for index, ((heading, text), step) in enumerate(zip(lesson.words, lesson.steps, strict=True)):
        more = None
        if step.section is not None and f"{step.section[0]}.md" in source.pages:
            page, part = step.section
            body = quoted(markdown.section(source.pages[f"{page}.md"], part))
            more = {"heading": part, "href": f"../results/{page}.html#{markdown.slug(part)}", "body": body}
        steps.append(
            {
                "number": index + 1,
                "heading": heading,
                "words": Markup(words(text)),
                "take": step.take,
                "shown": takes[step.take],
                "picture": Markup(picture(takes[step.take], f"{lesson.title}: {heading}")),
                "on": sorted(step.switched_on),
                "broken": step.broken,
                "pictures": {
                    name: Markup(picture(takes[name], f"{lesson.title}: {word}")) for word, name, _ in step.broken
                },
                "more": more,
            }
        )
    return {
        "title": lesson.title,
        "lesson": lesson,
        "steps": steps,
        "takes": {name: _json(data(take)) for name, take in takes.items()},
    }


def _json(value: object) -> Markup:
    """JSON that can stand in a script element."""
    return Markup(json.dumps(value, allow_nan=False, separators=(",", ":")).replace("</", "<\\/"))
