"""Options and hooks of the whole test suite. The grid's own plugin is loaded by `-m crosscheck` alone."""

import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest_plugins = ["pytester"]

# A shell that starts the tests in the background has them ignore Ctrl-C, and the programs that they start inherit it.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

os.environ.pop("COLUMNS", None)  # how wide somebody's window is: tables would be folded

# The longest, each of which would keep one worker busy after the others have ended.
FIRST = (
    *("site_in_browser", "installations", "cluster", "wrong_models", "any_rows", "lagrange_compiled"),
    *("promised", "matrix", "random", "scenes", "conformance"),
)

GOLDEN = Path(__file__).parent / "golden"

# The one file whose tests are marked `crosscheck`, which a test there holds.
GRID = "test_crosscheck.py"


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Where `-m` asks for the grid alone, no other file is imported: importing them all takes ten seconds."""
    alone = config.getoption("-m") in ("crosscheck", "crosscheck and not slow")
    return True if alone and collection_path.name.startswith("test_") and collection_path.name != GRID else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files; the order within a file stays."""
    place = {f"test_{name}.py": number for number, name in enumerate(FIRST)}
    items.sort(key=lambda item: place.get(Path(item.path).name, len(FIRST)))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--renew-golden", action="store_true", help="Write tests/golden/* from what is rendered now.")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """compare(name, text): fail unless tests/golden/name has this text; --renew-golden writes it."""

    def compare(name: str, text: str) -> None:
        if request.config.getoption("--renew-golden"):
            GOLDEN.mkdir(exist_ok=True)
            (GOLDEN / name).write_text(text, encoding="utf-8")
        assert text == (GOLDEN / name).read_text(encoding="utf-8")

    return compare


@pytest.fixture
def at_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands run what they run in this process: workers take seconds to start, and are the subject of other tests."""
    from reports.gate import walk
    from reports.run import cluster, supervisor, worker
    from tests.toys import in_process

    monkeypatch.setattr(cluster, "pool", lambda workers: cluster.Workforce(1, in_process))
    monkeypatch.setattr(worker, "start_early", lambda *modules: None)
    monkeypatch.setattr(supervisor, "supervise", in_process)  # for what commands import when they are called
    monkeypatch.setattr(walk, "supervise", in_process)


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Append the names of skipped tests to the file that CROSSCHECK_SKIPPED names, for `.ci/run`."""
    target = os.environ.get("CROSSCHECK_SKIPPED")
    if target and "PYTEST_XDIST_WORKER" not in os.environ:
        with open(target, "a", encoding="utf-8") as file:
            file.writelines(f"{report.nodeid}\n" for report in terminalreporter.stats.get("skipped", ()))
