"""Where a method is known to fall short on Andrews' mechanism, each with its reason."""

from __future__ import annotations

from reports.gate.checks import Deviation

KNOWN: dict[tuple[str, str, str], Deviation] = {}
