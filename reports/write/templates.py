"""The Jinja environment of pages, links to headings, and replaceable parts of documents."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reports.model.outcomes import SATURATED, TORN
from reports.model.page import Page
from reports.write import unmeasured

if TYPE_CHECKING:
    from jinja2 import Environment, Template

HEADING = re.compile(r"^#{1,6} (.+)$", re.MULTILINE)
PAGE_LINK = re.compile(r"(?<!!)\[([^\]\n]*(?:\n[^\]\n]*)?)\]\((\w+\.md)(?:#[^)]*)?\)")
FENCED_BLOCK = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


def anchor(heading: str) -> str:
    """The anchor of a heading in a link, after '#'."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def headings(text: str) -> tuple[str, ...]:
    """The headings of a Markdown text, without comments in code."""
    return tuple(HEADING.findall(FENCED_BLOCK.sub("", text)))


def link(page: str, heading: str, files: Mapping[str, str]) -> str:
    """The address of a heading in a file whose name begins with the page's name, or else the page's address."""
    for name in sorted(files, key=lambda name: (name != f"{page}.md", name)):
        if name.startswith(page) and name.endswith(".md") and heading in headings(files[name]):
            return f"{name}#{anchor(heading)}"
    return f"{page}.md"


def without_dead_links(text: str, exists: Callable[[str], bool]) -> str:
    """The text, where plain text replaces links to pages that do not exist."""
    return PAGE_LINK.sub(lambda match: match[0] if exists(match[2]) else match[1], text)


def marks(name: str) -> tuple[str, str]:
    return f"<!-- {name}: written by `crosscheck report` -->", f"<!-- end of {name} -->"


def with_part(document: str, name: str, text: str) -> str:
    """The document with a new text in the part `name`. Raises ValueError if a mark of this part is missing."""
    first, last = marks(name)
    before, begin, following = document.partition(first)
    _, end, after = following.partition(last)
    if not begin or not end:
        raise ValueError(f"the document lacks the marks {first!r} and {last!r}")
    return f"{before}{begin}\n{text}\n{end}{after}"


TEMPLATES = Path(__file__).parents[1] / "pages"

CODE = re.compile(r"(^ *```.*?^ *```$|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
# A page may contain the tags `details` and `summary`, and comments.
FOREIGN_TAG = re.compile(r"<(?=[A-Za-z/!?])(?!/?(?:details|summary)>|!--)")


def inert(text: str) -> str:
    """HTML or Markdown with all FOREIGN_TAGs escaped, since names of scenes and engines may contain tags."""
    return FOREIGN_TAG.sub("&lt;", text)


def inert_page(text: str) -> str:
    """A Markdown page with FOREIGN_TAGs escaped outside of code."""
    parts = CODE.split(text)
    return "".join(part if index % 2 else inert(part) for index, part in enumerate(parts))


@cache
def environment(folder: Path = TEMPLATES) -> Environment:
    """The environment of templates. An undefined name raises an exception; an unknown number becomes UNKNOWN_MARK.
    Templates in another folder have the prefix "own/", so that they can't replace our templates."""
    from jinja2 import ChoiceLoader, Environment, FileSystemLoader, PrefixLoader, StrictUndefined

    out = Environment(
        loader=ChoiceLoader([FileSystemLoader(TEMPLATES), PrefixLoader({"own": FileSystemLoader(folder)})]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
        finalize=unmeasured.marked,
    )
    out.filters |= {name: partial(_filter, name) for name in unmeasured.FILTERS} | {"anchor": anchor}
    out.globals |= {"torn": f"{TORN:g}", "saturated": f"{SATURATED:g}"}
    return out


def _filter(name: str, *values: Any, **options: Any) -> Any:
    return unmeasured.FILTERS[name](*values, **options)


@cache
def template(text: str) -> Template:
    return environment().from_string(text)


def template_of(page: Page) -> Template:
    """The page's template; without it the template with the page's name, or else "base.md"."""
    if page.template is not None:
        return environment(page.template.parent).get_template(f"own/{page.template.name}")
    return environment().select_template([f"{page.name}/page.md", "base.md"])
