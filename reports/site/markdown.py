"""The Markdown pages as HTML: links lead to the site's own files, and formulas are MathML."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache
from html import escape

from markdown_it import MarkdownIt

from reports.write.templates import CODE, inert

DISPLAYED = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
# As GitHub has it: no space inside next to either sign, and no digit after the second.
INLINE = re.compile(r"(?<![\\$\w])\$(?!\s)([^$]+?)(?<!\s)\$(?![\w$])")
HEADING = re.compile(r"<h([1-6])>(.*?)</h\1>", re.DOTALL)
OWN_PAGE = re.compile(r'href="(?!https?:|#|mailto:)([^"#]+)\.md(#[^"]*)?"')
MARK = "\ue000{}\ue001"  # stands for a formula while Markdown is read: letters that no page has
MARKED = re.compile("\ue000([0-9]+)\ue001")


@cache
def mathml(formula: str, displayed: bool) -> str:
    """A formula as browsers draw it by themselves; TeX as written where latex2mathml is not installed.

    Raises ValueError for a command that it does not know: it would be wrong on the Markdown page too.
    """
    try:
        from latex2mathml.converter import convert  # pyright: ignore[reportMissingImports]
    except ImportError:
        return f'<code class="tex{" displayed" if displayed else ""}">{escape(formula)}</code>'
    found = convert(formula, display="block" if displayed else "inline")
    if "\\" in found:
        raise ValueError(f"the formula {formula!r} has a command that latex2mathml does not know")
    return found


def slug(heading: str) -> str:
    """A heading's anchor, as GitHub makes it."""
    text = re.sub(r"<[^>]+>|[`*_]", "", heading) if "<" in heading else heading
    return re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", "-")


def html(text: str) -> str:
    """Markdown as HTML, with formulas and with anchors at headings."""
    formulas: list[str] = []

    def marked(found: re.Match[str]) -> str:
        formulas.append(mathml(" ".join(found[1].split()), found.re is DISPLAYED))
        return MARK.format(len(formulas) - 1)

    parts = CODE.split(text)
    parts[::2] = (INLINE.sub(marked, DISPLAYED.sub(marked, part)) for part in parts[::2])  # what is between code
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
    return MARKED.sub(lambda found: formulas[int(found[1])], rendered)


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
