"""What a run costs over the bare stepping loop of an engine, and where CPU time goes, by part, engine and scene."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from engines import Engine, Unsupported, method_name
from engines.entry_points import registered_by_key
from engines.loading import Kind
from reference.mechanism import Mechanism
from reports.model.cells import Cell
from reports.model.measure import TIMED, Measurement
from reports.model.outcomes import Loss
from reports.model.spending import taken
from reports.model.tasks import Task
from reports.run.running import run_cells
from reports.run.supervisor import Answer, supervise

BARE_LOOP = Kind("bare loop", lambda value: "" if callable(value) else "it can't be called")
TURNS = 7  # of each, alternating, so that a slow spell of the machine meets both


@dataclass(frozen=True)
class LoopCost:
    """CPU seconds per step of `run` and of the bare loop, the least of TURNS each."""

    engine: Engine
    steps: int
    run: float
    bare: float

    @property
    def ratio(self) -> float:
        return self.run / self.bare


def loop_costs(engines: Iterable[Engine], mechanism: Mechanism, dt: float, samples: int, every: int) -> list[LoopCost]:
    """For each engine that can build the mechanism and has a bare loop under `crosscheck.bare_loops`."""
    out = []
    steps = samples * every
    loops = registered_by_key("crosscheck.bare_loops", BARE_LOOP)
    for engine in engines:
        bare_loop = loops.get(engine.name)
        if bare_loop is None:
            continue
        runs, bare = [], []
        try:
            for _ in range(TURNS):
                runs.append(engine.build(mechanism, dt)(samples, every).stepping)
                bare.append(bare_loop(engine, mechanism, dt, steps))
        except Unsupported:
            continue
        out.append(LoopCost(engine, steps, min(runs) / steps, min(bare) / steps))
    return out


STARTING, BETWEEN, OTHER = "starting workers", "between items", "other work on items"
NEARLY = 0.1  # relative: timings that differ by less count as the same


@dataclass(frozen=True)
class Spent:
    """Of one item: the process that worked on it, CPU seconds of that process since its last item, and by part; and
    for how long it worked on the item, `wall` seconds.
    """

    process: int
    before: float
    wall: float
    parts: dict[str, float]


_ended = 0.0  # CPU time of this process when its last item ended


@dataclass(frozen=True)
class Counted:
    """A function of an item that also tells what it spent."""

    function: Callable[[Any], Any]

    def __call__(self, item: Any) -> tuple[Any, Spent]:
        global _ended
        taken()
        begin, clock = time.process_time(), time.monotonic()
        result = self.function(item)
        end = time.process_time()
        before, _ended = begin - _ended, end
        parts = dict(taken())
        parts[OTHER] = end - begin - sum(parts.values())
        return result, Spent(os.getpid(), before, time.monotonic() - clock, parts)


@dataclass
class Account:
    """CPU seconds of workers by part, by method and by scene, and `wall` seconds of all rounds of workers."""

    parts: dict[str, float] = field(default_factory=dict)
    methods: dict[str, float] = field(default_factory=dict)
    scenes: dict[str, float] = field(default_factory=dict)
    longest: list[tuple[float, str]] = field(default_factory=list)
    wall: float = 0.0
    first: dict[int, float] = field(default_factory=dict)  # when each process began its first item
    last: dict[int, float] = field(default_factory=dict)  # when each process gave its last answer
    lost: int = 0

    @property
    def seconds(self) -> float:
        return sum(self.parts.values())

    def tail(self, workers: int) -> float:
        """Seconds from when fewer than so many processes were left at work, until the last answer.

        A process that was replaced ended early, and another one worked in its place: it does not count.
        """
        if not self.last:
            return 0.0
        enough = [
            end
            for end in self.last.values()
            if sum(self.first[one] < end <= other for one, other in self.last.items()) >= workers
        ]
        return max(self.last.values()) - max(enough, default=min(self.first.values()))

    def supervise(self, function: Callable[[Any], Any], items: Iterable[Any], *terms: Any) -> Iterator[Answer]:
        """As `reports.run.supervisor.supervise`, and count."""
        begin = time.monotonic()
        seen: set[int] = set()
        for item, result, note in supervise(Counted(function), items, *terms):
            if isinstance(result, Loss):
                self.lost += 1
                yield item, result, note
                continue
            own, spent = result
            self._count(item, spent, spent.process not in seen)
            seen.add(spent.process)
            now = time.monotonic()
            self.first.setdefault(spent.process, now - spent.wall)
            self.last[spent.process] = now
            yield item, own, note
        self.wall += time.monotonic() - begin

    def _count(self, item: Cell | Task, spent: Spent, first: bool) -> None:
        for part, seconds in {**spent.parts, STARTING if first else BETWEEN: spent.before}.items():
            self.parts[part] = self.parts.get(part, 0.0) + seconds
        seconds, engine = sum(spent.parts.values()), item.engine
        method = "tasks of no engine" if engine is None else method_name(engine)
        scene = item.scene.name if isinstance(item, Cell) else "tasks"
        self.methods[method] = self.methods.get(method, 0.0) + seconds
        self.scenes[scene] = self.scenes.get(scene, 0.0) + seconds
        self.longest = sorted([*self.longest, (seconds, item.label)], reverse=True)[:10]


@dataclass(frozen=True)
class Alike:
    """How timings of a cell by one worker and by all at once compare: the middle ratio, and the share within NEARLY."""

    cells: int
    workers: int
    middle: float
    within: float


def timings_alike(cells: Sequence[Cell], workers: int, turns: int = 3) -> Alike:
    """Time these cells `turns` times by one worker and by all, in turn, and compare the least of each."""
    least: dict[tuple[str, int], float] = {}
    timed = [cell for cell in cells if cell.purpose in TIMED]
    for _ in range(turns):
        for count in (1, workers):
            for row in run_cells(timed, workers=count):
                if isinstance(row, Measurement) and row.cpu > 0:
                    key = (row.key, count)
                    least[key] = min(row.cpu, least.get(key, row.cpu))
    both = [key for key, count in least if count == 1 and (key, workers) in least]
    ratios = sorted(least[key, workers] / least[key, 1] for key in both)
    if not ratios:
        return Alike(0, workers, float("nan"), float("nan"))
    near = sum(abs(ratio - 1) <= NEARLY for ratio in ratios)
    return Alike(len(ratios), workers, ratios[len(ratios) // 2], near / len(ratios))
