"""The process of one column: with a version's folder first on its path, it runs cells and says each row.

Started by `reports.versions.column`, which writes two pickles to its standard input: folders where modules are looked
for, and a VersionRequest. It keeps that open: when it is closed, this process ends, and its workers with it.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO


def main() -> None:
    """Answer one request."""
    # The parent alone decides what a signal to all processes of the command means: this one ends with its stdin.
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    # Whatever an engine prints, also from native code and while it is imported, goes where errors go.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.path += [path for path in pickle.load(sys.stdin.buffer) if path not in sys.path]
    request = pickle.load(sys.stdin.buffer)
    threading.Thread(target=_end_with_the_parent, args=(sys.stdin.fileno(),), daemon=True).start()

    def say(message: Any) -> None:
        pickle.dump(message, out)
        out.flush()

    say(answer(request, say))
    _end(out)


def _end_with_the_parent(number: int) -> None:
    while os.read(number, 1):
        pass
    os._exit(1)


def _end(out: BinaryIO) -> None:
    out.close()
    os._exit(0)  # threads of an engine must not keep it


def answer(request: Any, say: Callable[[Any], None]) -> Any:
    """Run what is asked for and say each row; Finished, or a Trouble."""
    from engines.imported_release import other_release
    from reports.run.supervisor import WorkersLost
    from reports.versions.column import Finished, Trouble

    engines = _engines(request)
    if isinstance(engines, Trouble):
        return engines
    strange = _from_elsewhere(request.modules, request.place)
    if strange:
        return Trouble(strange, lacks=False)
    if sentence := other_release(engines, elsewhere=False):
        return Trouble(sentence, mislabelled=True)
    try:
        _run(request, engines, say)
    except WorkersLost as error:
        return Trouble(str(error), lacks=False)
    return Finished()


def _engines(request: Any) -> Any:
    """The engines asked for, or a Trouble that says why they can't be used with this version."""
    from engines import registry
    from engines.loading import describe, is_reference
    from reports.versions.column import Trouble

    try:
        known = (*registry.VARIANTS, *registry.OTHERS)
        known = registry.load(request.engine, request.folder) if is_reference(request.engine) else known
    except ValueError as error:
        return Trouble(f"our adapter can't use it: {error}")
    found = [engine for engine in known if is_reference(request.engine) or engine.name == request.engine]
    for engine in found[:1]:
        if engine.missing:
            return Trouble(f"our adapter can't use it: {engine.missing}")
        for module in engine.modules:  # extras import theirs when they build
            try:
                import_module(module)
            except Exception as error:
                return Trouble(f"{module} can't be imported: {describe(error)}")
    if not found:
        own = [line for line in registry.TROUBLES if request.engine in line]
        return Trouble(f"our adapter can't use it: {(own or ['it registers no engine'])[0]}")
    return [engine for engine in found if not request.variants or engine.variant in request.variants]


def _from_elsewhere(modules: tuple[str, ...], place: Path) -> str:
    """A sentence if a module was imported from another place than this version's; empty if all are its own."""
    imported = [name for name in modules if name in sys.modules]
    for name in imported:
        file = getattr(sys.modules[name], "__file__", None)
        if file is None or place.resolve() not in Path(file).resolve().parents:
            return f"{name} was imported from {file}, and not from {place}"
    return "" if imported else f"the engine imports none of {', '.join(modules)}, which is what lies in {place}"


def _run(request: Any, engines: list[Any], say: Callable[[Any], None]) -> None:
    from reports.model.measure import Measurement
    from reports.run.running import missing, run_into
    from reports.run.store import Store
    from reports.versions.column import Running, TreesRow, cells_of
    from reports.versions.trees import SIZES, Trees, of_trees

    cells = cells_of(request, engines)
    tasks: list[Trees] = []
    if request.trees:
        tasks = [Trees(method, *size) for size in SIZES for method in of_trees(request.engine, engines)]
    with Store(request.store) as store:
        waiting = {item.key for item in missing([*cells, *tasks], store, request.limit)}
        if not request.fresh:
            for row in store.get(cell for cell in cells if cell.key not in waiting).values():
                say(row)

        def done(result: Any) -> None:
            if isinstance(result, Measurement):
                say(result)

        run_into(
            store,
            [*cells, *tasks],
            request.fresh,
            request.limit,
            done=done,
            watch=lambda items: say(Running(tuple(item.label for item in items))),
        )
        answers = store.answers(tasks)
        for task in tasks:
            if task not in answers:
                continue
            found = answers[task]
            miss = tuple(map(float, found.array("miss"))) if found.finished else ()
            own = (task.method.name, task.method.variant, task.bodies, task.loops)
            say(TreesRow(*own, str(found.outcome), found.sentence, miss))


if __name__ == "__main__":
    main()
