"""The grid's options and its table, from the package, so that an installed copy has them too."""

import signal
from pathlib import Path

import pytest

pytest_plugins = ["reports.gate.pytest_plugin", "pytester"]

# A shell that starts the tests in the background has them ignore Ctrl-C, and the programs that they start inherit it.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The longest, each of which would keep one worker busy after the others have ended.
FIRST = ("third_party", "site_in_browser", "wrong_models", "any_rows", "wheel", "lagrange_compiled")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files; the order within a file stays."""
    place = {f"test_{name}.py": number for number, name in enumerate(FIRST)}
    items.sort(key=lambda item: place.get(Path(item.path).name, len(FIRST)))
