"""Markdown of lessons as HTML, formulas as MathML, and the parts of a Markdown page."""

from __future__ import annotations

import re
from functools import cache
from html import escape

from reports.model.ending import BadInput
from reports.write.templates import inert


@cache
def mathml(formula: str, displayed: bool = False) -> str:
    """A formula as browsers draw it without a script. Raises BadInput for a command that latex2mathml does not know."""
    from latex2mathml.converter import convert  # pyright: ignore[reportMissingImports]

    drawn = convert(formula.replace(r"\arg", r"\operatorname{arg}"), display="block" if displayed else "inline")
    if "\\" in drawn:
        raise BadInput(f"the formula {formula!r} has a command that latex2mathml does not know: write it otherwise")
    return drawn


def render_html(text: str) -> str:
    """A few sentences of Markdown as HTML."""
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin  # pyright: ignore[reportMissingImports]

    reader = MarkdownIt("commonmark", {"html": True}).enable("table")
    dollarmath_plugin(
        reader,
        allow_space=False,
        allow_digits=False,
        renderer=lambda formula, options: mathml(formula, options["display_mode"]),
    )
    for rule in ("html_block", "html_inline"):
        reader.add_render_rule(rule, lambda self, tokens, index, options, env: inert(tokens[index].content))
    return str(reader.render(text))


def title(text: str) -> str:
    """The first heading of a Markdown page."""
    return next((line[2:].strip() for line in text.splitlines() if line.startswith("# ")), "")


def section(text: str, heading: str) -> str | None:
    """The part of a Markdown page below a heading, up to the next of its rank; None on a page without that heading."""
    start, rank, fenced = None, 0, False
    lines = text.splitlines()
    for index, line in enumerate(lines):
        fenced ^= line.lstrip().startswith("```")
        found = None if fenced else re.match(r"(#+) (.*)", line)
        if found and start is None and found[2].strip() == heading:
            start, rank = index + 1, len(found[1])
        elif found and start is not None and len(found[1]) <= rank:
            return "\n".join(lines[start:index]).strip()
    return None if start is None else "\n".join(lines[start:]).strip()


def cards(links: list[tuple[str, str]]) -> str:
    """A list of (address, words) as HTML."""
    items = "".join(f'<li><a href="{address}">{escape(words)}</a></li>' for address, words in links)
    return f'<ul class="cards">{items}</ul>'
