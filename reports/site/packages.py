"""Parts of the site that others made: packages of npm, and Munk2D, the engine inside pymunk, compiled by emscripten.

They are fetched when the site is built, checked, and kept in a folder `cache`; nothing is fetched when a page is read.
Without npm, a compiler or a network the site is built without the parts that need them.
"""

from __future__ import annotations

import base64
import functools
import hashlib
import shutil
import subprocess
import tarfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from reports.model.ending import BadInput
from reports.model.fingerprint import digest
from reports.run.files import temporary_folder
from reports.run.installed import sources

PATIENCE = 180  # s for one package
ANSWERING = 8  # s in which a registry answers a short question: without one, a build says so soon
COMPILING = 600  # s for emscripten, which builds its own library first
SHIM = Path(__file__).with_name("munk2d.c")
# At -O2 emscripten 3.1.6 of Debian fails in a later step.
FLAGS = (
    *("-O1", "-DNDEBUG", "-sSINGLE_FILE=1", "-sMODULARIZE=1", "-sEXPORT_ES6=1", "-sENVIRONMENT=web,worker"),
    *("-sEXPORTED_FUNCTIONS=_munk_run,_malloc,_free", "-sALLOW_MEMORY_GROWTH=1", "-sFILESYSTEM=0"),
)
THREADED = "cpHastySpace.c"  # steps with threads, which pages have not


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

    def path_in(self, cache: Path) -> Path:
        """The archive in the folder `cache`."""
        return cache / f"{self.name.strip('@').replace('/', '-')}-{self.version}.tgz"


class NotFetched(Exception):
    """Why a package is not there, in a sentence."""


@functools.cache
def npm_trouble(cache: Path) -> str:
    """Why nothing can be fetched; empty where all packages are in the folder or npm's registry answers."""
    if all(package.path_in(cache).is_file() for package in PACKAGES):
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


def fetch_package(package: Package, cache: Path) -> dict[str, bytes]:
    """The package's files by their names in the site, fetched once into `cache`. Raises NotFetched."""
    path = package.path_in(cache)
    if not path.is_file():
        if trouble := npm_trouble(cache):
            raise NotFetched(trouble)
        cache.mkdir(parents=True, exist_ok=True)
        with temporary_folder(cache) as folder:
            words = ["npm", "pack", f"{package.name}@{package.version}", "--silent", "--ignore-scripts"]
            printed(words, f"npm could not fetch {package.name} {package.version}", PATIENCE, cwd=folder)
            (archive,) = folder.glob("*.tgz")
            archive.replace(path)
    if base64.b64encode(hashlib.sha512(path.read_bytes()).digest()).decode() != package.sha512:
        path.unlink()
        raise NotFetched(f"{package.name} {package.version} has another digest than the one that is known")
    with tarfile.open(path, encoding="utf-8") as opened:
        return {name: opened.extractfile(f"package/{part}").read() for part, name in package.files}  # type: ignore[union-attr]


def compile_munk2d(cache: Path) -> bytes:
    """The engine as one JavaScript file, kept in `cache` for this version, shim and compiler. Raises NotFetched."""
    compiler = shutil.which("emcc")
    if compiler is None:
        raise NotFetched("emscripten is not installed")
    release = version("pymunk")
    told = printed([compiler, "--version"], "emscripten does not tell its version", COMPILING).splitlines()
    parts = (release, SHIM.read_text(encoding="utf-8"), " ".join(FLAGS), *told[:1])
    path = cache / f"munk2d-{digest(repr(parts))}.js"
    if not path.is_file():
        cache.mkdir(parents=True, exist_ok=True)
        with temporary_folder(cache) as folder:
            try:  # seconds without an answer, of which there may be two
                words = ("--retries", "0", "--timeout", str(ANSWERING // 2))
                engine = sources("pymunk", release, folder, *words) / "Munk2D"
            except BadInput as reason:
                raise NotFetched(str(reason)) from None
            files = sorted(str(each) for each in (engine / "src").glob("*.c") if each.name != THREADED)
            output = folder / "munk2d.mjs"
            command = [compiler, *FLAGS, f"-I{engine / 'include'}", str(SHIM), *files, "-o", str(output)]
            printed(command, "emscripten refuses Munk2D", COMPILING)
            output.replace(path)
    return path.read_bytes()


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
