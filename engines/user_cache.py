"""The user's cache folder, for files that take long to compute."""

from __future__ import annotations

import os
import sys
from pathlib import Path

NAME = "planar-crosscheck"
CACHE = "PLANAR_CROSSCHECK_CACHE"


def cache_folder() -> Path:
    """The folder that the variable CACHE names, or a folder in the system's cache folder. The folder may not exist."""
    if os.environ.get(CACHE):
        return Path(os.environ[CACHE]).absolute()
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / NAME
