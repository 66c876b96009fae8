"""Between a worker of a cluster and the processes that run cells: one such process, supervised, in a process beside it.

A Dask worker is a process that may have no children of its own, and one that native code must not end. So each of its
threads has a foreman: a plain process that reads chunks of items, runs them as `supervise` does, and writes the
answers. It ends with the worker. Worker and foreman pass items on as bytes: neither imports an engine.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from reports.model.fingerprint import ROOT, digest_of, versions_of
from reports.run.supervisor import Crew, Watch, crew

_own = threading.local()  # a worker with several threads runs as many chunks at a time
_all: set[Foreman | Inside] = set()
_door = threading.Lock()  # held while somebody comes into `_all`, or finds that nobody may any more
_admitted = False  # whether foremen inside this process may begin


@dataclass(frozen=True)
class Request:
    """A chunk: pickled items, the pickled function that is run of each, and the limits of `supervise` [s].

    sources: (modules, digest) of all items, see `reports.model.fingerprint`. paths: where the client finds modules; on
    the same machine a file of its user is found there too.
    """

    function: bytes
    items: tuple[bytes, ...]
    sources: frozenset[tuple[frozenset[str], str]]
    limit: float
    wall: float
    paths: tuple[str, ...] = ()
    inside: bool = False

    @property
    def terms(self) -> tuple[float, float, tuple[str, ...]]:
        return self.limit, self.wall, self.paths


@dataclass(frozen=True)
class Refusal:
    """Nothing of a chunk was run: some of its `modules` have other files or `versions` here than at the client."""

    modules: frozenset[str]
    versions: dict[str, str]


@dataclass(frozen=True)
class Answers:
    """(index of the item, its result or Loss, note) of every item, as `supervise` tells them; `seconds` it all took."""

    told: tuple[tuple[int, Any, str], ...]
    seconds: float


Reply = Answers | Refusal


class Foreman:
    """The process, as a worker sees it."""

    def __init__(self, request: Request) -> None:
        self.terms = request.terms
        paths = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH", ""))))
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "reports.run.foreman"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": paths},
        )
        _all.add(self)
        self._send(pickle.dumps(self.terms))

    def answered(self, data: bytes) -> bytes:
        """The pickled reply to a pickled request. Raises EOFError or OSError if the process has ended."""
        self._send(data)
        assert self._process.stdout is not None
        return _read(self._process.stdout)

    def end(self) -> None:
        _all.discard(self)
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                if pipe is not None:
                    pipe.close()

    def _send(self, data: bytes) -> None:
        assert self._process.stdin is not None
        _write(self._process.stdin, data)


class Inside:
    """What a foreman does, in a thread of the client: its process may have children, and they share one fork server.

    A foreman of its own would import all engines once more for each worker.
    """

    def __init__(self, request: Request) -> None:
        """Raises EOFError once they are dismissed: a thread may have begun with what nobody waits for."""
        self.terms = request.terms
        self._stack = ExitStack()
        self._crew: Crew | None = None
        self._at_work = threading.Lock()
        self._ended = False
        with _door:
            self._ended = not _admitted
            self._watch([])
            _all.add(self)

    def answered(self, data: bytes) -> bytes:
        """The pickled reply to a pickled request. Raises EOFError if it is ended meanwhile."""
        with self._at_work:
            self._watch([])
            request: Request = pickle.loads(data)
            if self._crew is None:
                self._crew = self._stack.enter_context(crew(request.limit, 1, request.wall))
            return pickle.dumps(reply(self._crew, request, self._watch))

    def end(self) -> None:
        _all.discard(self)
        self._ended = True
        with self._at_work:  # its thread sees that within a moment
            self._stack.close()

    def _watch(self, running: list[Any]) -> None:
        if self._ended:
            raise EOFError("nobody waits for this any more")


@dataclass(frozen=True)
class Unpacked:
    """A function of an item, of the item's place and bytes."""

    function: bytes

    def __call__(self, item: tuple[int, bytes]) -> Any:
        return pickle.loads(self.function)(pickle.loads(item[1]))


def answered(data: bytes) -> bytes:
    """What a Dask worker runs: a pickled Request in, a pickled Reply out, by the foreman of this thread.

    Raises EOFError or OSError if the foreman ends meanwhile: the chunk is then run again somewhere.
    """
    request: Request = pickle.loads(data)
    if refusal := refused(request):
        return pickle.dumps(refusal)
    foreman: Foreman | Inside | None = getattr(_own, "foreman", None)
    if foreman is not None and foreman.terms != request.terms:
        foreman.end()
        foreman = None
    try:
        if foreman is None:
            foreman = _own.foreman = Inside(request) if request.inside else Foreman(request)
        return foreman.answered(data)
    except (EOFError, OSError):
        if foreman is not None:
            foreman.end()
        _own.foreman = None
        raise


def refused(request: Request) -> Refusal | None:
    """Whether what is behind the items is something else here than where they come from."""
    add_paths(request.paths)
    for modules, digest in request.sources:
        if digest_of(modules) != digest:
            return Refusal(modules, versions_of(modules))
    return None


def add_paths(paths: Sequence[str]) -> None:
    """To the end of the search for modules, those that are here."""
    sys.path += [path for path in paths if path not in sys.path and Path(path).exists()]


def admit() -> None:
    """Foremen inside this process may begin, until `dismiss`."""
    global _admitted
    with _door:
        _admitted = True


def dismiss() -> None:
    """End all foremen of this process, in whatever threads they were started; none inside it begins any more."""
    global _admitted
    with _door:
        _admitted = False
    while _all:
        _all.pop().end()


def main() -> None:
    """The process: answers requests until nobody asks any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it ends with the worker, and not before
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what somebody's module prints is no reply
    parent = os.getppid()

    def watch(running: list[Any]) -> None:
        if os.getppid() != parent:
            raise EOFError("the worker is gone")

    with suppress(EOFError, OSError):
        limit, wall, paths = pickle.loads(_read(requests))
        add_paths(paths)
        with crew(limit, 1, wall) as own:
            while True:
                _write(replies, pickle.dumps(reply(own, pickle.loads(_read(requests)), watch)))


def reply(own: Crew, request: Request, watch: Watch | None = None) -> Answers:
    """Run a chunk."""
    start = time.monotonic()
    own.give(Unpacked(request.function), enumerate(request.items))
    told = tuple((place, result, note) for (place, _), result, note in own.answers(watch))
    return Answers(told, time.monotonic() - start)


def _write(pipe: IO[bytes], data: bytes) -> None:
    pipe.write(len(data).to_bytes(8, "big") + data)
    pipe.flush()


def _read(pipe: IO[bytes]) -> bytes:
    """One message. Raises EOFError if there is none."""
    head = pipe.read(8)
    length = int.from_bytes(head, "big")
    data = pipe.read(length) if len(head) == 8 else b""
    if len(head) < 8 or len(data) < length:
        raise EOFError("the pipe has ended")
    return data


if __name__ == "__main__":
    # As the module of this name: what is unpickled here are its classes, not those of `__main__`.
    from reports.run import foreman

    foreman.main()
