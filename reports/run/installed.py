"""Functions that install one version or build of a package into a folder in the user's cache.

    folder = installed(("mujoco-core", "mujoco"), "3.6.0")
    subprocess.run([sys.executable, "program.py"], env=environment(folder))

The program then imports the package from that folder first. pip installs a version once, without its dependencies.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import metadata
from pathlib import Path

from engines.user_cache import CACHE, cache_folder
from reports.model.ending import BadInput
from reports.model.fingerprint import digest
from reports.run.files import folder_for, temporary_folder

# `reports.model.fingerprint` identifies modules in a folder with this name by their version.
PACKAGES = "site-packages"
VERSION = re.compile(r"[0-9][0-9A-Za-z.!+_-]*")
OFFERED = re.compile(r"from versions: ([^)]*)\)")
UNCONNECTED = ("NewConnectionError", "Name or service not known", "Failed to establish a new connection")
OFFLINE = "no connection to a package index; with network it is installed once and kept"
MOST_INSTALLED = 60  # Largest number of installed versions and builds. No command uses more at once.
MOST_SUGGESTED = 6  # Largest number of existing versions that an error message lists.
# Without these variables, older versions of MuJoCo import their viewer, which needs further packages.
WITHOUT_WINDOWS = {"MUJOCO_GL": "disable", "PYGAME_HIDE_SUPPORT_PROMPT": "1"}


def environment(folder: Path, further: Sequence[Path] = ()) -> dict[str, str]:
    """Environment variables for a process that imports first from `folder` and then from the folders `further`."""
    paths = os.pathsep.join(str(path) for path in (folder, *further))
    switches = {"PYTHONPATH": paths, "PYTHONSAFEPATH": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return {**os.environ, **WITHOUT_WINDOWS, **switches}


def installed(names: Sequence[str], version: str) -> Path:
    """Return the folder of a version, which is installed if necessary. The first distribution with this version counts.
    Raises BadInput if the version does not exist or has no wheel for this Python, or if there is no network."""
    if not VERSION.fullmatch(version):
        raise BadInput(f"{version!r} is no version; give one like 3.6.0")
    places = {name: _place(f"{name}-{version}") for name in names}
    for folder in places.values():
        if folder.is_dir():
            return _used(folder)
    texts = {}
    for name, folder in places.items():
        texts[name] = _install(f"{name}=={version}", folder)
        if not texts[name]:
            return _used(folder)
    raise _refusal(version, texts)


def built(path: Path) -> Path:
    """Install a wheel or a folder of sources and return the folder of the installation. pip builds the sources. A
    folder without pyproject.toml and setup.py contains installed packages and is returned unchanged. A wheel is
    installed again if its content has changed. A folder of sources is installed every time. Raises BadInput."""
    path = path.absolute()
    if path.is_dir():
        if not any((path / name).is_file() for name in ("pyproject.toml", "setup.py")):
            return path
        name = f"build-{digest(str(path))}"
        shutil.rmtree(_place(name), ignore_errors=True)
    elif path.suffix == ".whl" and path.is_file():
        name = f"wheel-{digest(path.read_bytes())}"
    else:
        raise BadInput(f"{path}: there is no such folder or wheel; give NAME==VERSION, a .whl file or a folder")
    folder = _place(name)
    if not folder.is_dir() and (text := _install(str(path), folder, wheels_only=path.is_file())):
        raise BadInput(f"{path} can't be installed: {_reason(text)}")
    return _used(folder)


def sources(name: str, version: str, folder: Path, *options: str) -> Path:
    """Download and unpack the source package of a version in `folder`. options: options of pip. Raises BadInput."""
    command = [sys.executable, "-P", "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
    command += ["--no-binary", name, f"{name}=={version}", "--dest", str(folder), *options]
    ended = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", errors="replace", check=False)
    archives = list(folder.glob(f"{name}-*.tar.gz"))
    if ended.returncode or not archives:
        raise BadInput(f"pip could not fetch the source package of {name} {version}: {_reason(ended.stderr)}")
    with tarfile.open(archives[0], encoding="utf-8") as archive:
        archive.extraction_filter = getattr(tarfile, "data_filter", None)  # absent before Python 3.11.4
        archive.extractall(folder)
    return folder / f"{name}-{version}"


def _place(name: str) -> Path:
    python = f"{sys.implementation.cache_tag}-{sysconfig.get_platform()}"
    return cache_folder() / "versions" / python / name / PACKAGES


def _used(folder: Path) -> Path:
    """Mark the folder as used and return it. Delete the least recently used versions above MOST_INSTALLED."""
    with suppress(OSError):
        os.utime(folder.parent)
        others = [each for each in (cache_folder() / "versions").glob("*/*") if not each.name.startswith(".")]
        for old in sorted(others, key=lambda each: each.stat().st_mtime, reverse=True)[MOST_INSTALLED:]:
            shutil.rmtree(old, ignore_errors=True)
    return folder


def _install(what: str, folder: Path, wheels_only: bool = True) -> str:
    remedy = f"set {CACHE} to a folder that can be written"
    folder_for(folder.parent, remedy)
    try:
        with temporary_folder(folder.parent) as aside:
            target = aside / PACKAGES
            command = [sys.executable, "-P", "-m", "pip", "install", "--no-deps", "--no-compile", "--retries", "2"]
            command += ["--disable-pip-version-check", "--no-input", "--target", str(target)]
            command += ["--only-binary", ":all:"] if wheels_only else []
            # pip runs in a temporary folder, since it may leave files in its working folder.
            run = subprocess.run(
                [*command, "--", what], capture_output=True, text=True, errors="replace", cwd=aside, check=False
            )
            if run.returncode or not target.is_dir():
                return run.stderr.strip() or run.stdout.strip() or f"pip ended with status {run.returncode}"
            try:
                target.rename(folder)
            except OSError:
                if not folder.is_dir():  # Otherwise another process has installed the version.
                    raise
    except OSError as error:
        raise BadInput(f"{folder} can't be written ({error.strerror or error}): {remedy}") from None
    finally:
        with suppress(OSError):  # The folder is not empty if a version is installed in it.
            folder.parent.rmdir()
    return ""


def _reason(text: str) -> str:
    if any(mark in text for mark in UNCONNECTED):
        return OFFLINE
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("ERROR")]
    return (errors or lines or ["pip failed"])[-1].removeprefix("ERROR: ")


def _refusal(version: str, texts: Mapping[str, str]) -> BadInput:
    names, reasons = " or ".join(texts), {name: _reason(text) for name, text in texts.items()}
    if set(reasons.values()) == {OFFLINE}:
        return BadInput(f"{names} {version} can't be fetched: {OFFLINE}")
    about = f"no wheel of {names} {version} for this Python ({sys.version_info[0]}.{sys.version_info[1]})"
    lists = [match[1] for text in texts.values() for match in OFFERED.finditer(text)]
    offered = dict.fromkeys(version for listing in lists for version in listing.split(", ") if VERSION.match(version))
    if offered:
        return BadInput(f"{about}; there are {', '.join(nearest_versions(version, list(offered)))}")
    reasons_text = "; ".join(f"{name}: {reason}" for name, reason in reasons.items() if not OFFERED.search(texts[name]))
    return BadInput(f"{about}: {reasons_text or 'the package index knows none'}")


def nearest_versions(version: str, offered: Sequence[str]) -> list[str]:
    """Up to MOST_SUGGESTED offered versions near this version, in ascending order."""
    ordered = sorted(offered, key=numbers)
    index = sum(numbers(other) < numbers(version) for other in ordered)
    low = max(0, min(index - MOST_SUGGESTED // 2, len(ordered) - MOST_SUGGESTED))
    return ordered[low : low + MOST_SUGGESTED]


def numbers(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in re.findall(r"\d+", version))


def distributions_in(folder: Path) -> Mapping[str, str]:
    """Name -> version of a distribution in a folder, from the metadata. Versions in modules are not reliable. For
    example, the module of pymunk 7.0.0 reports 2.0.0."""
    found = metadata.distributions(path=[str(folder)])
    return {name: distribution.version for distribution in found if (name := distribution.metadata["Name"])}
