"""Munk2D from pymunk's source package to one JavaScript file, by emscripten, where that is installed.

`python -m reports.site.munk2d` does it by hand. Nothing is installed unless it is asked with `--install`.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
import tarfile
from importlib.metadata import version
from pathlib import Path

from reports.run.files import temporary_folder
from reports.site.packages import NotFetched

SHIM = Path(__file__).with_name("shim.c")
# At -O2 emscripten 3.1.6 of Debian fails in a later step.
FLAGS = (
    *("-O1", "-DNDEBUG", "-sSINGLE_FILE=1", "-sMODULARIZE=1", "-sEXPORT_ES6=1", "-sENVIRONMENT=web"),
    *("-sEXPORTED_FUNCTIONS=_munk_run,_malloc,_free", "-sALLOW_MEMORY_GROWTH=1", "-sFILESYSTEM=0"),
)
THREADED = "cpHastySpace.c"  # steps with threads, which pages have not
PATIENCE = 600  # s for the compiler, which builds its own library first


def compiled(cache: Path) -> bytes:
    """The module, kept in `cache` for this version, shim and compiler. Raises NotFetched, saying what is missing."""
    compiler = shutil.which("emcc")
    if compiler is None:
        raise NotFetched("emscripten is not installed")
    release = version("pymunk")
    told = subprocess.run([compiler, "--version"], capture_output=True, text=True, encoding="utf-8").stdout.splitlines()
    parts = (release, SHIM.read_text(encoding="utf-8"), " ".join(FLAGS), *told[:1])
    kept = cache / f"munk2d-{hashlib.sha256(repr(parts).encode()).hexdigest()[:16]}.js"
    if not kept.is_file():
        kept.parent.mkdir(parents=True, exist_ok=True)
        with temporary_folder(kept.parent) as folder:
            _compile(compiler, _sources(release, folder), folder / "munk2d.mjs").replace(kept)
    return kept.read_bytes()


def _sources(release: str, folder: Path) -> Path:
    """The folder of Munk2D in pymunk's source package of this release, which pip fetches."""
    words = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
    words += ["--no-binary", "pymunk", f"pymunk=={release}", "--dest", str(folder)]
    ended = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE)
    found = list(folder.glob("pymunk-*.tar.gz"))
    if ended.returncode or not found:
        raise NotFetched(f"pip could not fetch the source package of pymunk {release}")
    with tarfile.open(found[0], encoding="utf-8") as archive:
        archive.extractall(folder, filter="data")
    return folder / f"pymunk-{release}" / "Munk2D"


def _compile(compiler: str, sources: Path, output: Path) -> Path:
    files = sorted(str(path) for path in (sources / "src").glob("*.c") if path.name != THREADED)
    words = [compiler, *FLAGS, f"-I{sources / 'include'}", str(SHIM), *files, "-o", str(output)]
    ended = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE)
    if ended.returncode:
        raise NotFetched(f"emscripten refuses Munk2D: {(ended.stderr.strip().splitlines() or ['no reason'])[-1]}")
    return output
