"""Formulas of the pages as MathML by KaTeX, run with Node while the site is built; as TeX where that is not there."""

from __future__ import annotations

import json
import shutil
import subprocess
from html import escape
from pathlib import Path

from reports.run.files import temporary_folder
from reports.site.markdown import Formulas
from reports.site.packages import NotFetched, fetched
from reports.site.packages_used import KATEX

SCRIPT = Path(__file__).with_suffix(".mjs")
PATIENCE = 120  # s for all formulas


def rendered(formulas: Formulas, cache: Path) -> tuple[list[str], str]:
    """The formulas in their order, and why they are TeX as written; empty if they are not.

    Raises ValueError for a formula that KaTeX does not understand: it would be wrong on the Markdown page too.
    """
    asked = list(formulas.found)
    node = shutil.which("node")
    if node is None:
        return _as_written(asked), "node is not installed"
    try:
        module = fetched(KATEX, cache)["dist/katex.mjs"]
    except NotFetched as reason:
        return _as_written(asked), str(reason)
    with temporary_folder() as folder:
        path = folder / "katex.mjs"
        path.write_bytes(module)
        ended = subprocess.run(
            [node, str(SCRIPT), str(path)],
            input=json.dumps(asked),
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            encoding="utf-8",
        )
    if ended.returncode:
        told = [line for line in ended.stderr.splitlines() if "Error" in line]
        raise ValueError(f"KaTeX refuses a formula: {told[0] if told else ended.stderr[-200:]}")
    return json.loads(ended.stdout), ""


def _as_written(asked: list[tuple[str, bool]]) -> list[str]:
    return [f'<code class="tex{" displayed" if displayed else ""}">{escape(each)}</code>' for each, displayed in asked]
