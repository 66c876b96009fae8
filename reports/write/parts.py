"""The parts of a document that `crosscheck report` writes, between two comments that name them."""

from __future__ import annotations


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
