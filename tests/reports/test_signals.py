"""Signals and Ctrl-C at any moment: no temporary folder and no word is left."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from reports.cli import interruption
from reports.model.ending import FINE, INTERRUPTED, REFUSED, FileTrouble
from reports.run import files
from reports.run.files import remove_all, temporary_folder
from reports.run.store import Store
from tests.reports.rough_toys import wait_until
from tests.reports.test_command_line import ROOT, call, environment

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals of Unix are the subject here")
HOLDS = """
import sys, time
from pathlib import Path
from reports.cli.interruption import ending_at_once
from reports.run.files import temporary_folder

with ending_at_once(), temporary_folder(Path(sys.argv[1])) as folder:
    (folder / "file").write_text("x")
    print(folder, flush=True)
    time.sleep(1e4)
"""


def listening():
    """Whatever the tests' own parent did with it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def test_a_folder_is_gone_afterwards_also_with_an_error_and_sockets_have_a_short_path(tmp_path, monkeypatch):
    def fails():
        with temporary_folder(tmp_path) as folder:
            (folder / "below").mkdir()
            return [*tmp_path.iterdir()] == [folder] and 1 / 0

    with pytest.raises(ZeroDivisionError):
        fails()
    assert [*tmp_path.iterdir()] == []
    long = tmp_path / ("a" * 60)
    long.mkdir()
    monkeypatch.setattr(files.tempfile, "gettempdir", lambda: str(long))
    monkeypatch.setattr(files, "_folders", [])
    folder = files.socket_folder.__wrapped__()
    assert len(f"{folder}/listener-12345678") < 104
    remove_all()
    assert not folder.exists()


@pytest.mark.parametrize("number", interruption.SIGNALS)
def test_a_signal_leaves_no_folder_and_is_the_status(tmp_path, number):
    words = [sys.executable, "-c", HOLDS, tmp_path]
    process = subprocess.Popen(words, env=environment(), stdout=subprocess.PIPE, text=True, preexec_fn=listening)
    assert process.stdout is not None
    assert process.stdout.readline().strip().startswith(str(tmp_path))
    process.send_signal(number)
    process.communicate()
    assert process.returncode == 128 + number
    assert [*tmp_path.iterdir()] == []


COMMANDS = [("conform", "pymunk", "--variant", "default"), ("run", "free_four_bar"), ("list", "free_four_bar")]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(9))
def test_a_signal_at_any_time_leaves_no_folder_no_process_and_no_traceback(tmp_path, seed):
    chance = random.Random(seed)
    number, group, delay = chance.choice(interruption.SIGNALS), chance.random() < 0.5, chance.uniform(0.2, 8.0)
    (tmp_path / "temporary").mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "reports", *COMMANDS[seed % len(COMMANDS)]],
        cwd=tmp_path,
        env={**environment(), "TMPDIR": str(tmp_path / "temporary")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=listening,
    )
    time.sleep(delay)
    ended = process.poll() is not None
    if not ended:
        (os.killpg if group else os.kill)(process.pid, number)
    _, err = process.communicate(timeout=60)
    assert "Traceback" not in err
    assert ended or process.returncode in (128 + number, -number)  # before its first line it ends as any program
    wait_until(lambda: not processes_of(str(tmp_path)))
    assert [path.name for path in tmp_path.rglob("*") if path.name.endswith((".part", ".half"))] == []
    assert [*(tmp_path / "temporary").iterdir()] == []


def processes_of(folder):
    """Processes whose environment names a folder."""
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if folder.encode() in (path / "environ").read_bytes():
                found.append(path.name)
    return found


# Sends Ctrl-C to itself when the given number of modules has been imported after the program's first line.
INTERRUPTS_ITSELF = """
import runpy, signal, sys

imported, count = 0, int(sys.argv[1])
signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever the tests' own parent did with it

def hook(event, arguments):
    global imported
    if event == "import" and not arguments[0].startswith("encodings") and "reports.cli.interruption" in sys.modules:
        imported += 1
        if imported == count:
            signal.raise_signal(signal.SIGINT)

sys.addaudithook(hook)
sys.argv = ["crosscheck", *sys.argv[2:]]
runpy.run_module("reports", run_name="__main__", alter_sys=True)
"""


# This command imports more than 1400 modules: numpy, scipy, matplotlib and both engines are among them.
@pytest.mark.parametrize("moment", [5, random.Random(16).randrange(6, 1300)])
def test_ctrl_c_at_any_import_is_status_130_without_a_word(moment):
    process = subprocess.run(
        [sys.executable, "-c", INTERRUPTS_ITSELF, str(moment), "run", "no_scene"],
        env=environment(),
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert (process.returncode, process.stdout, process.stderr) == (INTERRUPTED, "", "")


def test_ctrl_c_in_a_run_says_what_is_stored(tmp_path):
    """To the whole group of processes, as a terminal does: workers must not complain either."""
    words = ["run", "pendulum_100", "--engine", "lagrange", "--variant", "rk4 projection", "--results", str(tmp_path)]
    process = subprocess.Popen(
        [sys.executable, "-m", "reports", *words, "--every", "1", "--every", "2", "--every", "1000"],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=listening,
    )
    store = tmp_path / "cells.sqlite"
    wait_until(lambda: process.poll() is not None or count_of_rows(store) > 0)
    assert process.poll() is None, process.communicate()  # it had ended before anything was stored
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate()
    assert (process.returncode, err) == (INTERRUPTED, "")
    stored = count_of_rows(store)
    assert 1 <= stored <= 2
    assert f"Stopped: {stored} of 3 cells are stored; the next run goes on from there." in out


def count_of_rows(path):
    with suppress(FileTrouble), Store.read(path) as store:  # it is not there, or just being made
        return store._connection.execute("select count(*) from results").fetchone()[0]
    return 0


def test_a_delayed_ctrl_c_raises_when_checked_at_the_second_and_when_the_context_is_left():
    before = signal.getsignal(signal.SIGINT)
    assert call("--help") == FINE
    assert call("nonsense") == REFUSED
    assert signal.getsignal(signal.SIGINT) is before
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with ExitStack() as leaving:
            check = leaving.enter_context(interruption.kept())
            check()
            signal.raise_signal(signal.SIGINT)
            with pytest.raises(KeyboardInterrupt):
                check()
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
            with pytest.raises(interruption.Interrupted):
                leaving.close()
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        with interruption.kept() as check, interruption.ending_at_once():
            signal.raise_signal(signal.SIGINT)  # ignored, as for a job in the background
            check()
    finally:
        signal.signal(signal.SIGINT, before)
