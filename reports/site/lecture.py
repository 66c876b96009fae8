"""The lecture as a page: its cells are run once, and stand with what they print and draw."""

from __future__ import annotations

import io
import json
import sys
import warnings
from contextlib import redirect_stdout
from html import escape

from reports.model.fingerprint import ROOT
from reports.run.installed import environment
from reports.site import markdown
from reports.site.packages import printed

PATIENCE = 300  # s


def html(notebook: str) -> str:
    """The cells of a notebook in their order; its last one, the solutions, is folded. Raises NotFetched, with why."""
    cells = json.loads(notebook)["cells"]
    sources = ["".join(cell["source"]) for cell in cells]
    codes = [source for cell, source in zip(cells, sources, strict=True) if cell["cell_type"] == "code"]
    words = [sys.executable, "-m", "reports.site.lecture"]
    made = iter(json.loads(printed(words, "a cell fails", PATIENCE, input=json.dumps(codes), env=environment(ROOT))))
    parts = []
    for cell, source in zip(cells, sources, strict=True):
        if cell["cell_type"] == "markdown":
            parts.append(markdown.html(source))
            continue
        told, pictures = next(made)
        parts.append(f"<pre><code>{escape(source)}</code></pre>")
        if told:
            parts[-1] += f'<pre class="printed">{escape(told)}</pre>'
        parts[-1] += "".join(f'<div class="drawn">{picture}</div>' for picture in pictures)
    parts[-1] = f"<details><summary>Solutions</summary>{parts[-1]}</details>"
    return "".join(parts)


def main() -> None:
    """Run the cells that come as JSON, and write what each printed and drew."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    warnings.simplefilter("ignore")  # that nothing can be shown here
    given, told = {"__name__": "lecture"}, []
    for code in json.load(sys.stdin):
        out, pictures = io.StringIO(), []
        with redirect_stdout(out):
            exec(code, given)
        for number in plt.get_fignums():
            drawn = io.StringIO()
            plt.figure(number).savefig(drawn, format="svg", metadata={"Date": None})
            pictures.append(drawn.getvalue()[drawn.getvalue().index("<svg") :])
        plt.close("all")
        told.append((out.getvalue(), pictures))
    json.dump(told, sys.stdout)


if __name__ == "__main__":
    main()
