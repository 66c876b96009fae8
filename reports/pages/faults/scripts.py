"""The scripts that show the faults, run as they are printed."""

from __future__ import annotations

import contextlib
import hashlib
import io
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from reports.grid.tasks import Task, Values

FOLDER = Path(__file__).parent / "snippets"


@cache
def source(name: str) -> str:
    """The script's text. Raises FileNotFoundError for a name that is none."""
    return (FOLDER / f"{name}.py").read_text(encoding="utf-8")


def said(name: str) -> tuple[float, float]:
    """What the script expects and what it finds, run in this process, with the engine that is installed."""
    space: dict[str, float] = {"__name__": "__main__"}  # type: ignore[dict-item]
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(source(name), f"{name}.py", "exec"), space)
    return float(space["expected"]), float(space["found"])


@dataclass(frozen=True)
class Script(Task):
    """One script; `digest` is that of its text, so that an answer to another text is stale."""

    name: str
    digest: str

    @property
    def cost(self) -> float:
        return 0.05  # measured: compiling a model

    @property
    def label(self) -> str:
        return f"script {self.name}"

    def run(self) -> Values:
        """`expected` and `found`, in the unit that the script says, and `version` of the engine's package."""
        import mujoco
        import pymunk

        expected, found = said(self.name)
        # pymunk's own word is wrong in some releases, MuJoCo's is not; neither distribution has one name for good.
        version = mujoco.__version__ if self.name.startswith("mujoco") else pymunk.version
        return {"expected": np.asarray(expected), "found": np.asarray(found), "version": version}


def script(name: str) -> Script:
    """The task of a script as it stands now."""
    return Script(name, hashlib.sha256(source(name).encode()).hexdigest()[:16])
