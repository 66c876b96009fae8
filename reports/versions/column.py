"""The rows of one version, which a process computes with the version's folder first in sys.path."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from engines import Engine, registry
from engines.imported_release import other_release
from engines.loading import describe, is_reference
from reference.scene import Scene
from reference.trajectory import ADAPTER_PREFIX, KNOWN_WRONG
from reports.model.cells import Cell, estimated_cost
from reports.model.ending import BadInput
from reports.model.fingerprint import ROOT
from reports.model.measure import Measurement, blank
from reports.model.outcomes import Loss, Outcome, describe_exit
from reports.model.tasks import Answer
from reports.run.files import temporary_folder
from reports.run.installed import environment
from reports.run.running import TIME_LIMIT, missing, run_into
from reports.run.store import Store
from reports.run.supervisor import WorkersLost, supervise
from reports.versions.trees import Trees, engines_for_trees

LONGEST_LAST_LINE = 300  # Largest number of characters from the last line that a process has printed.

Watch = Callable[[Sequence[str]], None]


@dataclass(frozen=True)
class VersionRequest:
    scenes: tuple[Scene, ...]
    engine: str  # A registered name, or a reference (`engines.loading`) relative to `folder`.
    modules: tuple[str, ...]  # Top-level packages that must be imported from `location`.
    location: Path  # The folder of the version.
    store: Path
    variants: tuple[str, ...] = ()  # All if empty.
    every: tuple[int, ...] = (10,)  # Steps between samples.
    most: float = float("inf")  # Longest estimated time of a cell [s]. Longer cells are left out.
    trees: bool = False  # Whether random trees are run too.
    fresh: bool = False  # Whether stored cells are run again.
    folder: Path = Path(".")
    limit: float = TIME_LIMIT


@dataclass(frozen=True)
class VersionColumn:
    version: str
    rows: tuple[Measurement, ...]
    trees: tuple[tuple[Trees, Answer], ...] = ()
    trouble: str = ""  # The reason why the version can't be used.

    @property
    def mark(self) -> str:
        """A sentence that explains why this version is known to be wrong, or an empty text."""
        parts = (part for row in self.rows for part in row.sentence.split("; ") if KNOWN_WRONG in part)
        return next(parts, "").removeprefix(f"{ADAPTER_PREFIX} ")


def column(
    version: str,
    request: VersionRequest,
    engines: Sequence[Engine],
    watch: Watch = lambda labels: None,
    done: Callable[[Measurement], None] = lambda row: None,
) -> VersionColumn:
    """Run a version. If the process of the version fails, the rows report this. engines: engines of this process, which
    are needed for the rows of a version that can't be used. `watch` is called a few times a second with the labels of
    running cells. If `watch` raises, the process is ended, and the stored rows remain. `done` is called with each row.
    Raises BadInput if the code and the metadata have different version numbers."""
    rows, trees, loss = list[Measurement](), list[tuple[Trees, Answer]](), None
    for message in _messages(request):
        match message:
            case Measurement():
                rows.append(message)
                done(message)
            case (Trees() as task, answer):
                trees.append((task, answer))
            case list():
                watch(message)
            case Loss(Outcome.REFUSED):
                raise BadInput(message.sentence)
            case Loss():
                loss = message
            case _:
                raise TypeError(f"message of a version's process: it is a {type(message).__name__}")
    if loss is not None:
        finished = {(row.scene, row.variant, row.every) for row in rows}
        rows += [
            blank(cell, loss.outcome, loss.sentence)
            for cell in cells_of(request, engines)
            if (cell.scene.name, cell.engine.variant, cell.every) not in finished
        ]
    return VersionColumn(version, tuple(rows), tuple(trees), loss.sentence if loss else "")


def cells_of(request: VersionRequest, engines: Sequence[Engine]) -> list[Cell]:
    cells = [Cell(scene, engine, every) for every in request.every for scene in request.scenes for engine in engines]
    return [cell for cell in cells if estimated_cost(cell) <= request.most]


def with_known_names(function: Callable[[Any], Any], item: Any) -> Any:
    """The result of a job. An adapter that uses a name that this version lacks does not support the version."""
    try:
        return function(item)
    except (AttributeError, ImportError) as error:
        return Loss(Outcome.UNSUPPORTED, f"this version lacks what our adapter calls: {error}")


def _messages(request: VersionRequest) -> Iterator[Any]:
    """Yield the messages that `answer` sends. If its process ends before the last message, yield a Loss."""
    with temporary_folder() as folder:  # Files of engines are deleted with this folder.
        error_file = folder / "said.txt"
        with error_file.open("wb") as errors:
            process = subprocess.Popen(
                [sys.executable, "-m", "reports.versions.child"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                cwd=folder,
                env=environment(request.location, (ROOT,)) | {"TMPDIR": str(folder)},
            )
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            for part in ([path for path in sys.path if path], request):
                pickle.dump(part, process.stdin)
            process.stdin.flush()
            while (message := pickle.load(process.stdout)) is not None:
                yield message
        except (EOFError, OSError, pickle.UnpicklingError):
            code = process.wait()
            lines = error_file.read_text(encoding="utf-8", errors="replace").split("\n")
            last = next((line.strip()[:LONGEST_LAST_LINE] for line in reversed(lines) if line.strip()), "")
            yield Loss(Outcome.ABORTED, ": ".join(filter(None, (describe_exit(code), last))))
        finally:
            process.kill()
            process.stdin.close()
            process.stdout.close()
            process.wait()


def answer(request: VersionRequest, send: Callable[[Any], None]) -> Loss | None:
    """Run the request in the process of the version. Return the reason if the version can't be used, else None. `send`
    is called with each row, with each (Trees, Answer), and a few times a second with the labels of running cells."""
    try:
        engines = _usable_engines(request)
    except ValueError as error:
        return Loss(Outcome.UNSUPPORTED, str(error))
    if sentence := _imported_elsewhere(request):
        return Loss(Outcome.ABORTED, sentence)
    if sentence := other_release(engines, elsewhere=False):
        return Loss(Outcome.REFUSED, sentence)
    try:
        _run(request, engines, send)
    except WorkersLost as error:
        return Loss(Outcome.ABORTED, str(error))
    return None


def _usable_engines(request: VersionRequest) -> list[Engine]:
    """The requested engines. Raises ValueError if the engines can't be used with this version."""
    cant = "our adapter can't use it"
    engines = (*registry.VARIANTS, *registry.OTHERS)
    try:
        if is_reference(request.engine):
            engines = registry.load(request.engine, request.folder)
    except ValueError as error:
        raise ValueError(f"{cant}: {error}") from None
    engines = [engine for engine in engines if is_reference(request.engine) or engine.name == request.engine]
    if not engines:
        reasons = [line for line in registry.TROUBLES if request.engine in line]
        raise ValueError(f"{cant}: {(reasons or ['it registers no engine'])[0]}")
    if engines[0].missing:
        raise ValueError(f"{cant}: {engines[0].missing}")
    for module in engines[0].modules:  # An extra imports modules only when it builds a model.
        try:
            import_module(module)
        except Exception as error:
            raise ValueError(f"{module} can't be imported: {describe(error)}") from None
    return [engine for engine in engines if not request.variants or engine.variant in request.variants]


