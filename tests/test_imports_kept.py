"""What sources import is read once and kept beside a store: it is never stale, and what is damaged is read anew."""

from __future__ import annotations

import json

import pytest

from reports.model import imports
from reports.model.imports import KEPT, keep, named_in, recall

TEXT = b"import numpy\nfrom . import near\nFILE = 'table.csv'\n"
NAMED = ({"numpy", "theirs", "theirs.near"}, {"table.csv"})


@pytest.fixture(autouse=True)
def parsed(monkeypatch):
    """Nothing is known; the texts that are parsed."""
    texts = []
    read = imports._read
    monkeypatch.setattr(imports, "_known", {})
    monkeypatch.setattr(imports, "_read", lambda text, package: texts.append(text) or read(text, package))
    return texts


def forgotten(monkeypatch):
    monkeypatch.setattr(imports, "_known", {})


def test_a_text_is_parsed_once_and_in_the_next_process_not_at_all(tmp_path, monkeypatch, parsed):
    assert named_in(TEXT, "theirs") == named_in(TEXT, "theirs") == NAMED
    keep(tmp_path)
    forgotten(monkeypatch)
    assert recall(tmp_path) == 1
    assert named_in(TEXT, "theirs") == NAMED
    assert parsed == [TEXT]


def test_a_changed_text_and_one_in_another_package_are_parsed(tmp_path, monkeypatch, parsed):
    named_in(TEXT, "theirs")
    keep(tmp_path)
    forgotten(monkeypatch)
    recall(tmp_path)
    assert named_in(TEXT + b"import scipy\n", "theirs")[0] == {*NAMED[0], "scipy"}
    assert "ours.near" in named_in(TEXT, "ours")[0]
    assert len(parsed) == 3


@pytest.mark.parametrize("damage", ["cut", "no file", "forged", "list", "another reader"])
def test_what_is_damaged_or_read_by_other_code_is_not_believed(tmp_path, monkeypatch, parsed, damage):
    named_in(TEXT, "theirs")
    keep(tmp_path)
    forgotten(monkeypatch)
    file = tmp_path / KEPT
    text = file.read_text("utf-8")
    match damage:
        case "cut":
            file.write_text(text[:-9], "utf-8")
        case "no file":
            file.unlink()
        case "forged":
            told = json.loads(text)
            file.write_text(json.dumps({**told, "read": told["read"].replace("numpy", "scipy")}), "utf-8")
        case "list":
            file.write_text("[1, 2]", "utf-8")
        case "another reader":
            monkeypatch.setattr(imports, "_reader", lambda: "changed")
    assert recall(tmp_path) == 0
    assert named_in(TEXT, "theirs") == NAMED
    assert parsed == [TEXT, TEXT]


def test_without_the_folder_only_time_is_lost(tmp_path):
    named_in(TEXT, "theirs")
    keep(tmp_path / "nowhere")
    assert not (tmp_path / "nowhere").exists()
    assert list(tmp_path.iterdir()) == []
