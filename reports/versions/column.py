"""One version's column: a process of its own with the version first on its path, and what it said of every cell."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from engines import Engine
from reference.scene import Scene
from reports.model.cells import Cell, estimated_cost
from reports.model.ending import BadInput
from reports.model.fingerprint import ROOT
from reports.model.measure import Measurement, blank
from reports.model.outcomes import Outcome, describe_exit
from reports.run.files import temporary_folder
from reports.run.installed import environment
from reports.run.running import TIME_LIMIT


@dataclass(frozen=True)
class VersionRequest:
    """Which scenes, in which engine at how many steps a sample; what is stored already is not run again.

    engine: a registered name, or a reference (`engines.loading`) that counts from `folder`; its variants of all scenes
    are run, or those named. modules: top-level packages that have to come from `place`, the version's own folder.
    most: a cell is left out whose run would take longer by its engine's formula [s].
    store: where rows are kept, as in every run.
    """

    scenes: tuple[Scene, ...]
    engine: str
    modules: tuple[str, ...]
    place: Path
    store: Path
    variants: tuple[str, ...] = ()
    every: tuple[int, ...] = (10,)
    most: float = float("inf")
    trees: bool = False
    fresh: bool = False
    folder: Path = Path(".")
    limit: float = TIME_LIMIT


@dataclass(frozen=True)
class Running:
    """Still alive; what it is at."""

    labels: tuple[str, ...] = ()


@dataclass(frozen=True)
class Trouble:
    """The version can't be used at all: one sentence. `lacks`: it is the version, that has not what is called;
    `mislabelled`: its code is not of the version that it is called by.
    """

    sentence: str
    lacks: bool = True
    mislabelled: bool = False


@dataclass(frozen=True)
class TreesRow:
    """What an engine made of random trees (`reports.versions.trees`)."""

    engine: str
    variant: str
    bodies: int
    loops: int
    outcome: str
    sentence: str
    miss: tuple[float, ...] = ()


@dataclass(frozen=True)
class Finished:
    """All that was asked for was said."""


MARK = "known to be wrong"  # the word of adapters for such a release, in the sentence of every row
# Exceptions of Python for a name that is not there: what our adapter calls is newer than the version.
LACKING = ("AttributeError:", "ImportError:", "ModuleNotFoundError:")
LONGEST = 300  # letters of last words

Watch = Callable[[Sequence[str]], None]


@dataclass(frozen=True)
class VersionColumn:
    """All rows of one version; `trouble`: why there are none of its own, a sentence."""

    version: str
    rows: tuple[Measurement, ...]
    trees: tuple[TreesRow, ...] = ()
    trouble: str = ""

    @property
    def mark(self) -> str:
        """Why this version's numbers are known to be wrong, in the words of its rows; empty if they aren't."""
        told = (part for row in self.rows for part in row.sentence.split("; ") if MARK in part)
        return next(told, "").removeprefix("ours: ")


def column(
    version: str,
    request: VersionRequest,
    engines: Sequence[Engine],
    watch: Watch = lambda labels: None,
    done: Callable[[Measurement], None] = lambda row: None,
) -> VersionColumn:
    """Run a version's column. Whatever becomes of its process is told in rows, and nothing is raised for it; BadInput
    where its code is of another version than its metadata say.

    engines: as they are in this process, for the rows of a version that can't be used. `watch` is called a few times a
    second, and may raise: then the process is ended; the rows so far are in the store. `done`: with each row.
    """
    rows: list[Measurement] = []
    trees: list[TreesRow] = []
    trouble: Trouble | None = None
    for message in _messages(request):
        match message:
            case Measurement():
                rows.append(_told(message, version))
                done(rows[-1])
            case TreesRow():
                trees.append(message)
            case Trouble(mislabelled=True):
                raise BadInput(message.sentence)
            case Trouble():
                trouble = message
            case Running(labels):
                watch(labels)
    if trouble is None:
        return VersionColumn(version, tuple(rows), tuple(trees))
    there = {(row.scene, row.variant, row.every) for row in rows}
    outcome = Outcome.UNSUPPORTED if trouble.lacks else Outcome.ABORTED
    rows += [
        blank(cell, outcome, trouble.sentence)
        for cell in cells_of(request, engines)
        if (cell.scene.name, cell.engine.variant, cell.every) not in there
    ]
    return VersionColumn(version, tuple(rows), tuple(trees), trouble.sentence)


def cells_of(request: VersionRequest, engines: Sequence[Engine]) -> list[Cell]:
    """What is asked for, of these engines."""
    cells = [Cell(scene, engine, every) for every in request.every for scene in request.scenes for engine in engines]
    return [cell for cell in cells if estimated_cost(cell) <= request.most]


def _told(row: Measurement, version: str) -> Measurement:
    """The row; an outcome of its own for what the version has not got."""
    if row.outcome in (Outcome.FAILED, Outcome.LOST) and row.sentence.startswith(LACKING):
        sentence = f"{row.engine} {version} lacks what our adapter calls: {row.sentence.partition(': ')[2]}"
        return replace(row, outcome=Outcome.UNSUPPORTED, sentence=sentence)
    return row


def _messages(request: VersionRequest) -> Iterator[Any]:
    """What the process says; a Trouble at the end if it ended too early."""
    with temporary_folder() as folder:
        # In a folder of its own: what an engine leaves behind goes with it, and what lies there hides no module.
        words = folder / "said.txt"
        with words.open("wb") as errors:
            process = subprocess.Popen(
                [sys.executable, "-m", "reports.versions.child"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                cwd=folder,
                env=environment(request.place, (ROOT,)) | {"TMPDIR": str(folder)},
            )
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            try:
                for part in (tuple(path for path in sys.path if path), request):
                    pickle.dump(part, process.stdin)
                process.stdin.flush()
                message: Any = None
                while not isinstance(message, Finished | Trouble):
                    message = pickle.load(process.stdout)
                    yield message
            except (EOFError, OSError, pickle.UnpicklingError):
                code = process.wait()
                yield Trouble(_last_words(words, code), lacks=False)
        finally:
            process.kill()
            process.stdin.close()
            process.stdout.close()
            process.wait()


def _last_words(path: Path, code: int) -> str:
    text = path.read_text(encoding="utf-8", errors="replace")
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return ": ".join(filter(None, (describe_exit(code), lines[-1][:LONGEST] if lines else "")))


def modules_in(folder: Path) -> tuple[str, ...]:
    """The top-level packages and modules that lie in a folder."""
    names = {
        path.name.split(".")[0]
        for path in folder.iterdir()
        if (path.is_dir() and (path / "__init__.py").is_file()) or path.suffix in (".py", ".so", ".pyd")
    }
    return tuple(sorted(name for name in names if name.isidentifier()))
