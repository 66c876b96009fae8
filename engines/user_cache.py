"""The user's cache folder: what can be had anew, and takes long enough to be kept."""

from __future__ import annotations

import os
import sys
from pathlib import Path

NAME = "planar-crosscheck"
CACHE = "PLANAR_CROSSCHECK_CACHE"


def cache_folder() -> Path:
    """What the environment variable CACHE says, or the system's folder for what can be had anew; it may not exist."""
    if os.environ.get(CACHE):
        return Path(os.environ[CACHE]).absolute()
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / NAME
