"""Versions that can't be had, and builds as wheels: what the commands say, and with which status they end.

`tests/test_versions.py` asks the same of a pip that is put in its place; here it is pip itself.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from reports.cli.commands import invoke
from reports.model.ending import BadInput, Broken
from reports.run import installed as installation
from tests.test_versions import here, toy

__all__ = ["here"]


def wheel(folder: Path, version: str, error: float) -> Path:
    """A wheel of the toy engine, as a build of it makes one."""
    built = toy(folder / "built", version, f"def error(): return {error}\n")
    info = built / f"toyengine-{version}.dist-info"
    (info / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: by hand\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
    files = [path for path in sorted(built.rglob("*")) if path.is_file()]
    (info / "RECORD").write_text("".join(f"{path.relative_to(built).as_posix()},,\n" for path in files))
    place = folder / f"toyengine-{version}-py3-none-any.whl"
    with zipfile.ZipFile(place, "w") as archive:
        for path in [*files, info / "RECORD"]:
            archive.write(path, path.relative_to(built).as_posix())
    return place


def compared(first: Path, second: Path) -> int:
    return invoke(["compare", str(first), str(second), "--engine", "adapter.py:ENGINE", "--scenes", "scene.py:DISC"])


@pytest.mark.slow
def test_wheels_are_compared_and_a_worse_one_ends_with_status_1(here, capfd):
    first, second = wheel(here, "1.0", 1.0), wheel(here, "2.0", 50.0)
    with pytest.raises(Broken, match=r"toyengine 2\.0 \(wheel\) is worse than toyengine 1\.0 \(wheel\)") as refused:
        compared(first, second)
    assert refused.value.status == 1
    assert compared(first, here / "built" / "1.0") == 0  # a wheel and a folder
    assert "WORSE" in capfd.readouterr().out


def test_a_file_that_is_no_wheel_is_one_line_and_status_2(here):
    broken = here / "toyengine-3.0-py3-none-any.whl"
    broken.write_text("no archive")
    with pytest.raises(BadInput, match=r"toyengine-3\.0-py3-none-any\.whl can't be installed") as refused:
        compared(broken, broken)
    assert refused.value.status == 2
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("words", [["versions", "pymunk", "7.2.0"], ["compare", "pymunk==7.2.0", "pymunk==7.3.1"]])
def test_without_network_one_line_says_so_and_nothing_is_left(words, here, monkeypatch):
    """An index at a port where nobody listens; what pip is told elsewhere is not asked."""
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    for name in ("PIP_NO_INDEX", "PIP_FIND_LINKS", "PIP_EXTRA_INDEX_URL"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
    with pytest.raises(BadInput, match=r"pymunk 7\.2\.0 can't be fetched: no connection to a package index") as refused:
        invoke([*words, "--scenes", "free_four_bar"])
    assert refused.value.status == 2
    assert "\n" not in str(refused.value)
    assert not list((here / "cache").rglob("pymunk*"))
    assert not (here / "crosscheck-results").exists()
    assert installation.cache_folder() == here / "cache"
