"""Tests of processes: a signal leaves no folder, process or traceback, no file of the current folder is imported."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import ExitStack, suppress
from dataclasses import dataclass

import pytest

from reference.mechanism import Mechanism
from reports.cli import interruption
from reports.model.cells import Cell
from reports.model.ending import FINE, INTERRUPTED, REFUSED, FileTrouble
from reports.run import files
from reports.run.files import remove_all, temporary_folder
from reports.run.installed import environment as of_a_version
from reports.run.running import run_into
from reports.run.store import Store
from reports.run.supervisor import WorkersLost
from tests import ROOT
from tests.reports.rough_toys import wait_until
from tests.reports.test_command_line import call, environment, one_line
from tests.toys import Disc, Toy

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
    """Restore the default handler, since the parent of the tests may have changed it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def test_a_temporary_folder_is_removed_after_an_error_and_paths_of_sockets_are_short(tmp_path, monkeypatch):
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


def test_a_signal_leaves_no_folder_and_determines_the_exit_status(tmp_path):
    text = [sys.executable, "-c", HOLDS, tmp_path]
    process = subprocess.Popen(text, env=environment(), stdout=subprocess.PIPE, text=True, preexec_fn=listening)
    assert process.stdout is not None
    assert process.stdout.readline().strip().startswith(str(tmp_path))
    process.send_signal(signal.SIGTERM)
    process.communicate()
    assert process.returncode == 128 + signal.SIGTERM
    assert [*tmp_path.iterdir()] == []


# A program that sends itself SIGINT after it has imported the given number of modules.
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


# import 5 precedes the program's modules, and import 300 is of a compiled module
@pytest.mark.parametrize("moment", [5, 300])
def test_ctrl_c_during_an_import_gives_exit_status_130_without_a_message(moment):
    process = subprocess.run(
        [sys.executable, "-c", INTERRUPTS_ITSELF, str(moment), "run", "no_scene"],
        env=environment(),
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert (process.returncode, process.stdout, process.stderr) == (INTERRUPTED, "", "")


def test_ctrl_c_during_a_run_reports_the_number_of_stored_cells(tmp_path):
    """The signal is sent to the whole process group, as by a terminal. Workers must not print a traceback."""
    text = ["run", "free_four_bar", "--engine", "pymunk", "--variant", "tuned", "--results", str(tmp_path)]
    process = subprocess.Popen(
        [sys.executable, "-m", "reports", *text, "--every", "1", "--every", "2", "--every", "30000"],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=listening,
    )
    store = tmp_path / "cells.sqlite"
    wait_until(lambda: process.poll() is not None or count_of_rows(store) > 0)
    assert process.poll() is None, process.communicate()  # the process must not have ended before a row was stored
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate()
    assert (process.returncode, err) == (INTERRUPTED, "")
    stored = count_of_rows(store)
    assert 1 <= stored <= 2
    assert f"Stopped: {stored} of 3 cells are stored; the next run goes on from there." in out


def count_of_rows(path):
    with suppress(FileTrouble), Store.read(path) as store:  # the file may be missing or incomplete
        return store._connection.execute("select count(*) from results").fetchone()[0]
    return 0


def test_a_delayed_ctrl_c_raises_when_checked_at_the_second_and_when_the_context_is_left():
    earlier = signal.getsignal(signal.SIGINT)
    assert call("--help") == FINE
    assert call("nonsense") == REFUSED
    assert signal.getsignal(signal.SIGINT) is earlier
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with ExitStack() as leaving:
            check = leaving.enter_context(interruption.delayed_signals())
            check()
            signal.raise_signal(signal.SIGINT)
            with pytest.raises(KeyboardInterrupt):
                check()
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
            with pytest.raises(interruption.Interrupted):
                leaving.close()
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        with interruption.delayed_signals() as check, interruption.ending_at_once():
            signal.raise_signal(signal.SIGINT)  # the signal is ignored, as in a background job
            check()
    finally:
        signal.signal(signal.SIGINT, earlier)


HIDDEN = ("reference", "engines", "reports", "csv", "numpy", "typing", "mujoco", "pymunk", "threading", "pickle")
RUN = ("run", "free_four_bar", "--engine", "pymunk", "--every", "10")
# Without a fork server, as on macOS and Windows, each worker imports all modules itself.
SPAWN = "import multiprocessing; multiprocessing.get_all_start_methods = lambda: ['spawn']\n"
PROGRAM = "import sys; from planar_crosscheck import main; {more}\nif __name__ == '__main__': main()"


@pytest.fixture
def hostile(tmp_path):
    """A folder with modules that write their names to the file `executed` and raise an exception when imported."""
    for name in HIDDEN:
        path = tmp_path / name / "__init__.py" if name in ("engines", "reports") else tmp_path / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write('{name} ')\nraise ValueError('hidden')\n")
    return tmp_path


def ended(folder, *words):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run([sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True)


def test_no_process_imports_a_file_of_the_current_folder(hostile):
    done = ended(hostile, "-P", "-c", SPAWN + PROGRAM.format(more=""), *RUN)
    assert done.returncode == 0, done.stderr
    assert not (hostile / "executed").exists()


def test_python_dash_m_does_not_put_the_current_folder_on_the_path(tmp_path):
    (tmp_path / "csv.py").write_text("raise ValueError('hidden')")
    (tmp_path / "numpy.py").write_text("raise ValueError('hidden')")
    done = ended(tmp_path, "-m", "reports", "show", "free_four_bar")
    assert "crosscheck run free_four_bar" in one_line(done.stderr)


def test_a_worker_reports_another_package_with_a_name_of_ours(tmp_path):
    """The path changes after the parent has imported our package, so a new worker finds the other package first."""
    (tmp_path / "engines").mkdir()
    (tmp_path / "engines" / "__init__.py").write_text("")
    more = f"import reports.cli.commands, engines.registry; sys.path.insert(0, {str(tmp_path)!r})"
    done = ended(tmp_path, "-P", "-c", SPAWN + PROGRAM.format(more=more), *RUN)
    assert done.returncode != 0
    assert "'engines'" in done.stderr
    assert "0 of 4" not in done.stdout


@dataclass(frozen=True)
class Importing(Toy):
    def build(self, mechanism: Mechanism, dt: float):
        from nowhere import nothing  # pyright: ignore[reportMissingImports]

        return nothing


def test_the_row_of_a_failed_import_is_not_stored(tmp_path):
    cells = [Cell(Disc(), Importing("importing"), 1), Cell(Disc(), Toy(), 1)]
    with Store(tmp_path / "cells.sqlite") as store:
        with pytest.raises(WorkersLost, match=r"1 of 2 cells are lost.*No module named 'nowhere'"):
            run_into(store, cells)
        assert set(store.get(cells)) == {cells[1]}


def test_the_process_of_a_version_does_not_have_the_current_folder_on_its_path(hostile, monkeypatch):
    monkeypatch.chdir(hostile)
    assert of_a_version(hostile)["PYTHONSAFEPATH"]
