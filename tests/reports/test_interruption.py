"""Ctrl-C at any moment of the program."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time

import pytest

from reports.cli import interruption
from reports.model.ending import FINE, INTERRUPTED, REFUSED
from reports.run.store import Store
from tests.reports.test_command_line import ROOT, call, environment


def test_ctrl_c_has_again_the_meaning_that_it_had(capfd):
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
MOMENTS = [1, 2, 5, *random.Random(16).sample(range(6, 1300), 2)]


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
    while process.poll() is None and count_of_rows(store) == 0:
        time.sleep(0.1)
    assert process.poll() is None, process.communicate()  # it had ended before anything was stored
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate()
    assert process.returncode == INTERRUPTED
    assert err == ""
    stored = count_of_rows(store)
    assert 1 <= stored <= 2
    assert f"Stopped: {stored} of 3 cells are stored; the next run goes on from there." in out


def count_of_rows(path):
    if not path.exists():
        return 0
    with Store.read(path) as store:
        return store._connection.execute("select count(*) from results").fetchone()[0]


def test_a_ctrl_c_that_is_kept_raises_when_asked_and_the_second_at_once():
    before = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with interruption.kept() as check:
            check()
            signal.raise_signal(signal.SIGINT)
            with pytest.raises(KeyboardInterrupt):
                check()
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        with interruption.kept() as check, interruption.ending_at_once():
            signal.raise_signal(signal.SIGINT)  # ignored, as for a job in the background
            check()
    finally:
        signal.signal(signal.SIGINT, before)
