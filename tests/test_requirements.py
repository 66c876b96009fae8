"""Versions of packages that nobody imports by name, but that a result depends on."""

from __future__ import annotations

from importlib import metadata

import pytest

from reports.model import fingerprint, requirements
from reports.model.requirements import normalised, with_required
from tests.lower_bounds import PYPROJECT, lower_bounds

INVENTED = {
    "engine": [
        'binding>=1.0; python_version < "9"',
        'drawing; extra == "pictures"',
        "elsewhere; os_name == 'os2'",
    ],
    "binding": ["Parser.Of_C (>2)"],
    "parser-of-c": ["engine"],  # a circle
    "drawing": [],
}


@pytest.fixture
def invented(monkeypatch):
    def requires(name):
        if name not in INVENTED:
            raise metadata.PackageNotFoundError(name)
        return INVENTED[name]

    monkeypatch.setattr(requirements.metadata, "requires", requires)


def test_what_is_required_in_turn_is_found_without_extras_and_without_what_is_not_installed(invented):
    assert with_required(["Engine"]) == {"engine", "binding", "parser-of-c"}
    assert with_required(["drawing"]) == {"drawing"}
    assert with_required(["nothing"]) == set()


def test_names_are_compared_as_indexes_do():
    assert normalised("MuJoCo_core.X") == "mujoco-core-x"


def test_pymunk_rows_depend_on_the_version_of_cffi_and_mujoco_rows_do_not(monkeypatch):
    from engines.mujoco import DEFAULT as MUJOCO
    from engines.pymunk import DEFAULT as PYMUNK

    assert "cffi" in with_required(["pymunk"])
    before = fingerprint.fingerprint(PYMUNK), fingerprint.fingerprint(MUJOCO)
    true_version = metadata.version
    monkeypatch.setattr(fingerprint.metadata, "version", lambda name: "0" if name == "cffi" else true_version(name))
    try:
        for cached in (fingerprint.digest_of, fingerprint._version):
            cached.cache_clear()
        after = fingerprint.fingerprint(PYMUNK), fingerprint.fingerprint(MUJOCO)
    finally:
        for cached in (fingerprint.digest_of, fingerprint._version):
            cached.cache_clear()
    assert after[0] != before[0]
    assert after[1] == before[1]


def test_every_dependency_has_a_lower_bound_that_can_be_tried():
    bounds = lower_bounds(PYPROJECT.read_text(encoding="utf-8"))
    assert "numpy==2.0" in bounds
    assert len(bounds) == len(set(bounds)) > 10
    with pytest.raises(ValueError, match="'loose' has no lower bound"):
        lower_bounds('[project]\ndependencies = ["loose"]\noptional-dependencies = {test = []}')
