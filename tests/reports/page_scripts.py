"""Scripts of the site in Node.js, without a browser."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from reports.site.munk2d import COMPILED


def run_in_node(folder: Path, script: str, given: Any = None) -> Any:
    """Return the JSON that a script prints beside copies of the site's scripts; `given` is its standard input."""
    if shutil.which("node") is None:
        pytest.skip("no Node.js is installed")
    for path in (COMPILED, *(COMPILED.parent / "assets").glob("*.js")):
        shutil.copy(path, folder)
    (folder / "package.json").write_text('{"type": "module"}')
    (folder / "run.js").write_text(script)
    text = json.dumps(given)
    ended = subprocess.run(
        ["node", "run.js"], input=text, cwd=folder, capture_output=True, encoding="utf-8", check=False
    )
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)
