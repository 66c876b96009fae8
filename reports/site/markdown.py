"""The Markdown pages as HTML: links lead to the site's own files, and formulas are MathML, by KaTeX in Node."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

from markdown_it import MarkdownIt

from reports.run.files import temporary_folder
from reports.site.packages import KATEX, NotFetched, Registry
from reports.write.templates import CODE, inert

DISPLAYED = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
# As GitHub has it: no space inside next to either sign, and no digit after the second.
INLINE = re.compile(r"(?<![\\$\w])\$(?!\s)([^$]+?)(?<!\s)\$(?![\w$])")
HEADING = re.compile(r"<h([1-6])>(.*?)</h\1>", re.DOTALL)
OWN_PAGE = re.compile(r'href="(?!https?:|#|mailto:)([^"#]+)\.md(#[^"]*)?"')
MARK = "\ue000{}\ue001"  # stands for a formula while Markdown is read: letters that no page has
MARKED = re.compile("\ue000([0-9]+)\ue001")


@dataclass
class Formulas:
    """The formulas of all pages, in the order in which they were met, each with whether it is displayed."""

    found: dict[tuple[str, bool], int] = field(default_factory=dict)

    def mark(self, formula: str, displayed: bool) -> str:
        """What stands for a formula until all are rendered."""
        return MARK.format(self.found.setdefault((" ".join(formula.split()), displayed), len(self.found)))


def slug(heading: str) -> str:
    """A heading's anchor, as GitHub makes it."""
    text = re.sub(r"<[^>]+>|[`*_]", "", heading) if "<" in heading else heading
    return re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", "-")


def html(text: str, formulas: Formulas) -> str:
    """Markdown as HTML, with marks where formulas stand and anchors at headings."""
    parts = CODE.split(text)
    for index in range(0, len(parts), 2):  # what is between code
        part = DISPLAYED.sub(lambda found: formulas.mark(found[1], True), parts[index])
        parts[index] = INLINE.sub(lambda found: formulas.mark(found[1], False), part)
    reader = MarkdownIt("commonmark", {"html": True}).enable("table")
    for rule in ("html_block", "html_inline"):
        reader.add_render_rule(rule, lambda self, tokens, index, options, env: inert(tokens[index].content))
    rendered = reader.render("".join(parts))
    seen: dict[str, int] = {}

    def anchored(found: re.Match[str]) -> str:
        name = slug(re.sub(r"<[^>]+>", "", found[2]))
        count = seen[name] = seen.get(name, -1) + 1
        return f'<h{found[1]} id="{escape(name + (f"-{count}" if count else ""))}">{found[2]}</h{found[1]}>'

    rendered = HEADING.sub(anchored, rendered)
    rendered = rendered.replace("<table>", '<div class="wide"><table class="sortable">').replace(
        "</table>", "</table></div>"
    )
    return rendered


def linked(text: str, known: Mapping[str, str], elsewhere: Callable[[str], str]) -> str:
    """Links between Markdown pages as links between files of the site; `elsewhere` gives the others' addresses."""

    def own(found: re.Match[str]) -> str:
        name, anchor = found[1], found[2] or ""
        return f'href="{known[name]}{anchor}"' if name in known else f'href="{elsewhere(name + ".md")}{anchor}"'

    return OWN_PAGE.sub(own, text)


def title(text: str) -> str:
    """The first heading of a Markdown page."""
    return next((line[2:].strip() for line in text.splitlines() if line.startswith("# ")), "")


def section(text: str, heading: str) -> str | None:
    """The part of a Markdown page below a heading, up to the next of its rank; None on a page without that heading."""
    lines = text.splitlines()
    fenced = False
    start = rank = None
    for index, line in enumerate(lines):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        found = None if fenced else re.match(r"(#+) (.*)", line)
        if found and start is None and found[2].strip() == heading:
            start, rank = index + 1, len(found[1])
        elif found and start is not None and rank is not None and len(found[1]) <= rank:
            return "\n".join(lines[start:index]).strip()
    if start is None:
        return None
    return "\n".join(lines[start:]).strip()


def with_formulas(text: str, rendered: list[str]) -> str:
    """The page with its formulas put in."""
    return MARKED.sub(lambda found: rendered[int(found[1])], text)


SCRIPT = Path(__file__).with_name("formulas.mjs")
PATIENCE = 120  # s for all formulas


def rendered(formulas: Formulas, registry: Registry) -> tuple[list[str], str]:
    """The formulas in their order, and why they are TeX as written; empty if they are not.

    Raises ValueError for a formula that KaTeX does not understand: it would be wrong on the Markdown page too.
    """
    asked = list(formulas.found)
    node = shutil.which("node")
    if node is None:
        return _as_written(asked), "node is not installed"
    try:
        module = registry.fetched(KATEX)["dist/katex.mjs"]
    except NotFetched as reason:
        return _as_written(asked), str(reason)
    with temporary_folder() as folder:
        path = folder / "katex.mjs"
        path.write_bytes(module)
        ended = subprocess.run(
            [node, str(SCRIPT), str(path)],
            input=json.dumps(asked),
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            encoding="utf-8",
        )
    if ended.returncode:
        told = [line for line in ended.stderr.splitlines() if "Error" in line]
        raise ValueError(f"KaTeX refuses a formula: {told[0] if told else ended.stderr[-200:]}")
    return json.loads(ended.stdout), ""


def _as_written(asked: list[tuple[str, bool]]) -> list[str]:
    return [f'<code class="tex{" displayed" if displayed else ""}">{escape(each)}</code>' for each, displayed in asked]
