"""Temporary folders: gone afterwards, after a signal, and swept by the next program after a kill."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from reports.cli import interruption
from reports.run import files
from reports.run.files import remove_all, temporary_folder
from tests.reports.test_command_line import environment

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


def test_all_folders_of_a_process_go_at_once(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "_own", {})  # of this process' own, its workers' stays
    with temporary_folder(tmp_path), temporary_folder(tmp_path):
        remove_all()
        assert [*tmp_path.iterdir()] == []


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
    deadline = time.monotonic() + 20.0
    while (running := still_there(str(tmp_path))) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert running == []
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
