"""Functions that render the report of a check as plain text, as Markdown and as HTML."""

from __future__ import annotations

import textwrap
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from reports.write import tables

STYLE = """
:root { color-scheme: light dark }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; margin: 1rem 0 }
th, td { text-align: left; padding: .25rem .75rem; border-bottom: 1px solid #8886 }
pre { padding: .75rem; border: 1px solid #8886; overflow-x: auto }
img { max-width: 100%; height: auto }
"""


@dataclass(frozen=True)
class Section:
    title: str
    sentences: tuple[str, ...] = ()
    facts: tuple[tuple[str, str], ...] = ()  # (label, sentence).
    code: tuple[str, ...] = ()  # Lines that the user can copy.
    header: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    picture: tuple[str, str] | None = None  # (title, SVG)


def plain(sections: Sequence[Section], width: int = 120) -> str:
    lines: list[str] = []
    for section in sections:
        lines += [section.title] if section.title else []
        lines += [line for sentence in section.sentences for line in textwrap.wrap(sentence, width)]
        for label, sentence in section.facts:
            head = f"  {label:<9} "
            lines += textwrap.wrap(sentence, width, initial_indent=head, subsequent_indent=" " * len(head))
        lines += ["", *(f"      {line}" for line in section.code)] if section.code else []
        if section.rows:
            lines += [""] if lines else []
            lines += [f"    {line}" for line in tables.text_table(section.header, section.rows)]
        lines.append("")
    return "\n".join(lines)


def markdown(name: str, sections: Sequence[Section], files: dict[str, str]) -> str:
    """The report as Markdown. files: title of a picture -> path of its file."""
    lines = [f"# {' '.join(name.split())}", ""]
    for section in sections:
        lines += [f"## {section.title}", ""] if section.title else []
        lines += [f"* {_inert(sentence)}" for sentence in section.sentences]
        lines += [f"* {label}: {_inert(sentence)}" for label, sentence in section.facts]
        lines += ["", "```", *section.code, "```"] if section.code else []
        if section.rows:
            lines += ["", _inert(tables.markdown(section.header, section.rows, len(section.header)))]
        if section.picture is not None:
            lines += ["", f"![{section.picture[0]}]({files[section.picture[0]]})"]
        lines.append("")
    return "\n".join(lines)


def html(name: str, sections: Sequence[Section]) -> str:
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(name)}</title>'
        f"<style>{STYLE}</style></head><body>\n{body(name, sections)}\n</body></html>\n"
    )


def body(name: str, sections: Sequence[Section]) -> str:
    """The body of the HTML page, also for a notebook."""
    lines = [f"<h1>{escape(' '.join(name.split()))}</h1>"]
    for section in sections:
        lines += [f"<h2>{escape(section.title)}</h2>"] if section.title else []
        items = [*section.sentences, *(f"{label}: {sentence}" for label, sentence in section.facts)]
        lines += ["<ul>", *(f"<li>{escape(item)}</li>" for item in items), "</ul>"] if items else []
        if section.code:
            code = escape("\n".join(section.code))
            lines.append(f"<pre><code>{code}\n</code></pre>")
        if section.rows:
            head, *rows = (
                "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in row)
                for tag, row in (("th", section.header), *(("td", row) for row in section.rows))
            )
            table = "".join(f"<tr>{row}</tr>\n" for row in rows)
            lines.append(f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{table}</tbody>\n</table>")
        if section.picture is not None:
            # An <img> avoids a conflict between identifiers of clip paths in two inline SVG elements.
            title, svg = section.picture
            source = f"data:image/svg+xml;base64,{b64encode(svg.encode()).decode()}"
            lines.append(f'<p><img src="{source}" alt="{escape(title)}" /></p>')
    return "\n".join(lines)


def _inert(text: str) -> str:
    return text.replace("<", "&lt;")
