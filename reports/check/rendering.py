"""Sections of a check as plain text, as Markdown with its pictures beside it, and as one HTML file."""

from __future__ import annotations

import textwrap
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

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
    """A part of the report. `facts`: what a sentence is about, and the sentence; `code`: lines to copy; `picture`: what
    it shows, and the SVG.
    """

    title: str
    sentences: tuple[str, ...] = ()
    facts: tuple[tuple[str, str], ...] = ()
    code: tuple[str, ...] = ()
    header: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    picture: tuple[str, str] | None = None


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
    from reports.write.tables import markdown as table

    lines = [f"# {' '.join(name.split())}", ""]
    for section in sections:
        lines += [f"## {section.title}", ""] if section.title else []
        lines += [f"* {_inert(sentence)}" for sentence in section.sentences]
        lines += [f"* {label}: {_inert(sentence)}" for label, sentence in section.facts]
        lines += ["", "```", *section.code, "```"] if section.code else []
        lines += ["", _inert(table(section.header, section.rows, len(section.header)))] if section.rows else []
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
    from markdown_it import MarkdownIt

    # Images of their own: as elements of this page two drawings would share the names of their clips.
    drawn = dict(section.picture for section in sections if section.picture is not None)
    files = {title: f"data:image/svg+xml;base64,{b64encode(svg.encode()).decode()}" for title, svg in drawn.items()}
    reader = MarkdownIt("commonmark", {"html": False}).enable("table")
    # Our own pictures, which it would leave out, and no address that the name of a body may hold.
    reader.validateLink = lambda address: address in files.values()  # type: ignore[method-assign]
    return reader.render(markdown(name, sections, files))


def _inert(text: str) -> str:
    return text.replace("<", "&lt;")
