"""The whole site as files by name, from rendered Markdown pages, stored motions, and packages that were fetched."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from importlib.util import find_spec
from pathlib import Path

import jinja2
from markupsafe import Markup

from reports.model.tasks import Motion
from reports.plots.theme import DARK, LIGHT, Theme
from reports.run.files import temporary_folder
from reports.site import markdown
from reports.site.embed import data, picture, shown
from reports.site.lesson import Lesson, Source
from reports.site.lessons import LESSONS
from reports.site.live.data import engine_files, running_in
from reports.site.markdown import Formulas, rendered
from reports.site.packages import D3, KATEX, MUJOCO, PLOT, NotFetched, Package, fetched
from reports.site.rows import explored

MODULES = ("reference", "engines")
PATIENCE = 300  # s
STYLE = re.compile(rb"<style>(.*?)</style>", re.DOTALL)
# pdoc's names of colours, by ours.
ROLES = {
    **{"text": "ink", "muted": "quiet", "link": "second", "link-hover": "first", "code": "grid", "active": "middling"},
    **{"accent": "grid", "accent2": "quiet", "nav-hover": "grid", "name": "second", "def": "third"},
    "annotation": "third",
}


def reference_pages() -> dict[str, bytes]:
    """Files below reference/ of the site. Raises NotFetched where pdoc is not installed or fails."""
    if find_spec("pdoc") is None:
        raise NotFetched("pdoc is not installed: pip install '.[site]'")
    with temporary_folder() as folder:
        theme, output = folder / "theme", folder / "pages"
        theme.mkdir()
        (theme / "theme.css").write_text(_sheet(), encoding="utf-8")
        words = [sys.executable, "-m", "pdoc", "--no-show-source", "--no-search", "--template-directory", str(theme)]
        words += ["--footer-text", "crosscheck", "--output-directory", str(output), *MODULES]
        ended = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE)
        if ended.returncode:
            raise NotFetched(f"pdoc failed: {(ended.stderr.strip().splitlines() or ['no reason'])[-1]}")
        found = {path.relative_to(output).as_posix(): path for path in sorted(output.rglob("*")) if path.is_file()}
        # A browser asks for an icon unless the page has one.
        icon = (b"</head>", b'<link rel="icon" href="data:,"></head>')
        pages = {f"reference/{name}": path.read_bytes().replace(*icon, 1) for name, path in found.items()}
    return shared_styles(pages)


def shared_styles(pages: dict[str, bytes]) -> dict[str, bytes]:
    """The pages with the styles that stand in each of them, most of a small page, as files of their own."""
    names: dict[bytes, str] = {}
    out: dict[str, bytes] = {}
    for page, text in pages.items():
        up = "../" * (page.count("/") - 1)

        def linked(found: re.Match[bytes], up: str = up) -> bytes:
            name = names.setdefault(found[1], f"style-{len(names)}.css")
            return f'<link rel="stylesheet" href="{up}{name}">'.encode()

        out[page] = STYLE.sub(linked, text) if page.endswith(".html") else text
    return out | {f"reference/{name}": text for text, name in names.items()}


def _sheet() -> str:
    light, dark = _colours(LIGHT), _colours(DARK)
    # What pdoc colours by itself is too dark on dark paper.
    dark += " .pdoc-code .nb, .pdoc-code .kt { color: var(--def) } .pdoc-code .o { color: var(--muted) }"
    return f"{light}\n@media (prefers-color-scheme: dark) {{ {dark} :root {{ color-scheme: dark }} }}\n"


def _colours(theme: Theme) -> str:
    named = " ".join(f"--{name}: {getattr(theme, role)};" for name, role in ROLES.items())
    return f":root {{ --pdoc-background: {theme.paper}; }} .pdoc {{ {named} }}"


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


OWN_FILE = re.compile(r'(href|src)="(?!https?:|#|mailto:|\.\./)([^"]+)"')
Elsewhere = Callable[[str], str]


def lesson_page(
    lesson: Lesson, source: Source, formulas: Formulas, names: Mapping[str, str], elsewhere: Elsewhere
) -> dict[str, object]:
    """For lesson.html; `names`: pages by the Markdown file's name, `elsewhere`: where other files stand."""
    takes = {name: shown(take, source.answers) for name, take in lesson.takes.items()}

    def words(text: str) -> str:
        return markdown.html(text, formulas)

    def quoted(text: str) -> Markup:
        """A part of a page of results, without the anchors that it has there; its files stand in another folder."""
        told = markdown.linked(re.sub(r' id="[^"]*"', "", words(text)), names, elsewhere)
        return Markup(OWN_FILE.sub(r'\1="../results/\2"', told))

    steps = []
    for index, ((heading, text), step) in enumerate(zip(lesson.words, lesson.steps, strict=True)):
        more = None
        if step.section is not None and f"{step.section[0]}.md" in source.pages:
            page, part = step.section
            text_there = markdown.section(source.pages[f"{page}.md"], part)
            if text_there is not None:  # a page made of few rows lacks some parts
                href = f"../results/{page}.html#{markdown.slug(part)}"
                more = {"heading": part, "href": href, "body": quoted(text_there)}
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


