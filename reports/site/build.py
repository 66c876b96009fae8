"""The whole site as files by name, from rendered Markdown pages, stored motions, and packages that were fetched."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from functools import partial
from html import escape
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from reports.model.outcomes import Outcome
from reports.model.tasks import Motion
from reports.plots.theme import DARK, LIGHT, Theme
from reports.site import markdown
from reports.site.animated import animation, shown
from reports.site.lecture import html as lecture_html
from reports.site.lesson import Lesson, Source
from reports.site.lessons import LESSONS, take_like
from reports.site.live.data import data, first_picture
from reports.site.live.sliders import ENGINES, NAMES, SHIPPED
from reports.site.munk2d import compiled
from reports.site.packages import PACKAGES, NotFetched
from reports.site.reference import reference_pages
from reports.site.rows import explored


def colours() -> str:
    """CSS that sets a variable a role; the reader's own choice stands above the system's."""
    light, dark = _variables(LIGHT), _variables(DARK)
    return (
        f":root {{ color-scheme: light dark; {light} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root:not([data-scheme=light]) {{ {dark} }} }}\n"
        f":root[data-scheme=dark] {{ color-scheme: dark; {dark} }}\n"
        ":root[data-scheme=light] { color-scheme: light }\n"
    )


def _variables(theme: Theme) -> str:
    return " ".join(f"--{field.name}: {getattr(theme, field.name)};" for field in fields(Theme))


OWN_FILE = re.compile(r'(href|src)="(?!https?:|mailto:|\.\./)([^"]+)"')
DRAGGED = re.compile(r"\{(\w+)\}")  # a number in a lesson's words that moves a control


def lesson_page(lesson: Lesson, source: Source, names: Mapping[str, str]) -> dict[str, Any]:
    """For lesson.html; `names`: pages by the Markdown file's name."""

    def quoted(text: str) -> Markup:
        """A part of a page of results, whose anchors and other parts stay there; its files stand in another folder."""
        told = re.sub(r' id="[^"]*"', "", markdown.html(text)).replace('href="#', f'href="{lesson.page}.html#')
        return Markup(OWN_FILE.sub(r'\1="../results/\2"', markdown.linked(told, names, _elsewhere)))

    parts = []
    for words, each in zip(lesson.parts, lesson.experiments, strict=True):
        live = lesson.scene(each.scene)
        before = live.located(each.before)
        told = {name: one.texts[before.get(name, one.start)] for name, one in live.controls().items()}
        more = None
        there = markdown.section(source.pages.get(f"{lesson.page}.md", ""), each.section)
        if there is not None:  # a page made of few rows lacks some parts
            href = f"../results/{lesson.page}.html#{markdown.slug(each.section)}"
            more = {"heading": each.section, "href": href, "body": quoted(there)}

        def dragged(text: str, told: Mapping[str, str] = told) -> Markup:
            html = markdown.html(text)
            number = r'<span class="drag" role="slider" tabindex="0" data-name="{0}" aria-label="{0}">{1}</span>'
            return Markup(DRAGGED.sub(lambda found: number.format(found[1], escape(told[found[1]])), html))

        parts.append(
            {
                "heading": words.heading,
                "text": dragged(words.text),
                "question": Markup(markdown.html(words.question).removeprefix("<p>").removesuffix("</p>\n")),
                "answers": words.answers,
                "after_words": dragged(words.after),
                "scene": lesson.scenes.index(live),
                "before": before,
                "after": live.located(each.after),
                "shown": " ".join(("paths", *each.shown)),
                "more": more,
            }
        )
    return {
        "title": lesson.title,
        "lesson": lesson,
        "page": f"../results/{lesson.page if f'{lesson.page}.md' in source.pages else 'index'}.html",
        "parts": parts,
        "scenes": [{"key": live.key, "fields": [slider.field for slider in live.sliders]} for live in lesson.scenes],
        "picture": Markup(first_picture(lesson.scene(lesson.experiments[0].scene))),
        "settings": ENGINES,
        "names": NAMES,
    }


def front_picture(source: Source) -> str:
    """A motion of the first lesson that moves without a script."""
    live = LESSONS[0].scene("let go")
    stored = live.stored()
    cells = {words: stored[name, 0].cell for name, words in NAMES.items()}
    methods = tuple((f"{words} {SHIPPED}", cell.engine, cell.every) for words, cell in cells.items())
    take = replace(take_like(live.scene, methods), samples=live.frames)
    return animation(shown(take, source.answers), "A four-bar linkage falls")


HERE = Path(__file__).parent
ASSETS = HERE / "assets"
MARKER = "site.json"
LINE = re.compile(r' (?:d|x|y)="[^"]*"')
LONG = re.compile(r"-?\d+\.\d{2,}(?![\de])")
MUNK = "packages/munk2d.js"
ENGINE_FILES = {"munk2d": MUNK, "mujoco": "packages/mujoco.js"}

Files = dict[str, bytes]


def tasks(lessons: Iterable[Lesson] = LESSONS) -> tuple[Motion, ...]:
    """All motions that the lessons show, each once."""
    return tuple(dict.fromkeys(task for lesson in lessons for live in lesson.scenes for task in live.stored().values()))


