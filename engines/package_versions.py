"""Versions of installed packages: distributions of Python, and packages of npm in the user's cache folder."""

from __future__ import annotations

import json
from importlib import metadata
from pathlib import Path

from engines.user_cache import cache_folder


def npm_folder() -> Path:
    """The folder in which npm installs the engines of the browser; it may not exist."""
    return cache_folder() / "browser"


def installed_version(package: str) -> str:
    """The version of a Python distribution or npm package. Raises PackageNotFoundError if it is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        description = npm_folder() / "node_modules" / package / "package.json"
        if not description.is_file():
            raise
        return str(json.loads(description.read_text(encoding="utf-8"))["version"])
