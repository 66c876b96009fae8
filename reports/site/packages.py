"""Packages of npm: fetched by version when the site is built, checked by their digest, and unpacked as far as needed.

Nothing is fetched when a page is read. Without npm, or without a network, the site is built without what needs them.
"""

from __future__ import annotations

import base64
import hashlib
import shutil
import subprocess
import tarfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from reports.run.files import temporary_folder

PATIENCE = 180  # s for one package
ANSWERING = 8  # s in which a registry answers a short question: without one, a build says so soon


@dataclass(frozen=True)
class Package:
    """A package of npm: its version, the digest that its archive must have, its licence, and by their paths in the
    archive the names of the files in the site.
    """

    name: str
    version: str
    sha512: str  # base64, as npm writes it
    licence: str
    use: str
    files: tuple[tuple[str, str], ...]


class NotFetched(Exception):
    """Why a package is not there, in a sentence."""


@dataclass(frozen=True)
class Registry:
    """Where packages come from, and the folder `cache` in which they are kept."""

    cache: Path

    @cached_property
    def trouble(self) -> str:
        """Why nothing can be fetched, asked once; empty where all packages are there or npm's registry answers."""
        if all(self._path(package).is_file() for package in PACKAGES):
            return ""
        npm = shutil.which("npm")
        if npm is None:
            return "npm is not installed"
        words = [npm, "view", "d3", "version", "--fetch-retries=0", f"--fetch-timeout={1000 * ANSWERING}"]
        try:
            printed(words, "npm's registry does not answer", ANSWERING)
        except NotFetched as reason:
            return str(reason)
        return ""

    def fetched(self, package: Package) -> dict[str, bytes]:
        """The package's files by their names in the site, fetched once into `cache`. Raises NotFetched."""
        path = self._path(package)
        if not path.is_file():
            if self.trouble:
                raise NotFetched(self.trouble)
            _fetch(package, path)
        digest = base64.b64encode(hashlib.sha512(path.read_bytes()).digest()).decode()
        if digest != package.sha512:
            path.unlink()
            raise NotFetched(f"{package.name} {package.version} has another digest than the one that is known")
        with tarfile.open(path, encoding="utf-8") as archive:
            return {name: archive.extractfile(f"package/{path}").read() for path, name in package.files}  # type: ignore[union-attr]

    def _path(self, package: Package) -> Path:
        return self.cache / f"{package.name.strip('@').replace('/', '-')}-{package.version}.tgz"


def printed(words: Sequence[str], trouble: str, patience: float, **given: Any) -> str:
    """What a program prints. Raises NotFetched, which begins with `trouble`, where it fails or takes longer [s]."""
    try:
        ended = subprocess.run(words, capture_output=True, encoding="utf-8", timeout=patience, **given)
    except subprocess.TimeoutExpired:
        raise NotFetched(f"{trouble}: it did not end within {patience} s") from None
    if ended.returncode:
        lines = ended.stderr.strip().splitlines() or ["no reason was given"]
        told = [line for line in lines if line.startswith("npm error")]  # further down npm names its own log
        raise NotFetched(f"{trouble}: {told[0] if told else lines[-1]}")
    return ended.stdout


def _fetch(package: Package, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with temporary_folder(path.parent) as folder:
        words = ["npm", "pack", f"{package.name}@{package.version}", "--silent", "--ignore-scripts"]
        printed(words, f"npm could not fetch {package.name} {package.version}", PATIENCE, cwd=folder)
        (found,) = folder.glob("*.tgz")
        found.replace(path)


D3 = Package(
    "d3",
    "7.9.2",
    "ZKb/mONPVKzaO5UlcWcwN8bS4ezvQaYu+bsou+XgNABdGC800kwH651ADTbbTxMPHW13UlvbQafdmJQDk1w7Mg==",
    "ISC",
    "scales and axes of the charts",
    (("dist/d3.min.js", "packages/d3.min.js"), ("LICENSE", "packages/d3.LICENSE.txt")),
)
PLOT = Package(
    "@observablehq/plot",
    "0.6.17",
    "/qaXP/7mc4MUS0s4cPPFASDRjtsWp85/TbfsciqDgU1HwYixbSbbytNuInD8AcTYC3xaxACgVX06agdfQy9W+g==",
    "ISC",
    "the charts of stored rows",
    (("dist/plot.umd.min.js", "packages/plot.min.js"), ("LICENSE", "packages/plot.LICENSE.txt")),
)
MUJOCO = Package(
    "@mujoco/mujoco",
    "3.14.0",
    "WPUYidu4Fx8+uM4hQv80SOA0ifpWGrsNJguKs8JBV8SCTxjKQ2/rqsh880nUH0/Vwa8vuefghvCQkkoed3bkUg==",
    "Apache-2.0",
    "the engine MuJoCo, compiled to WebAssembly by its maintainers",
    (("mujoco.js", "packages/mujoco.js"), ("mujoco.wasm", "packages/mujoco.wasm")),
)
PACKAGES = (D3, PLOT, MUJOCO)
