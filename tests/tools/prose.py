"""The words of pages: sentences that are read at once, formulas as mathematics. A lint that warns and never fails.

    python -m tests.tools.prose    # part of `make check`

What stands in templates and in strings of the pages' modules is read as it is written: no page is rendered, so that
clauses count that vanish without their rows.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from tests import ROOT

PAGES = ROOT / "reports" / "pages"
RESULTS = PAGES.parent / "results"
TEMPLATES = tuple(sorted(PAGES.rglob("*.md")))
# What is drawn, or printed on the terminal too, has no mathematics of Markdown.
DRAWN = ("centrodes/page.py", "atlas/page.py", "rolling/drawings.py", "rolling/page.py", "versions/page.py")
DRAWING = (*DRAWN, "errata/experiments.py")
MODULES = tuple(path for path in sorted(PAGES.rglob("*.py")) if "snippets" not in path.parts)

LONGEST = 35  # words: two or three lines of a page
LIMIT = 25_000  # bytes of Markdown: about five minutes

CODE = re.compile(r"^ *```.*?^ *```$", re.DOTALL | re.MULTILINE)
SPAN = re.compile(r"`[^`\n]*`")
MATHEMATICS = re.compile(r"\$\$[^$]*\$\$|\$[^$]*\$")
LINK = re.compile(r"!?\[([^]]*)\]\([^)]*\)")
COMMENT = re.compile(r"{#.*?#}|<[^>]*>", re.DOTALL)
DEFINED = re.compile(r"{%-?\s*(?:set\s+\w+[^%=]*=|import|from|extends|include|macro).*?%}", re.DOTALL)
TAG = re.compile(r"{%.*?%}", re.DOTALL)
PRINTED = re.compile(r"{{.*?}}", re.DOTALL)
# A sentence ends before a capital letter, a number, a name that has no capital, or what may open a sentence.
END = re.compile(r"(?<=[.!?])[\"')*_]*\s+(?=[\"'(*_`\[$]*(?:[A-Z0-9]|pymunk|lagrange))")
ABBREVIATED = re.compile(r"\b(Fig|No|no|vs|e\.g|i\.e|cf|approx)\.\s")

ASCII_MATHEMATICS = re.compile(
    r"""sqrt\s*\( | \bexp\s*\( | \w\^[\w({] | d/dt | [A-Z]-dot | \b[OF]\([A-Za-z]
    | \b(?:alpha|beta|gamma|theta|phi|omega|kappa|lambda|mu|tau)(?:\b|_)
    | \b[a-z]_[A-Za-z0-9]\b | (?<![-\w])(?:sin|cos|tan|arcsin)\s | \bd[tsx]\b | <= | >= | \+/- | \b1\s?/\s?\(""",
    re.VERBOSE,
)


def plain(text: str) -> str:
    """Markdown or a template as it is read: code and numbers as one word each, links as their words."""
    text = DEFINED.sub("", COMMENT.sub("", CODE.sub("\n\n", text)))
    text = PRINTED.sub("0", TAG.sub("", text))
    text = LINK.sub(r"\1", MATHEMATICS.sub("Formula", SPAN.sub("Code", text)))
    return ABBREVIATED.sub(r"\1 ", text)


def blocks(text: str) -> Iterator[str]:
    """Paragraphs, items of lists, headings, and cells of tables."""
    for paragraph in re.split(r"\n\s*\n|\n(?= *(?:[-*]|\d+\.) )|\n(?=[|#])", text):
        if paragraph.lstrip().startswith("|"):
            yield from paragraph.split("|")
        else:
            yield re.sub(r"^\s*(?:[-*#]+|\d+\.) ", "", paragraph)


def sentences(text: str) -> list[str]:
    found = (" ".join(part.split()) for block in blocks(plain(text)) for part in END.split(block))
    return [sentence for sentence in found if sentence]


def words(sentence: str) -> int:
    return len([word for word in sentence.split() if re.search(r"\w", word)])


def strings(source: str) -> list[str]:
    """The strings of a module, numbers put in as one word; no docstrings, since those are for programmers."""
    tree = ast.parse(source)
    told, inside = [], set()
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            inside.add(id(body[0].value))
        if isinstance(node, ast.JoinedStr):
            inside |= {id(part) for part in ast.walk(node) if part is not node}
    for node in ast.walk(tree):
        if id(node) in inside:
            continue
        if isinstance(node, ast.JoinedStr):
            told.append("".join(str(part.value) if isinstance(part, ast.Constant) else "0" for part in node.values))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            told.append(node.value)
    return told


@cache
def written(path: Path) -> tuple[str, ...]:
    text = path.read_text(encoding="utf-8")
    return tuple(strings(text)) if path.suffix == ".py" else (text,)


def named(path: Path) -> str:
    return str(path.relative_to(PAGES))


def long_sentences(text: str) -> list[str]:
    return [f"{words(sentence)} words: {sentence}" for sentence in sentences(text) if words(sentence) > LONGEST]


def ascii_mathematics(text: str) -> list[str]:
    text = MATHEMATICS.sub("", PRINTED.sub("", TAG.sub("", SPAN.sub("", CODE.sub("", LINK.sub(r"\1", text))))))
    return [text[max(0, found.start() - 30) : found.end() + 30] for found in ASCII_MATHEMATICS.finditer(text)]


def long_pages() -> list[str]:
    """Published pages that take longer to read than five minutes; data pages, tables and lists of scripts apart."""
    pages = (path for path in RESULTS.glob("*.md") if (PAGES / path.stem / "experiments.py").is_file())
    sizes = {path.name: path.stat().st_size for path in sorted(pages)}
    return [f"{name}: {size} bytes" for name, size in sizes.items() if size > LIMIT]


def warnings() -> Iterator[str]:
    """What a reader may stumble over; none of it is wrong by itself."""
    for path in (*TEMPLATES, *MODULES):
        for text in written(path):
            yield from (f"{named(path)}: {long}" for long in long_sentences(text))
            if named(path) not in DRAWING:
                yield from (f"{named(path)}: no mathematics: {found!r}" for found in ascii_mathematics(text))
    yield from long_pages()


if __name__ == "__main__":
    for line in warnings():
        print(f"warning: {line}")
