"""Check whether an engine's imported code belongs to the release in the metadata of its distribution.

Versions in reports and cache keys come from metadata. But pip overwrites files of one distribution with those of
another without a message (`mujoco` 3.17.0 over `mujoco-core`). Also, an editable installation keeps its first metadata.
"""

from __future__ import annotations

import base64
import hashlib
import re
import sys
from collections.abc import Iterable
from functools import cache
from importlib import metadata
from pathlib import Path

from engines.contract import Engine

# The numbers of a version, without the name of a build as in 7.3.1+patched.
RELEASE = re.compile(r"v?(\d+(?:\.\d+)*)")


def other_release(engines: Iterable[Engine], elsewhere: bool = True) -> str:
    """One line about the first distribution whose version differs from that of its imported module; empty if none.

    A module with unchanged files may state any version; pymunk 7.0.0 states 2.0.0.
    `elsewhere`: also check modules outside the distribution's folder, in an editable installation or on the path.
    """
    packages = {package: engine.modules for engine in engines for package in engine.packages}
    differences = (_difference(package, _modules(package, names), elsewhere) for package, names in packages.items())
    return next(filter(None, differences), "")


@cache
def _modules(package: str, names: tuple[str, ...]) -> tuple[str, ...]:
    """The top-level modules in the metadata of a distribution, or else `names`; empty if it is not installed."""
    try:
        modules = (metadata.distribution(package).read_text("top_level.txt") or "").split()
    except metadata.PackageNotFoundError:
        return ()
    return tuple(modules) or names or (package,)


def _difference(package: str, modules: tuple[str, ...], elsewhere: bool) -> str:
    differences = (_difference_of(package, module, elsewhere) for module in modules if module in sys.modules)
    return next(filter(None, differences), "")


@cache
def _difference_of(package: str, module: str, elsewhere: bool) -> str:
    distribution, imported = metadata.distribution(package), sys.modules[module]
    values = (getattr(imported, name, None) for name in ("__version__", "version"))
    version = next((value for value in values if _release(value)), None)
    if version is None or _release(version) == _release(distribution.version):
        return ""
    folder, home = Path(imported.__file__ or "").resolve().parent, Path(str(distribution.locate_file(""))).resolve()
    line = f"{package} is {distribution.version} by its metadata, and {module} that is imported is {version}"
    if not folder.is_relative_to(home):
        remedy = "install that folder (pip install, with -e if it was), or take it off the path"
        return f"{line}, from {folder}: {remedy}" if elsewhere else ""
    files = [file for file in distribution.files or () if Path(str(file.locate())).resolve().is_relative_to(folder)]
    if not any(file.name == "__init__.py" and file.parent.name == module for file in files):
        return ""  # this distribution extends a package, as mujoco-mjx extends mujoco
    if not any(map(_is_changed, files)):
        return ""
    others = [
        f"{other.name} {other.version}"
        for other in metadata.distributions()
        if other.name != distribution.name and f"{module}/__init__.py," in (other.read_text("RECORD") or "")
    ]
    cause = f"files of {', '.join(others)} lie over its own" if others else "its files were changed"
    return f"{line}, since {cause}: pip install --force-reinstall --no-deps {package}=={distribution.version}"


def _release(version: object) -> tuple[int, ...]:
    match = RELEASE.match(version) if isinstance(version, str) else None
    return tuple(map(int, re.sub(r"(\.0+)+$", "", match[1]).split("."))) if match else ()


def _is_changed(file: metadata.PackagePath) -> bool:
    if file.hash is None or file.hash.mode != "sha256":
        return False
    try:
        digest = hashlib.sha256(Path(str(file.locate())).read_bytes()).digest()
    except OSError:
        return True
    return base64.urlsafe_b64encode(digest).rstrip(b"=").decode() != file.hash.value
