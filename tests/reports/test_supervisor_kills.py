"""Workers that are killed at any moment, a parent that is, and Ctrl-C."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import subprocess
import sys
import threading

import pytest

from reports.model.cells import Cell
from reports.model.outcomes import Outcome
from reports.run import supervisor
from reports.run.running import run_cells
from tests import ROOT
from tests.reports.rough_toys import RoughToy, helpers, is_free, wait_until
from tests.toys import Disc

pytest.importorskip("fcntl", reason="signals and locks of Unix are the subject here")


class Killer:
    """Kills workers, the fork server and the resource tracker, at moments and with signals that follow from a seed."""

    def __init__(self, seed: int, kills: int, monkeypatch: pytest.MonkeyPatch) -> None:
        self.kills = 0
        self._random, self._wanted, self._timers = random.Random(seed), kills, []
        self._crew: supervisor.Crew | None = None
        made = supervisor.Crew

        def remember(*arguments):
            self._crew = made(*arguments)
            return self._crew

        monkeypatch.setattr(supervisor, "Crew", remember)

    def arm(self) -> None:
        """One kill, after a tenth of a second at most."""
        if len(self._timers) < self._wanted:
            target = self._random.choice(["worker"] * 8 + ["fork server", "resource tracker"])
            how = self._random.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV])
            timer = threading.Timer(self._random.uniform(0.0, 0.1), self._kill, (target, how, self._random.random()))
            timer.start()
            self._timers.append(timer)

    def _kill(self, target: str, how: int, which: float) -> None:
        # Any of them may have ended by now.
        with contextlib.suppress(ProcessLookupError, ValueError, IndexError):
            if target == "fork server":
                number, how = helpers()[0], signal.SIGKILL
            elif target == "resource tracker":
                number, how = helpers()[1], signal.SIGKILL
            else:
                workers = self._crew._workers if self._crew else []
                number = workers[int(which * len(workers))].process.pid
            if number is not None:
                os.kill(number, how)
                self.kills += 1

    def wait(self) -> None:
        for timer in self._timers:
            timer.join()


@pytest.mark.parametrize(("seed", "kills"), [(1, 8), pytest.param(2, 200, marks=pytest.mark.slow)])
def test_among_kills_every_row_is_there_once_and_right(monkeypatch, seed, kills):
    killer = Killer(seed, kills, monkeypatch)
    cells = [Cell(Disc(), RoughToy("short sleep", factor=float(place)), 1) for place in range(2 * kills)]
    rows = []
    for row in run_cells(cells, workers=2, timed=False):
        rows.append(row)
        killer.arm()
    killer.wait()
    assert sorted(row.settings for row in rows) == sorted(repr(cell.engine) for cell in cells)
    factors = {repr(cell.engine): vars(cell.engine)["factor"] for cell in cells}
    done = [row for row in rows if row.outcome == Outcome.FINISHED]
    for row in done:
        assert row.angle == pytest.approx(factors[row.settings] * row.step**2, rel=1e-9)
    # Without an answer is only what was hit twice, and it says so.
    assert all(row.outcome in (Outcome.LOST, Outcome.ABORTED) for row in rows if row not in done)
    assert len(rows) - len(done) <= killer.kills // 2
    assert killer.kills > kills // 2


SCRIPT = """
import sys
import threading
from reports.model.cells import Cell
from reports.run.running import run_cells
from tests.reports.rough_toys import RoughToy
from tests.toys import Disc

def run(wall, kinds):
    list(run_cells([Cell(Disc(), RoughToy(kind, folder=sys.argv[1]), 1) for kind in kinds], limit=2.0, wall=wall))

if __name__ == "__main__":
    threading.Thread(target=run, args=(4.0, ["held native sleep"])).start()
    run(1000.0, ["held sleep", "held native spin"])
"""


def test_workers_end_when_their_parent_is_gone(tmp_path):
    """What sleeps ends at once; native code that holds the interpreter with the fork server, or by the timer."""
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([sys.executable, tmp_path / "script.py", tmp_path], env=environment)
    kinds = ("sleep", "native spin", "native sleep")
    try:
        wait_until(lambda: all((tmp_path / f"{kind} is there").exists() for kind in kinds))
    finally:
        process.kill()
        process.wait()
    for kind in kinds:
        with (tmp_path / kind).open("w", encoding="utf-8") as file:
            wait_until(lambda file=file: is_free(file))
