"""Where a method is known to fall short on the person, each with its reason."""

from __future__ import annotations

from reports.checks import Deviation

KNOWN: dict[tuple[str, str, str], Deviation] = {}
