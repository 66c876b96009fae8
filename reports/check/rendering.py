"""Functions that render the report of a check as plain text, as Markdown and as HTML."""

from __future__ import annotations

import textwrap
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from reports.write import tables


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


def html(name: str, sections: Sequence[Section], page: bool = True) -> str:
    """The report as a page of HTML, or without `page` as the body of a page, for a notebook."""
    from reports.write.templates import environment  # Imported here, so that commands start sooner.

    template = environment(Path(__file__).parent / "templates").get_template("own/report.html")
    return template.render(
        name=name, sections=sections, page=page, base64=lambda text: b64encode(text.encode()).decode()
    )


def _inert(text: str) -> str:
    return text.replace("<", "&lt;")
