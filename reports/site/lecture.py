"""The lecture as a Markdown page: its cells are run once, and stand with their output and their pictures."""

from __future__ import annotations

import io
import json
import sys
import warnings
from contextlib import redirect_stdout
from pathlib import Path

from reports.run.installed import environment
from reports.site.packages import printed

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 300  # s


def render_lecture(notebook: str) -> dict[str, str]:
    """The page "lecture.md" and its pictures by name; the last cell, the solutions, is folded.

    Raises NotFetched with the reason where a cell fails.
    """
    cells = json.loads(notebook)["cells"]
    sources = ["".join(cell["source"]) for cell in cells]
    codes = [source for cell, source in zip(cells, sources, strict=True) if cell["cell_type"] == "code"]
    words = [sys.executable, "-m", "reports.site.lecture"]
    runs = iter(json.loads(printed(words, "a cell fails", PATIENCE, input=json.dumps(codes), env=environment(ROOT))))
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
    """Run the cells that come as JSON, and write the output and the pictures of each."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    warnings.simplefilter("ignore")  # that nothing can be shown here
    names, runs = {"__name__": "lecture"}, []
    for code in json.load(sys.stdin):
        out, pictures = io.StringIO(), []
        with redirect_stdout(out):
            exec(code, names)
        for number in plt.get_fignums():
            drawn = io.StringIO()
            plt.figure(number).savefig(drawn, format="svg", metadata={"Date": None})
            pictures.append(drawn.getvalue())
        plt.close("all")
        runs.append((out.getvalue(), pictures))
    json.dump(runs, sys.stdout)


if __name__ == "__main__":
    main()
