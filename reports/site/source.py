"""What a site is built from, and what could not be built."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from reports.model.tasks import Answer, Motion


@dataclass
class Source:
    """What a site is built from: Markdown pages and pictures by file name, and the answers to the lessons' tasks."""

    pages: Mapping[str, str]
    pictures: Mapping[str, str]
    tables: Mapping[str, str]  # CSV files by name
    answers: Mapping[Motion, Answer]
    cache: Path
    foot: str
    contributing: str = ""  # CONTRIBUTING.md, of which how-to pages quote parts; empty outside of a checkout
    api: bool = True  # whether pdoc makes the reference, which takes some ten seconds
    troubles: list[str] = field(default_factory=list)  # what could not be built, and why, a sentence each
