"""Conversions: Converts Markdown to HTML, formulas to MathML, and the notebook of the lecture to Markdown.

The cells of the lecture run in a separate process; the page shows their output and pictures.
"""

from __future__ import annotations

import io
import json
import re
import sys
import warnings
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path

from reports.model.ending import BadInput
from reports.run.installed import environment
from reports.site.packages import printed
from reports.write.templates import inert

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 300  # timeout for all cells of the lecture [s]


@cache
def mathml(formula: str, displayed: bool = False) -> str:
    """Return a formula as MathML. Raises BadInput for a command that latex2mathml does not know."""
    from latex2mathml.converter import convert  # pyright: ignore[reportMissingImports]

    rendered = convert(formula.replace(r"\arg", r"\operatorname{arg}"), display="block" if displayed else "inline")
    if "\\" in rendered:
        raise BadInput(f"the formula {formula!r} has a command that latex2mathml does not know: use another command")
    return rendered


def render_html(text: str) -> str:
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin  # pyright: ignore[reportMissingImports]

    reader = MarkdownIt("commonmark", {"html": True}).enable("table")
    dollarmath_plugin(
        reader,
        allow_space=False,
        allow_digits=False,
        renderer=lambda formula, options: mathml(formula, options["display_mode"]),
    )
    for rule in ("html_block", "html_inline"):
        reader.add_render_rule(rule, lambda self, tokens, index, options, env: inert(tokens[index].content))
    return str(reader.render(text))


def title(text: str) -> str:
    return next((line[2:].strip() for line in text.splitlines() if line.startswith("# ")), "")


def section(text: str, heading: str) -> str | None:
    """Return a section of a Markdown page, including subsections, or None if the heading is missing."""
    start, rank, fenced = None, 0, False
    lines = text.splitlines()
    for index, line in enumerate(lines):
        fenced ^= line.lstrip().startswith("```")
        match = None if fenced else re.match(r"(#+) (.*)", line)
        if match and start is None and match[2].strip() == heading:
            start, rank = index + 1, len(match[1])
        elif match and start is not None and len(match[1]) <= rank:
            return "\n".join(lines[start:index]).strip()
    return None if start is None else "\n".join(lines[start:]).strip()


def render_lecture(notebook: str) -> dict[str, str]:
    """Return the page "lecture.md" and its pictures by name. The last cell has the solutions and is collapsed.

    Raises NotFetched if a cell fails.
    """
    cells = json.loads(notebook)["cells"]
    sources = ["".join(cell["source"]) for cell in cells]
    codes = [source for cell, source in zip(cells, sources, strict=True) if cell["cell_type"] == "code"]
    command = [sys.executable, "-m", "reports.site.markdown"]
    runs = iter(json.loads(printed(command, "a cell fails", PATIENCE, input=json.dumps(codes), env=environment(ROOT))))
    parts, files = [], {}
    for cell, source in zip(cells, sources, strict=True):
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        output, pictures = next(runs)
        parts.append(f"```python\n{source}\n```" + (f"\n\n```text\n{output.rstrip()}\n```" if output else ""))
        for picture in pictures:
            name = f"lecture_{len(files)}.svg"
            files[name] = picture
            parts.append(f"![Figure {len(files)}]({name})")
    parts[-1] = f"<details><summary>Solutions</summary>\n\n{parts[-1]}\n\n</details>"
    return {"lecture.md": "\n\n".join(parts), **files}


def main() -> None:
    """Read cells as JSON from the standard input, run them, and write their output and pictures as JSON."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    warnings.simplefilter("ignore")  # matplotlib warns that this backend shows no window
    names, runs = {"__name__": "lecture"}, []
    for code in json.load(sys.stdin):
        out, pictures = io.StringIO(), []
        with redirect_stdout(out):
            exec(code, names)
        for number in plt.get_fignums():
            picture = io.StringIO()
            plt.figure(number).savefig(picture, format="svg", metadata={"Date": None})
            pictures.append(picture.getvalue())
        plt.close("all")
        runs.append((out.getvalue(), pictures))
    json.dump(runs, sys.stdout)


if __name__ == "__main__":
    main()
