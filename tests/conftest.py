"""Options and hooks of the test suite. Only `-m crosscheck` loads the plugin of the grid."""

import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest_plugins = ["pytester"]

# Tests that a shell starts in the background ignore Ctrl-C, and so would the programs that the tests start.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

os.environ.pop("COLUMNS", None)  # tables depend on the width of the user's window

# The longest test files. Long files are run first, so that the workers end at about the same time.
LONGEST_FILES = (
    *(
        "engines_in_browser",
        "lessons_in_browser",
        "site_in_browser",
        "installations",
        "cluster",
        "wrong_models",
        "any_rows",
        "lagrange_compiled",
    ),
    *("promised", "matrix", "random", "scenes", "conformance"),
)

GOLDEN = Path(__file__).parent / "golden"

# The only file whose tests are marked `crosscheck`.
GRID_FILE = "test_crosscheck.py"


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """If `-m` selects only the grid, ignore other files, whose import takes ten seconds."""
    is_grid_alone = config.getoption("-m") in ("crosscheck", "crosscheck and not slow")
    is_other = collection_path.name.startswith("test_") and collection_path.name != GRID_FILE
    return True if is_grid_alone and is_other else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Move the longest files to the front; keep the order within a file."""
    ranks = {f"test_{name}.py": rank for rank, name in enumerate(LONGEST_FILES)}
    items.sort(key=lambda item: ranks.get(Path(item.path).name, len(LONGEST_FILES)))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--renew-golden", action="store_true", help="Write tests/golden/* from the current output.")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """compare(name, text) fails unless tests/golden/name has this text. The option --renew-golden writes the text."""

    def compare(name: str, text: str) -> None:
        if request.config.getoption("--renew-golden"):
            GOLDEN.mkdir(exist_ok=True)
            (GOLDEN / name).write_text(text, encoding="utf-8")
        assert text == (GOLDEN / name).read_text(encoding="utf-8")

    return compare


@pytest.fixture
def at_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make commands run in this process instead of in workers, which take seconds to start."""
    from reports.gate import walk
    from reports.run import cluster, supervisor, worker
    from tests.toys import in_process

    monkeypatch.setattr(cluster, "pool", lambda workers: cluster.Workforce(1, in_process))
    monkeypatch.setattr(worker, "start_early", lambda *modules: None)
    monkeypatch.setattr(supervisor, "supervise", in_process)  # imported when called
    monkeypatch.setattr(walk, "supervise", in_process)


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """For `.ci/run`, append the names of skipped tests to the file that CROSSCHECK_SKIPPED names."""
    target = os.environ.get("CROSSCHECK_SKIPPED")
    if target and "PYTEST_XDIST_WORKER" not in os.environ:
        with open(target, "a", encoding="utf-8") as file:
            file.writelines(f"{report.nodeid}\n" for report in terminalreporter.stats.get("skipped", ()))