def front_page(lesson: Lesson, source: Source) -> dict[str, object]:
    """For index.html, with a motion of this lesson."""
    take = shown(lesson.takes["free"] if "free" in lesson.takes else next(iter(lesson.takes.values())), source.answers)
    return {
        "figure": Markup(picture(take, "A four-bar linkage falls: the truth, and two engines over it")),
        "take": _json(data(take)),
        "shown": take,
        "results": [(name, markdown.title(text)) for name, text in source.pages.items()],
    }


def _json(value: object) -> Markup:
    """JSON that can stand in a script element."""
    return Markup(json.dumps(value, allow_nan=False, separators=(",", ":")).replace("</", "<\\/"))


HERE = Path(__file__).parent
ASSETS = HERE / "assets"
MARKER = "site.json"
LINE = re.compile(r' (?:d|x|y)="[^"]*"')
LONG = re.compile(r"-?\d+\.\d{2,}(?![\de])")
CHART_TITLE = re.compile(r"<h1[^>]*>(.*?)</h1>", re.DOTALL)

Files = dict[str, bytes]


def tasks(lessons: Iterable[Lesson] = LESSONS) -> tuple[Motion, ...]:
    """All motions that the lessons show, each once."""
    return tuple(dict.fromkeys(task for lesson in lessons for task in lesson.tasks()))


def build(source: Source, lessons: Iterable[Lesson] = LESSONS) -> Files:
    """Every file of the site, by its path in it."""
    lessons = tuple(lessons)
    formulas = Formulas()
    taken = _packages((D3, PLOT), source)
    running, missing = engine_files(source, lessons)
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
            **lesson_page(lesson, source, formulas, names, _elsewhere),
            **running_in(lesson, running, missing),
        )
    api = _reference(source)
    files |= api
    guides = [(path.stem, path.read_text(encoding="utf-8")) for path in sorted((HERE / "howto").glob("*.md"))]
    below = {f"../results/{name}": f"../results/{page}" for name, page in names.items()}
    for name, text in guides:
        told = environment.from_string(text).render(contributing=lambda part: Markup(_quoted(source, part)))
        body = markdown.linked(markdown.html(told, formulas), below, _elsewhere)
        write(f"howto/{name}.html", "article.html", title=markdown.title(text), body=Markup(body))
    titles = [(name, markdown.title(text)) for name, text in guides]
    write("howto/index.html", "howto.html", title="How to", guides=titles, api=bool(api))
    write("results/rows.html", "explorer.html", title="All stored rows")
    write("index.html", "index.html", title="How far from ideal?", **front_page(lessons[0], source))
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
    files |= {f"results/{name}": lighter(text).encode() for name, text in source.pictures.items()}
    files |= {f"results/{name}": text.encode() for name, text in source.tables.items()}
    csv = [source.tables.get(f"{name}.csv", "") for name in ("errors", "timings", "descriptions")]
    files["results/rows.json"] = json.dumps(explored(*csv), separators=(",", ":"), allow_nan=False).encode()
    files[MARKER] = json.dumps({"pages": sorted(pages), "troubles": source.troubles}, indent=1).encode()
    return files


def lighter(picture: str) -> str:
    """An SVG whose lines are drawn to a tenth of a point, a fraction of a pixel, instead of a millionth."""
    return LINE.sub(lambda found: LONG.sub(lambda number: f"{float(number[0]):.1f}", found[0]), picture)


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
    return markdown.section(source.contributing, part) or f"CONTRIBUTING.md has no part {part!r}."


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
