"""What is printed of versions, of the machine, and as a table on the terminal."""

from __future__ import annotations

import io
import os
import platform
from importlib import metadata

import pytest
from rich.console import Console

from engines.lagrange import loading
from reports.cli.terminal import print_table
from reports.pages.index import foot
from reports.write import provenance
from reports.write.provenance import machine, still_installed, versions
from tests.toys import Toy


@pytest.fixture
def other_versions(monkeypatch):
    """Versions are looked up once in a process: here they change, and are those of this installation afterwards."""
    provenance._version.cache_clear()
    yield monkeypatch
    provenance._version.cache_clear()


def test_the_versions_are_those_of_the_packages_they_stand_beside(other_versions):
    numbers = {"numpy": "1.1", "scipy": "2.2", "pymunk": "3.3"}

    def version(name):
        if name not in numbers:
            raise metadata.PackageNotFoundError(name)
        return numbers[name]

    other_versions.setattr(metadata, "version", version)
    other_versions.setattr(platform, "python_version", lambda: "3.99")
    compiled = ", numba not installed" if loading.installed() else ""
    assert versions() == f"Python 3.99, numpy 1.1, scipy 2.2, pymunk 3.3, mujoco-core not installed{compiled}"
    assert still_installed("Python 3.99, scipy 2.2")
    assert still_installed("Python 3.99, numpy 1.1, scipy 2.2, pymunk 3.3, mujoco-core not installed")
    assert not still_installed("Python 3.99, scipy 2.3")
    assert not still_installed("Python 3.99, scipy 2.2, another 1.0")
    assert foot("a command") == f"Made by `a command` with {versions()}; timings on {machine()}."


def test_what_another_engine_depends_on_is_printed_too_and_leaves_a_baseline_valid(monkeypatch):
    before = versions()
    monkeypatch.setattr(provenance.registry, "ENGINES", (*provenance.registry.ENGINES, Elsewhere()))
    assert versions() == f"{before}, another-engine not installed"
    assert still_installed(before)


def test_the_packages_of_an_engine_that_is_not_registered_are_printed_where_it_is_compared():
    assert foot("a command", [Toy(), Elsewhere()]).startswith(
        f"Made by `a command` with {versions()}, another-engine not installed; timings on "
    )
    assert "another-engine" not in foot("a command", [Toy()])
    assert still_installed(f"{versions()}, another-engine not installed, rich {metadata.version('rich')}")
    assert not still_installed(f"{versions()}, rich 0.1")


class Elsewhere(Toy):
    """Depends on a package that is not here."""

    @property
    def packages(self) -> tuple[str, ...]:
        return ("another-engine", "numpy")


def test_a_machine_is_told_without_its_name_or_a_path(monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 97)
    monkeypatch.setattr(platform, "machine", lambda: "an architecture")
    told = machine()
    assert told.startswith("an architecture, 97 processors, ")
    assert platform.node() not in told
    assert "/" not in told.replace("w/", "")


def test_a_table_on_the_terminal_has_its_columns_in_order_and_keeps_brackets():
    out = io.StringIO()
    rows = (("a x", "0.1"), ("b [y]", "0.01"))
    print_table(Console(file=out, width=80), "A [b] title", ("method", "step [s]"), rows, 1)
    lines = [line.translate(str.maketrans("┃│", "  ")).split() for line in out.getvalue().splitlines()]
    title, head, *_, first, second = lines
    assert [title, head] == [["A", "[b]", "title"], ["method", "step", "[s]"]]
    assert [first, second] == [["a", "x", "0.1"], ["b", "[y]", "0.01"]]
