"""What searches have found, replayed: an open finding is still there, one that is repaired does not come back.

A finding is what `crosscheck search` writes, with why it is so in `reason` ("upstream: ...", "ours: ...") and
whether it is `open`. After a repair, upstream or here, this fails until `open` says so.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from reports.search.page import known_subjects
from reports.search.shrinking import replayed

FOLDER = Path(__file__).parent / "findings"
FINDINGS = sorted(FOLDER.glob("*.json"))


@pytest.mark.parametrize("path", FINDINGS, ids=lambda path: path.stem)
def test_a_finding_is_as_it_was_written_down(path: Path) -> None:
    finding: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    assert finding["reason"].startswith(("upstream: ", "ours: "))
    subject = next(each for each in known_subjects(['["mujoco alone"]']) if each.name == finding["subject"])
    told = replayed(finding, subject)
    assert (finding["check"] in told.faults) == finding["open"], told