def build(source: Source, lessons: Iterable[Lesson] = LESSONS) -> Files:
    """Every file of the site, by its path in it."""
    lessons = tuple(lessons)
    files: Files = {path.name: path.read_bytes() for path in sorted(ASSETS.iterdir())}
    files["colours.css"] = colours().encode()

    def part(what: str, make: Callable[[], Files]) -> Files:
        """A part of the site; where it can't be had nothing, and a sentence that says why."""
        try:
            return make()
        except NotFetched as reason:
            source.troubles.append(f"Built without {what}: {reason}.")
            return {}

    for package in PACKAGES:
        files |= part(f"{package.name} ({package.use})", partial(source.registry.fetched, package))
    files |= part("Munk2D (the engine in pymunk)", lambda: {MUNK: compiled(source.cache)})
    for live in {live.key: live for lesson in lessons for live in lesson.scenes}.values():
        told = json.dumps(data(live, source.answers), separators=(",", ":"), allow_nan=False)
        files[f"live/{live.key}.json"] = told.encode()
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    names = {name.removesuffix(".md"): name.removesuffix(".md") + ".html" for name in source.pages}
    pages: list[str] = []

    def write(path: str, template: str, **given: object) -> None:
        shared = {"up": "../" * path.count("/"), "lessons": lessons, "foot": source.foot}
        files[path] = environment.get_template(template).render(**shared, **given).encode()
        pages.append(path)

    for name, text in source.pages.items():
        body = markdown.linked(markdown.html(text), names, _elsewhere)
        path = f"results/{names[name.removesuffix('.md')]}"
        write(path, "article.html", title=markdown.title(text) or name, body=Markup(body))
    for lesson in lessons:
        told = lesson_page(lesson, source, names)
        engines = [name for name, path in ENGINE_FILES.items() if path in files]
        write(f"lessons/{lesson.name}.html", "lesson.html", **told, engines=engines)
    api = part("the reference", reference_pages) if source.api else {}
    files |= api
    if api:
        modules = sorted(name.removesuffix(".html").partition("/")[2] for name in api if name.endswith(".html"))
        links = "".join(f'<li><a href="{name}.html">{name.replace("/", ".")}</a></li>' for name in modules)
        body = Markup(f"<h1>Reference</h1><ul class='modules'>{links}</ul>")
        write("reference/index.html", "article.html", title="Reference", body=body)
    guides = [(path.stem, path.read_text(encoding="utf-8")) for path in sorted((HERE / "howto").glob("*.md"))]
    below = {f"../results/{name}": f"../results/{page}" for name, page in names.items()}
    meanings = {str(outcome): outcome.meaning for outcome in Outcome}
    for name, text in guides:
        quoted = {"contributing": lambda part: Markup(_quoted(source, part)), "meanings": meanings}
        told = environment.from_string(text).render(quoted)
        body = markdown.linked(markdown.html(told), below, _elsewhere)
        write(f"howto/{name}.html", "article.html", title=markdown.title(text), body=Markup(body))
    titles = [(name, markdown.title(text)) for name, text in guides]
    write("howto/index.html", "howto.html", title="How to", guides=titles, api=bool(api))
    write("results/rows.html", "explorer.html", title="All stored rows", charts="packages/plot.min.js" in files)
    given = source.lecture
    lecture = part("the lecture", lambda: {"lecture.html": lecture_html(given).encode()}) if given else {}
    for path, body in lecture.items():
        write(path, "article.html", title="A lecture of 45 minutes", body=Markup(body.decode()))
    results = [(name, markdown.title(text)) for name, text in source.pages.items()]
    write("index.html", "index.html", title="How far from ideal?", results=results, lecture=bool(lecture))
    files["front.svg"] = front_picture(source).encode()
    if find_spec("latex2mathml") is None:
        source.troubles.append("Formulas are shown as TeX, since latex2mathml is not installed: pip install '.[site]'.")
    write("about.html", "about.html", title="About this site", packages=PACKAGES, troubles=source.troubles)
    files |= {f"results/{name}": lighter(text).encode() for name, text in source.pictures.items()}
    files |= {f"results/{name}": text.encode() for name, text in source.tables.items()}
    csv = [source.tables.get(f"{name}.csv", "") for name in ("errors", "timings", "descriptions")]
    files["results/rows.json"] = json.dumps(explored(*csv), separators=(",", ":"), allow_nan=False).encode()
    files[MARKER] = json.dumps({"pages": sorted(pages), "troubles": source.troubles}, indent=1).encode()
    return files


def lighter(picture: str) -> str:
    """An SVG whose lines are drawn to a tenth of a point, a fraction of a pixel, instead of a millionth."""
    return LINE.sub(lambda found: LONG.sub(lambda number: f"{float(number[0]):.1f}", found[0]), picture)


def _quoted(source: Source, part: str) -> str:
    """A part of CONTRIBUTING.md; where that is not there, a sentence that says so."""
    if not source.contributing:
        return "The steps stand in CONTRIBUTING.md of the checkout."
    return markdown.section(source.contributing, part) or f"CONTRIBUTING.md has no part {part!r}."


def _elsewhere(name: str) -> str:
    """Where a file stands that is no page of results."""
    return {"../../README.md": "../index.html", "../../CONTRIBUTING.md": "../howto/index.html"}.get(name, name)
