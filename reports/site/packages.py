"""The npm packages of the site, which packages.toml lists with their digests.

The build fetches the packages, checks their digests and stores them in the folder `cache`. Pages load nothing from
other servers. Without npm or a network, the site is built without these packages.
"""

from __future__ import annotations

import base64
import functools
import hashlib
import shutil
import subprocess
import tarfile
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reports.run.files import temporary_folder

PATIENCE = 180  # s: timeout for one package.
ANSWERING = 8  # s: timeout of a query to a registry. The timeout is short, since the network may be missing.


@dataclass(frozen=True)
class Package:
    """A package of npm. `files`: pairs (path in the archive, name in the site)."""

    name: str
    version: str
    sha512: str  # digest of the archive in base64
    licence: str
    use: str
    files: tuple[tuple[str, str], ...]

    def path_in(self, cache: Path) -> Path:
        return cache / f"{self.name.strip('@').replace('/', '-')}-{self.version}.tgz"


class NotFetched(Exception):
    """A file cannot be fetched or built. The message states the reason."""


@functools.cache
def npm_trouble(cache: Path) -> str:
    """Return the reason why packages cannot be fetched, or "" if they are in `cache` or if npm's registry answers."""
    if all(package.path_in(cache).is_file() for package in PACKAGES):
        return ""
    npm = shutil.which("npm")
    if npm is None:
        return "npm is not installed"
    command = [npm, "view", "d3", "version", "--fetch-retries=0", f"--fetch-timeout={1000 * ANSWERING}"]
    try:
        printed(command, "npm's registry does not answer", ANSWERING)
    except NotFetched as reason:
        return str(reason)
    return ""


def fetch_package(package: Package, cache: Path) -> dict[str, bytes]:
    """Return the files of a package by their names in the site. Raises NotFetched."""
    path = package.path_in(cache)
    if not path.is_file():
        if trouble := npm_trouble(cache):
            raise NotFetched(trouble)
        cache.mkdir(parents=True, exist_ok=True)
        with temporary_folder(cache) as folder:
            command = ["npm", "pack", f"{package.name}@{package.version}", "--silent", "--ignore-scripts"]
            printed(command, f"npm could not fetch {package.name} {package.version}", PATIENCE, cwd=folder)
            (archive,) = folder.glob("*.tgz")
            archive.replace(path)
    if base64.b64encode(hashlib.sha512(path.read_bytes()).digest()).decode() != package.sha512:
        path.unlink()
        raise NotFetched(f"{package.name} {package.version} has an unexpected digest")
    with tarfile.open(path, encoding="utf-8") as opened:
        return {name: opened.extractfile(f"package/{part}").read() for part, name in package.files}  # type: ignore[union-attr]


def printed(command: Sequence[str], trouble: str, patience: float, **given: Any) -> str:
    """Return the output of a program. Raises NotFetched with a message that begins with `trouble` if the program fails
    or takes longer than `patience` [s].
    """
    try:
        ended = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=patience, **given)
    except subprocess.TimeoutExpired:
        raise NotFetched(f"{trouble}: it did not end within {patience} s") from None
    if ended.returncode:
        lines = ended.stderr.strip().splitlines() or ["no reason was given"]
        errors = [line for line in lines if line.startswith("npm error")]  # npm's last lines only name its log file
        raise NotFetched(f"{trouble}: {(errors or lines[-1:])[0]}")
    return ended.stdout


PACKAGES = tuple(
    Package(**{**table, "files": tuple(table["files"].items())})
    for table in tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))["packages"]
)
D3, PLOT, MUJOCO = PACKAGES
