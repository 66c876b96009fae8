"""Workers that are killed at any moment, a parent that is, and Ctrl-C."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import subprocess
import sys
import threading
import time

import pytest

from reports.model.cells import Cell
from reports.model.outcomes import Outcome
from reports.run import supervisor
from reports.run.running import run_cells
from tests import ROOT
from tests.reports.rough_toys import RoughToy, helpers
from tests.toys import Disc

fcntl = pytest.importorskip("fcntl", reason="signals and locks of Unix are the subject here")


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


@pytest.mark.parametrize(("seed", "kills"), [(1, 20), pytest.param(2, 200, marks=pytest.mark.slow)])
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


INTERRUPTED = """
import sys
import time
from reports.run.running import TIME_LIMIT
from reports.run.supervisor import supervise

if __name__ == "__main__":
    try:
        print("starting", flush=True)
        list(supervise(time.sleep, [1000.0, 1000.0], TIME_LIMIT, 2))
    except KeyboardInterrupt:
        print("interrupted")
"""


@pytest.mark.parametrize("delay", [0.1, 2.0])
def test_ctrl_c_reaches_all_processes_of_a_terminal_and_the_parent_alone_tells_it(tmp_path, delay):
    (tmp_path / "script.py").write_text(INTERRUPTED, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(
        [sys.executable, tmp_path / "script.py"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == b"starting\n"
    time.sleep(delay)  # workers are started or at work: what comes out is the same
    os.killpg(process.pid, signal.SIGINT)
    assert process.communicate(timeout=60) == (b"interrupted\n", b"")


def is_free(file) -> bool:
    """Whether no process holds a lock on a file: processes that have ended may still have their number."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def wait_until(true) -> None:
    """Raises AssertionError when it takes far longer than any limit here."""
    for _ in range(1200):
        if true():
            return
        time.sleep(0.05)
    raise AssertionError("it did not come true within a minute")
