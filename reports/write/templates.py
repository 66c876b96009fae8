"""The templates of pages and remarks and what all of them may use, links to headings, and parts of documents."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, FileSystemLoader, PrefixLoader, StrictUndefined, Template

from reports.model.outcomes import SATURATED, TORN
from reports.model.page import Page
from reports.write import unmeasured

HEADING = re.compile(r"^#{1,6} (.+)$", re.MULTILINE)
OWN_LINK = re.compile(r"(?<!!)\[([^\]\n]*(?:\n[^\]\n]*)?)\]\((\w+\.md)(?:#[^)]*)?\)")
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


def anchor(heading: str) -> str:
    """What a link to a heading ends with: lower case, without punctuation, hyphens for blanks."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def headings(text: str) -> tuple[str, ...]:
    """The headings of a Markdown text; a comment in a block of code is none."""
    return tuple(HEADING.findall(FENCED.sub("", text)))


def link(page: str, heading: str, files: Mapping[str, str]) -> str:
    """The address of a heading in a page's file, or in another whose name begins with the page's; else of the page."""
    for name in sorted(files, key=lambda name: (name != f"{page}.md", name)):
        if name.startswith(page) and name.endswith(".md") and heading in headings(files[name]):
            return f"{name}#{anchor(heading)}"
    return f"{page}.md"


def without_links_to_nothing(text: str, there: Callable[[str], bool]) -> str:
    """A page whose links to our other pages are words where such a page is not `there`."""
    return OWN_LINK.sub(lambda found: found[0] if there(found[2]) else found[1], text)


def marks(name: str) -> tuple[str, str]:
    """The comments that begin and end a part."""
    return f"<!-- {name}: written by `crosscheck report` -->", f"<!-- end of {name} -->"


def with_part(document: str, name: str, text: str) -> str:
    """A document with a text as its part of this name; raises ValueError where one of the part's marks is missing."""
    first, last = marks(name)
    before, begin, rest = document.partition(first)
    _, end, after = rest.partition(last)
    if not begin or not end:
        raise ValueError(f"the document lacks the marks {first!r} and {last!r}")
    return f"{before}{begin}\n{text}\n{end}{after}"


TEMPLATES = Path(__file__).parents[1] / "pages"

CODE = re.compile(r"(^ *```.*?^ *```$|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
FOREIGN = re.compile(r"<(?=[A-Za-z/!?])(?!/?(?:details|summary)>|!--)")  # of all HTML our pages have these and comments


def inert(text: str) -> str:
    """HTML or Markdown whose tags are words to read, but for those that our pages have: names may hold anything."""
    return FOREIGN.sub("&lt;", text)


def inert_page(text: str) -> str:
    """The same of a whole Markdown page, where code stays as it is."""
    parts = CODE.split(text)
    return "".join(part if index % 2 else inert(part) for index, part in enumerate(parts))


@cache
def environment(folder: Path = TEMPLATES) -> Environment:
    """Templates fail loudly on a name that has no value, and print a mark for a number that is not known.

    Those of another folder are found as "own/NAME"; so none of them hides "base.md".
    """
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
    """A template that stands in the code, like the remark of an experiment; compiled once."""
    return environment().from_string(text)


def template_of(page: Page) -> Template:
    """The page's own template, that of its name here, or the generic one."""
    if page.template is not None:
        return environment(page.template.parent).get_template(f"own/{page.template.name}")
    return environment().select_template([f"{page.name}/page.md", "base.md"])
