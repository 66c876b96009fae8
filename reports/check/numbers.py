"""What a check found, as plain data for other programs."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from reports.check.checked import Checked
from reports.check.comparing import QUANTITIES
from reports.check.settings import Tried


def data(found: Checked) -> dict[str, Any]:
    """All numbers of the report, for other programs."""

    def plain(value: Any) -> Any:
        if isinstance(value, float) and not math.isfinite(value):
            return None
        if isinstance(value, dict):
            return {key: plain(each) for key, each in value.items()}
        if isinstance(value, tuple | list):
            return [plain(each) for each in value]
        return value

    def setting(each: Tried | None) -> Any:
        if each is None:
            return None
        return {
            "words": each.change.words,
            "step": each.change.dt,
            "error": each.error,
            "reaction": each.errors.worst("reaction"),
            "cpu": each.cost,
            "lines": list(each.change.lines),
        }

    own, judge = found.own_errors, found.judge_errors
    return plain(
        {
            "name": found.name,
            "engine": found.reading.model.engine,
            "duration": found.duration,
            "tolerance": found.tolerance,
            "met": found.met,
            "assumed": found.reading.model.assumed,
            "error": own.largest,
            "cpu": found.cost,
            "facts": asdict(found.facts),
            "horizon": found.judge.horizon,
            "growth": float(found.judge.growth[-1]),
            "agreement_at_start": found.agreement,
            "notes": [asdict(note) for note in found.reading.notes],
            "settings": dict(found.reading.model.settings),
            "errors": {quantity: own.worst(quantity) for quantity in QUANTITIES},
            "judge_errors": {quantity: judge.worst(quantity) for quantity in QUANTITIES},
            "over_time": {"t": own.t.tolist(), **{name: values.tolist() for name, values in own.of.items()}},
            "parts": asdict(found.parts),
            "opening": None if found.opens is None else asdict(found.opens),
            "warnings": list(found.own.warnings),
            "tried": [setting(each) for each in found.table],
            "advised": setting(found.advised),
            "next_decade": setting(found.decade),
        }
    )
