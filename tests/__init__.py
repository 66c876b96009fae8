"""Tests of the reference, engines, reports and tools. The folder `wrong` has wrong models and adapters."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "reports" / "results"
