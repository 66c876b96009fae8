"""The tests by rooms: `reference`, `engines`, `reports`, `tools`; `wrong` has models and adapters that are wrong."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "reports" / "results"
