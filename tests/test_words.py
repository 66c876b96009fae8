"""The words of pages: sentences that are read at once, formulas as mathematics, and no mark of a template in sight.

What stands in templates and in strings of the pages' modules is read as it is written: no page is rendered, so that
clauses count that vanish without their rows.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

PAGES = Path(__file__).parents[1] / "reports" / "pages"
TEMPLATES = tuple(sorted(PAGES.rglob("*.md")))
# What is drawn, or printed on the terminal too, has no mathematics of Markdown.
DRAWING = ("charts.py", "chart.py", "drawings.py", "pictures.py", "errata_engines.py")
MODULES = tuple(path for path in sorted(PAGES.rglob("*.py")) if not {"programs", "snippets"} & set(path.parts))

LONGEST = 35  # words: two or three lines of a page

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


@pytest.mark.parametrize("path", [*TEMPLATES, *MODULES], ids=named)
def test_no_sentence_of_a_page_is_too_long_to_be_read_at_once(path):
    assert [long for text in written(path) for long in long_sentences(text)] == []


@pytest.mark.parametrize("path", [*TEMPLATES, *(p for p in MODULES if p.name not in DRAWING)], ids=named)
def test_formulas_of_a_page_are_mathematics(path):
    assert [found for text in written(path) for found in ascii_mathematics(text)] == []


def test_a_long_sentence_and_a_formula_in_letters_are_noticed():
    long = "word " * (LONGEST + 1)
    assert long_sentences(f"Short. {long.strip()}.") != []
    assert long_sentences(f"{'word ' * LONGEST}{{% filter if_measured %}}{{{{ one }}}} more{{% endfilter %}}.") != []
    assert long_sentences(("Short enough. " * 40).strip()) == []
    for formula in ("sqrt(2)", "N^2", "exp(4 t)", "d/dt x", "J-dot v", "kappa_A", "t + dt/2", "O(N)", "omega x r"):
        assert ascii_mathematics(f"It is {formula}.") != [], formula
        assert ascii_mathematics(f"It is ${formula}$ or `{formula}`.") == [], formula
    assert strings('"""Told."""\nx = f"a {y} b" "c"\n') == ["a 0 bc"]
