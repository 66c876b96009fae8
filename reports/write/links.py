"""Links to the headings of pages, as GitHub names them."""

from __future__ import annotations

import re
from collections.abc import Mapping

HEADING = re.compile(r"^#{1,6} (.+)$", re.MULTILINE)
CODE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


def anchor(heading: str) -> str:
    """What a link to a heading ends with: lower case, without punctuation, hyphens for blanks."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def headings(text: str) -> tuple[str, ...]:
    """The headings of a Markdown text; a comment in a block of code is none."""
    return tuple(HEADING.findall(CODE.sub("", text)))


def link(page: str, heading: str, files: Mapping[str, str]) -> str:
    """The address of a heading in a page's file, or in another whose name begins with the page's; else of the page."""
    for name in sorted(files, key=lambda name: (name != f"{page}.md", name)):
        if name.startswith(page) and name.endswith(".md") and heading in headings(files[name]):
            return f"{name}#{anchor(heading)}"
    return f"{page}.md"
