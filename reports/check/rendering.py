"""Sections of a check as plain text, as Markdown with its pictures beside it, and as one HTML file."""

from __future__ import annotations

import base64
import textwrap
from collections.abc import Sequence
from html import escape

from reports.check.telling import Section

STYLE = """
:root { color-scheme: light dark }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; margin: 1rem 0 }
th, td { text-align: left; padding: .25rem .75rem; border-bottom: 1px solid #8886 }
pre { padding: .75rem; border: 1px solid #8886; overflow-x: auto }
img { max-width: 100%; height: auto }
"""


def plain(sections: Sequence[Section], width: int = 120) -> str:
    """For a terminal of so many columns."""
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
            widths = [max(map(len, column)) for column in zip(section.header, *section.rows, strict=True)]
            for row in (section.header, *section.rows):
                cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
                lines.append(f"    {'  '.join(cells)}".rstrip())
        lines.append("")
    return "\n".join(lines)


def markdown(name: str, sections: Sequence[Section], files: dict[str, str]) -> str:
    """`files`: the path of each picture's file by what the picture shows."""
    lines = [f"# {_plain_name(name)}", ""]
    for section in sections:
        lines += [f"## {section.title}", ""]
        lines += [f"* {_cell(sentence)}" for sentence in section.sentences]
        lines += [f"* {label}: {_cell(sentence)}" for label, sentence in section.facts]
        if section.code:
            lines += ["", "```", *section.code, "```"]
        if section.rows:
            lines += ["", f"| {' | '.join(map(_cell, section.header))} |", f"|{' --- |' * len(section.header)}"]
            lines += [f"| {' | '.join(map(_cell, row))} |" for row in section.rows]
        if section.picture is not None:
            lines += ["", f"![{section.picture[0]}]({files[section.picture[0]]})"]
        lines.append("")
    return "\n".join(lines)


def html(name: str, sections: Sequence[Section]) -> str:
    """One file with everything in it."""
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(name)}</title>'
        f"<style>{STYLE}</style></head><body>\n{body(name, sections)}\n</body></html>\n"
    )


def body(name: str, sections: Sequence[Section]) -> str:
    """What stands in the page, which a notebook can show too."""
    parts = [f"<h1>{escape(name)}</h1>"]
    for section in sections:
        parts += [f"<h2>{escape(section.title)}</h2>"] if section.title else []
        parts += [f"<p>{escape(sentence)}</p>" for sentence in section.sentences]
        parts += [f"<p><b>{label}</b>: {escape(sentence)}</p>" for label, sentence in section.facts]
        if section.code:
            parts.append(f"<pre>{escape(chr(10).join(section.code))}</pre>")
        if section.rows:
            head = "".join(f"<th>{escape(cell)}</th>" for cell in section.header)
            rows = "".join(
                "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in section.rows
            )
            parts.append(f"<table><tr>{head}</tr>{rows}</table>")
        if section.picture is not None:
            # An image of its own: as elements of this page two drawings would share the names of their clips.
            title, drawing = section.picture
            data = base64.b64encode(drawing.encode()).decode()
            parts.append(f'<img alt="{escape(title)}" src="data:image/svg+xml;base64,{data}">')
    return "\n".join(parts)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


def _plain_name(name: str) -> str:
    return " ".join(name.split())
