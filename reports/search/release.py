"""MuJoCo of another release, in a process of its own that answers one model after another.

As a program it reads models as JSON line by line, and writes for each a line of JSON: the errors, or what was raised.
"""

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache
from pathlib import Path

from reports.run.installed import environment, installed
from reports.search import mujoco_alone

DISTRIBUTIONS = ("mujoco-core", "mujoco")  # the first is a part of the second from 4.0 on
ROOT = Path(__file__).resolve().parents[2]


class Release:
    """The process; it ends with the one that started it."""

    def __init__(self, folder: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "reports.search.release"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            cwd=ROOT,
            env=environment(folder, (ROOT,)),
        )

    def asked(self, model: mujoco_alone.Model) -> dict:
        """What `answer` gives there. Raises RuntimeError where the process ended."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(f"{mujoco_alone.as_text(model)}\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            release.cache_clear()
            raise RuntimeError(f"the process of this release ended with {self._process.wait()}")
        return json.loads(line)

    def close(self) -> None:
        """End it."""
        self._process.kill()
        self._process.communicate()


@cache
def release(version: str) -> Release:
    """The process of a release, started once. Raises BadInput where it can't be had."""
    return Release(installed(DISTRIBUTIONS, version))


def release_of(name: str) -> str | None:
    """Of which release a subject called so is, '' for the installed one; None if it is not MuJoCo alone."""
    words = name.split()
    return " ".join(words[2:]) if words[:2] == ["mujoco", "alone"] else None


def answer(model: mujoco_alone.Model) -> dict:
    """{"errors": ...}, or {"raised": sentence}; with the version, and what was found and expected."""
    import mujoco  # of the folder

    try:
        found, expected = mujoco_alone.found_and_expected(model, mujoco_alone.judged(model))
        told = {"errors": mujoco_alone.errors(model), "found": found.tolist(), "expected": expected.tolist()}
    except Exception as error:
        told = {"raised": f"{type(error).__name__}: {error}"}
    return told | {"version": mujoco.__version__}


def main() -> None:
    for line in sys.stdin:
        print(json.dumps(answer(mujoco_alone.from_text(line))), flush=True)


if __name__ == "__main__":
    main()
