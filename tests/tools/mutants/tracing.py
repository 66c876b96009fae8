"""Which tests run which blocks of the sources: what a mistake's likely tests are chosen by.

A block is the body of a function, or of a branch or a loop in it, and is named by the line of its first statement.
While tests are traced, every block is compiled with a call in front that says that it is run; the files stay as they
are, so that tests which read them see nothing of it. Programs that a test starts are traced too: they find the test's
name where pytest leaves it, and this file by `sitecustomize`. What numba compiles can't be traced.
"""

from __future__ import annotations

import ast
import builtins
import hashlib
import importlib.machinery
import json
import marshal
import os
import struct
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from tests.tools.mutants.sources import ROOT, SOURCES, Mistake, source

FOLDER = "MUTANTS_TRACED_INTO"
HIT = "__hit__"
SEEN = "sources.json"
MOST = 10_000  # lines of a file
# What numba compiles: all functions of a folder, and elsewhere those below a decorator of this name.
COMPILED, COMPILING = "engines/lagrange/compiled/", "_compiled"
INJECTED = """import os
if os.environ.get('MUTANTS_TRACED_INTO'):
    from tests.tools.mutants import tracing
    tracing.start()
"""


def blocks(tree: ast.AST, file: str) -> Iterator[list[ast.stmt]]:
    """Every block of a module that can be traced, those around it first."""
    for node in ast.iter_child_nodes(tree):
        match node:
            case ast.FunctionDef(decorator_list=above):
                if file.startswith(COMPILED) or any(getattr(name, "id", "") == COMPILING for name in above):
                    continue
                yield node.body
            case ast.If() | ast.For() | ast.While() | ast.ExceptHandler() | ast.match_case():
                if not isinstance(tree, ast.Module | ast.ClassDef):
                    yield from filter(None, (node.body, getattr(node, "orelse", [])))
        yield from blocks(node, file)


def digest(file: str) -> str:
    """Of a file's contents as they are."""
    return hashlib.sha1((ROOT / file).read_bytes()).hexdigest()[:16]


def named(block: list[ast.stmt]) -> int:
    """The line of a block's first statement that is no docstring."""
    documented = isinstance(block[0], ast.Expr) and isinstance(block[0].value, ast.Constant) and len(block) > 1
    return block[documented].lineno


class _Loader(importlib.machinery.SourceFileLoader):
    """Puts the calls in; what it has compiled is kept apart from what Python keeps."""

    def get_code(self, fullname: str) -> Any:
        file = os.path.relpath(self.get_filename(fullname), ROOT)
        if file not in SOURCES:
            return super().get_code(fullname)
        kept = Path(os.environ[FOLDER]).parent / "compiled" / f"{file.replace('/', '.')}-{digest(file)}"
        with suppress(OSError):
            return marshal.loads(kept.read_bytes())
        number = SOURCES.index(file) * MOST
        tree = ast.parse((ROOT / file).read_bytes())
        for block in list(blocks(tree, file)):
            at = next(index for index, statement in enumerate(block) if statement.lineno == named(block))
            call = ast.Call(ast.Name(HIT, ast.Load()), [ast.Constant(number + block[at].lineno)], [])
            block.insert(at, ast.copy_location(ast.Expr(call), block[at]))
        code = compile(ast.fix_missing_locations(tree), self.get_filename(fullname), "exec", dont_inherit=True)
        kept.parent.mkdir(exist_ok=True)
        part = kept.with_suffix(f".{os.getpid()}")
        part.write_bytes(marshal.dumps(code))
        part.replace(kept)
        return code


