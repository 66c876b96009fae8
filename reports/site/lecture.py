"""The lecture as a page: its cells are run once, and stand with what they print and draw."""

from __future__ import annotations

import io
import json
import subprocess
import sys
import warnings
from contextlib import redirect_stdout
from html import escape

from reports.site import markdown
from reports.site.packages import NotFetched

PATIENCE = 300  # s


def html(notebook: str) -> str:
    """The cells of a notebook in their order; its last one, the solutions, is folded. Raises NotFetched, with why."""
    cells = json.loads(notebook)["cells"]
    sources = ["".join(cell["source"]) for cell in cells]
    codes = [source for cell, source in zip(cells, sources, strict=True) if cell["cell_type"] == "code"]
    words = [sys.executable, "-m", "reports.site.lecture"]
    given = json.dumps(codes)
    ended = subprocess.run(words, input=given, capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE)
    if ended.returncode:
        raise NotFetched(f"a cell fails: {(ended.stderr.strip().splitlines() or ['no reason'])[-1]}")
    made = iter(json.loads(ended.stdout))
    parts = []
    for cell, source in zip(cells, sources, strict=True):
        if cell["cell_type"] == "markdown":
            parts.append(markdown.html(source))
            continue
        printed, pictures = next(made)
        parts.append(f"<pre><code>{escape(source)}</code></pre>")
        if printed:
            parts[-1] += f'<pre class="printed">{escape(printed)}</pre>'
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
        printed, pictures = io.StringIO(), []
        with redirect_stdout(printed):
            exec(code, given)
        for number in plt.get_fignums():
            drawn = io.StringIO()
            plt.figure(number).savefig(drawn, format="svg", metadata={"Date": None})
            pictures.append(drawn.getvalue()[drawn.getvalue().index("<svg") :])
        plt.close("all")
        told.append((printed.getvalue(), pictures))
    json.dump(told, sys.stdout)


if __name__ == "__main__":
    main()
