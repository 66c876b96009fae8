"""Print the oldest versions that pyproject.toml allows as constraints for pip, for `make lower`."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

PYPROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def lower_bounds(text: str) -> list[str]:
    """'name==version' of the dependencies and of the extra `test`. Raises ValueError for a missing bound."""
    project = tomllib.loads(text)["project"]
    out = []
    for requirement in (*project["dependencies"], *project["optional-dependencies"]["test"]):
        bound = re.match(r"([A-Za-z0-9_.-]+)\s*>=\s*([0-9.]+)", requirement)
        if not bound:
            raise ValueError(f"pyproject: {requirement!r} has no lower bound; write it as 'name>=version'")
        out.append("==".join(bound.groups()))
    return out


if __name__ == "__main__":
    print("\n".join(lower_bounds(PYPROJECT.read_text(encoding="utf-8"))))
