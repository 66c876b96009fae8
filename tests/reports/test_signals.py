"""Signals and Ctrl-C at any moment: no temporary folder and no word is left, and what a kill leaves is swept."""

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

pytestmark = pytest.mark.skipif(files.fcntl is None, reason="nothing is locked or swept on Windows")


@pytest.fixture(autouse=True)
def anew():
    files._sweep.cache_clear()


HOLDS = """
import sys, time
from pathlib import Path
from reports.cli.interruption import ending_at_once, kept
from reports.run.files import temporary_folder

with ending_at_once(), temporary_folder(Path(sys.argv[1])) as folder:
    (folder / "file").write_text("x")
    print(folder, flush=True)
    time.sleep(1e4)
"""


def holding(folder):
    words = [sys.executable, "-c", HOLDS, folder]
    process = subprocess.Popen(words, env=environment(), stdout=subprocess.PIPE, text=True, preexec_fn=listening)
    assert process.stdout is not None
    assert process.stdout.readline().strip().startswith(str(folder))
    return process


def listening():
    """Whatever the tests' own parent did with it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def test_a_folder_is_there_inside_and_gone_afterwards_also_with_an_error(tmp_path):
    def fails():
        with temporary_folder(tmp_path) as folder:
            (folder / "below").mkdir()
            return [*tmp_path.iterdir()] == [folder] and 1 / 0

    with pytest.raises(ZeroDivisionError):
        fails()
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("number", interruption.SIGNALS)
def test_a_signal_leaves_no_folder_and_is_told_by_the_status(tmp_path, number):
    process = holding(tmp_path)
    process.send_signal(number)
    process.communicate()
    assert process.returncode == 128 + number
    assert [*tmp_path.iterdir()] == []


def test_what_a_kill_left_is_swept_and_what_somebody_holds_or_has_named_is_not(tmp_path):
    killed, alive = holding(tmp_path), holding(tmp_path)
    killed.kill()
    killed.communicate()
    mine = [tmp_path / name for name in ("crosscheck-results", ".crosscheck-mine.part", ".crosscheck-abcdefgh")]
    for path in mine:
        path.mkdir()
    try:
        with temporary_folder(tmp_path):
            assert len([*tmp_path.iterdir()]) == len(mine) + 2
    finally:
        alive.kill()
        alive.communicate()
    assert len([*tmp_path.iterdir()]) == len(mine) + 1
    files._sweep.cache_clear()
    with temporary_folder(tmp_path):
        pass
    assert sorted(tmp_path.iterdir()) == sorted(mine)


def test_a_folder_for_sockets_has_a_path_that_a_socket_can_have(tmp_path, monkeypatch):
    long = tmp_path / ("a" * 60)
    long.mkdir()
    monkeypatch.setattr(files.tempfile, "gettempdir", lambda: str(long))
    monkeypatch.setattr(files, "_own", {})
    folder = files.lasting_folder.__wrapped__()
    assert len(f"{folder}/listener-12345678") < 104
    remove_all()
    assert not folder.exists()


MODEL = """<mujoco><worldbody><body><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 1 0 0" size=".02"/></body>
</worldbody></mujoco>"""
COMMANDS = [
    ("check", "m.xml"),
    ("conform", "pymunk", "--variant", "default"),
    ("run", "free_four_bar"),
    ("run", "free_four_bar", "--scheduler", "local:2"),
    ("list", "free_four_bar"),
]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_a_signal_at_any_time_leaves_no_folder_no_process_and_no_traceback(tmp_path, seed):
    if seed % 5 == 3:
        pytest.importorskip("distributed")
    chance = random.Random(seed)
    number, group, delay = chance.choice(interruption.SIGNALS), chance.random() < 0.5, chance.uniform(0.2, 8.0)
    (tmp_path / "temporary").mkdir()
    (tmp_path / "m.xml").write_text(MODEL)
    process = subprocess.Popen(
        [sys.executable, "-m", "reports", *COMMANDS[seed % 5]],
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
    wait_until(lambda: not still_there(str(tmp_path)))
    assert [path.name for path in tmp_path.rglob("*") if path.name.endswith((".part", ".half"))] == []
    assert [*(tmp_path / "temporary").iterdir()] == []


def still_there(folder):
    """Processes whose environment names a folder."""
    found = []
    for path in Path("/proc").iterdir():
        try:
            if path.name.isdigit() and folder.encode() in (path / "environ").read_bytes():
                found.append(path.name)
        except OSError:
            continue
    return found


def test_ctrl_c_has_again_the_meaning_that_it_had():
    before = signal.getsignal(signal.SIGINT)
    assert call("--help") == FINE
    assert call("nonsense") == REFUSED
    assert signal.getsignal(signal.SIGINT) is before


# Sends Ctrl-C to itself when the given number of modules has been asked for after the program's first line.
INTERRUPTS_ITSELF = """
import runpy, signal, sys

asked, count = 0, int(sys.argv[1])
signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever the tests' own parent did with it

def hook(event, arguments):
    global asked
    if event == "import" and not arguments[0].startswith("encodings") and "reports.cli.interruption" in sys.modules:
        asked += 1
        if asked == count:
            signal.raise_signal(signal.SIGINT)

sys.addaudithook(hook)
sys.argv = ["crosscheck", *sys.argv[2:]]
runpy.run_module("reports", run_name="__main__", alter_sys=True)
"""


# Seeded. This command asks for more than 1400 modules: numpy, scipy, matplotlib and both engines are among them.
MOMENTS = [1, 5, random.Random(16).randrange(6, 1300)]


@pytest.mark.parametrize("moment", MOMENTS)
def test_ctrl_c_at_any_import_is_status_130_without_a_word(moment):
    process = subprocess.run(
        [sys.executable, "-c", INTERRUPTS_ITSELF, str(moment), "run", "no_scene"],
        env=environment(),
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert (process.returncode, process.stdout, process.stderr) == (INTERRUPTED, "", "")


def test_ctrl_c_in_a_run_says_what_is_stored_and_the_next_run_goes_on(tmp_path):
    """To the whole group of processes, as a terminal does: workers must not complain either."""
    words = ["run", "pendulum_100", "--engine", "lagrange", "--variant", "rk4 projection", "--results", str(tmp_path)]
    process = subprocess.Popen(
        [sys.executable, "-m", "reports", *words, "--every", "1", "--every", "2", "--every", "1000"],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    store = tmp_path / "cells.sqlite"
    wait_until(lambda: process.poll() is not None or count_of_rows(store) > 0)
    assert process.poll() is None, process.communicate()  # it had ended before anything was stored
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate()
    assert process.returncode == INTERRUPTED
    assert err == ""
    stored = count_of_rows(store)
    assert 1 <= stored <= 2
    assert f"Stopped: {stored} of 3 cells are stored; the next run goes on from there." in out


def count_of_rows(path):
    with suppress(FileTrouble), Store.read(path) as store:  # it is not there, or just being made
        return store._connection.execute("select count(*) from results").fetchone()[0]
    return 0


def test_a_ctrl_c_that_is_kept_raises_when_asked_at_the_second_and_when_the_context_is_left():
    before = signal.getsignal(signal.SIGINT)
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
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        with interruption.kept() as check, interruption.ending_at_once():
            signal.raise_signal(signal.SIGINT)  # ignored, as for a job in the background
            check()
    finally:
        signal.signal(signal.SIGINT, before)
