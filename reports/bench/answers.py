"""How long a user waits for the first useful answer: whole commands, cold, each as a process into an empty folder."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from reports.model.fingerprint import ROOT
from reports.run.files import temporary_folder

TURNS = 3
MODEL = ROOT / "reports" / "pages" / "your_model" / "models" / "four_bar.xml"


@dataclass(frozen=True)
class Question:
    """A command, and within how many seconds [wall, on a quiet machine of two cores] it is to answer."""

    words: tuple[str, ...]
    wanted: float


@dataclass(frozen=True)
class Waited:
    """Seconds of the quickest of TURNS: of the clock, and CPU seconds of the process and those that it waited for."""

    question: Question
    wall: float
    cpu: float
    status: int


def questions(versions: Sequence[str]) -> tuple[Question, ...]:
    """`versions`: two releases of one engine, NAME==VERSION, that are compared; they are installed beforehand."""
    return (
        Question(("--help",), 0.15),
        Question(("check", str(MODEL)), 1.5),
        Question(("run", "free_four_bar", "--quick"), 4.0),
        Question(("compare", *versions, "--scenes", "free_four_bar"), 20.0),
    )


def waited(question: Question) -> Waited:
    """Run it TURNS times; what it prints goes nowhere."""
    command = [sys.executable, "-m", "reports", *question.words]
    found = []
    for _ in range(TURNS):
        with temporary_folder() as folder:
            own = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
            begin = time.monotonic()
            process = subprocess.Popen(
                command, cwd=Path(folder), env=own, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            found.append((time.monotonic() - begin, usage.ru_utime + usage.ru_stime, process.returncode))
    wall, cpu, status = min(found)
    return Waited(question, wall, cpu, status)
