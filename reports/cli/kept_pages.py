"""The files of pages, kept beside a store: a page that would be the same again is not drawn again.

What is kept goes by a digest of all that a page may be made from: what is stored of it, every file of this program but
those that a report writes, what is installed, and the machine that stands at a page's foot. It may be deleted.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib import metadata
from pathlib import Path

import numpy as np

from reports.model.fingerprint import OURS, ROOT, digest_of, modules_behind
from reports.model.page import Material, Page
from reports.pages.rendering import foot
from reports.run.store import text_of_row

PUBLISHED = ROOT / "reports" / "results"
# Of what is published: what a report writes there, and reads never.
WRITTEN_NAMES = ("errors.csv", "timings.csv", "descriptions.csv")
WRITTEN_KINDS = (".md", ".svg")

Files = Mapping[str, str]


def digest(page: Page, material: Material, command: str, words: Iterable[str]) -> str:
    """A digest of all that the page's files depend on. words: what the store remembers, if the report tells of it."""
    told = hashlib.sha256()
    for part in (page.name, command, *words, _surroundings(), foot(command, page.engines)):
        told.update(part.encode() + b"\0")
    told.update(digest_of(frozenset(modules_behind(page))).encode())
    for cell, row in material.rows.items():
        told.update(f"{cell.key}\0{text_of_row(row)}\0".encode())
    for task, answer in material.answers.items():
        told.update(f"{task.key}\0{answer.outcome}\0{answer.sentence}\0{answer.limit}\0".encode())
        for name, value in answer.values.items():
            data = value.encode() if isinstance(value, str) else np.asarray(value, dtype=float).tobytes()
            told.update(f"{name}\0{np.shape(value)}\0".encode() + data)
    return told.hexdigest()


def kept(folder: Path, name: str, digest: str) -> Files | None:
    """The files that were kept of the page of this name; None unless they are whole and of this digest."""
    with suppress(OSError, ValueError, KeyError, TypeError, AttributeError):
        told = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        if told["digest"] == digest and told["whole"] == _whole(told["files"]):
            return dict(told["files"])
    return None


def keep(folder: Path, name: str, digest: str, files: Files) -> None:
    """Keep a page's files, whole or not at all; without them only time is lost."""
    half = folder / f"{name}.{os.getpid()}.half"
    text = json.dumps({"digest": digest, "whole": _whole(files), "files": dict(files)})
    with suppress(OSError):
        folder.mkdir(exist_ok=True)
        try:
            half.write_text(text, encoding="utf-8")
            half.replace(folder / f"{name}.json")
        finally:
            half.unlink(missing_ok=True)


def _whole(files: Files) -> str:
    return hashlib.sha256(json.dumps(dict(files), sort_keys=True).encode()).hexdigest()


@cache
def _surroundings() -> str:
    """A digest of this program's files and of what is installed, by its version."""
    told = hashlib.sha256(sys.version.encode())
    for path in sorted(_sources()):
        told.update(str(path.relative_to(ROOT)).encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    for installed in sorted(f"{each.name}=={each.version}" for each in metadata.distributions()):
        told.update(installed.encode() + b"\0")
    return told.hexdigest()


def _sources() -> Iterator[Path]:
    for package in OURS:
        for path in (ROOT / package).rglob("*"):
            written = path.parent == PUBLISHED and (path.name in WRITTEN_NAMES or path.suffix in WRITTEN_KINDS)
            if not written and "__pycache__" not in path.parts and path.is_file():
                yield path