def _imported_elsewhere(request: VersionRequest) -> str:
    location, imported = request.location, [name for name in request.modules if name in sys.modules]
    for name in imported:
        file = getattr(sys.modules[name], "__file__", None)
        if file is None or location.resolve() not in Path(file).resolve().parents:
            return f"{name} was imported from {file}, and not from {location}"
    return "" if imported else f"the engine imports none of {', '.join(request.modules)} in {location}"


def _run(request: VersionRequest, engines: Sequence[Engine], send: Callable[[Any], None]) -> None:
    cells = cells_of(request, engines)
    tasks = [Trees(engine) for engine in engines_for_trees(request.engine, engines)] if request.trees else []
    with Store(request.store) as store:
        if not request.fresh:
            waiting = set(missing(cells, store, request.limit))
            for row in store.get(cell for cell in cells if cell not in waiting).values():
                send(row)
        options: dict[str, Any] = {"watch": lambda items: send([item.label for item in items])}
        options["supervised"] = lambda function, *terms: supervise(partial(with_known_names, function), *terms)
        options["done"] = lambda result: send(result) if isinstance(result, Measurement) else None
        run_into(store, [*cells, *tasks], request.fresh, request.limit, **options)
        for task, answer in store.answers(tasks).items():
            send((task, answer))


def modules_in(folder: Path) -> tuple[str, ...]:
    names = {
        path.name.split(".")[0]
        for path in folder.iterdir()
        if (path.is_dir() and (path / "__init__.py").is_file()) or path.suffix in (".py", ".so", ".pyd")
    }
    return tuple(sorted(name for name in names if name.isidentifier()))