class Recorder:
    """Writes each block to a file of the test that runs, at once: a process that is killed has told what it ran."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.seen: set[int] = set()
        self.file: int | None = None

    def __call__(self, number: int) -> None:
        if number in self.seen:
            return
        self.seen.add(number)
        if self.file is None and "PYTEST_CURRENT_TEST" in os.environ:
            self.begin(os.environ["PYTEST_CURRENT_TEST"].rpartition(" (")[0])
        if self.file is not None:
            os.write(self.file, struct.pack("i", number))

    def begin(self, test: str) -> None:
        """Everything from now on belongs to this test."""
        if self.file is not None:
            os.close(self.file)
        path = self.folder / hashlib.sha1(test.encode()).hexdigest()[:16]
        self.file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        path.with_suffix(".name").write_text(test)
        self.seen.clear()

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """pytest's hook: a test begins."""
        self.begin(nodeid)

    def pytest_runtest_logreport(self, report: Any) -> None:
        """pytest's hook: how a test ended, and after how many seconds."""
        if report.when == "call" or report.failed:
            with (self.folder.parent / "results.jsonl").open("a") as file:
                print(json.dumps([report.nodeid, report.outcome, round(report.duration, 3)]), file=file)


def start() -> Recorder:
    """Trace every source that is imported from now on, here and in every program that is started from here."""
    recorder = Recorder(Path(os.environ[FOLDER]))
    setattr(builtins, HIT, recorder)
    machinery = importlib.machinery
    loaders = (
        (machinery.ExtensionFileLoader, machinery.EXTENSION_SUFFIXES),
        (_Loader, machinery.SOURCE_SUFFIXES),
    )
    sys.path_hooks.insert(0, machinery.FileFinder.path_hook(*loaders))
    sys.path_importer_cache.clear()
    return recorder


@dataclass(frozen=True)
class Traced:
    """What a trace left in its folder."""

    folder: Path

    @cached_property
    def sources(self) -> Mapping[str, str]:
        """The digest of every file when it was traced, in the order in which blocks count them."""
        return json.loads((self.folder / SEEN).read_text())

    @cached_property
    def runs(self) -> Mapping[str, Mapping[int, set[str]]]:
        """By file and block, the tests that run it and pass without a mistake."""
        out: dict[str, dict[int, set[str]]] = {}
        files = list(self.sources)
        for path in (self.folder / "hits").glob("*.name"):
            test = path.read_text()
            if test in self.seconds:
                for (number,) in struct.iter_unpack("i", path.with_suffix("").read_bytes()):
                    out.setdefault(files[number // MOST], {}).setdefault(number % MOST, set()).add(test)
        return out

    @cached_property
    def seconds(self) -> Mapping[str, float]:
        """How long each test takes that passes without a mistake."""
        rows = [json.loads(row) for path in self.folder.glob("results*.jsonl") for row in path.read_text().splitlines()]
        failing = {test for test, outcome, *_ in rows if outcome == "failed"}
        return {test: took for test, outcome, took, *_ in rows if outcome == "passed" and test not in failing}

    @cached_property
    def breadth(self) -> Mapping[str, int]:
        """How many blocks each test runs: the fewer, the more it is about each."""
        out: dict[str, int] = {}
        for places in self.runs.values():
            for tests in places.values():
                for test in tests:
                    out[test] = out.get(test, 0) + 1
        return out

    def likely(self, mistake: Mistake, budget: float, each: int = 3) -> tuple[str, ...]:
        """The tests that run a mistake's block, the most particular ones first, as many as take `budget` seconds.

        Of a function with parameters `each` of its tests at most.
        Where no block is traced there, those of the file or folder: in compiled code, outside of functions, and where
        the file has changed since.
        Empty if the block is run by none.
        """
        text = source(mistake.file)
        same = self.sources.get(mistake.file) == digest(mistake.file)
        around = [b for b in blocks(text.tree, mistake.file) if b[0].lineno <= mistake.line <= (b[-1].end_lineno or 0)]
        if around and same:
            tests = self.runs.get(mistake.file, {}).get(named(around[-1]), set())
        else:
            tests, place = set(), mistake.file
            while not tests and place:
                tests = {
                    t for file, at in self.runs.items() if file.startswith(place) for ts in at.values() for t in ts
                }
                place = place.rpartition("/")[0]
        out: list[str] = []
        spent, taken = 0.0, Counter[str]()
        for test in sorted(tests, key=lambda test: (self.breadth[test] * (0.1 + self.seconds[test]), test)):
            function = test.partition("[")[0]
            if taken[function] < each and (spent + self.seconds[test] <= budget or len(out) < 3):
                spent += self.seconds[test]
                taken[function] += 1
                out.append(test)
        return tuple(out)
