"""Munk2D, the engine inside pymunk, from pymunk's source package to one JavaScript file, by emscripten."""

from __future__ import annotations

import shutil
from importlib.metadata import version
from pathlib import Path

from reports.model.ending import BadInput
from reports.model.fingerprint import digest
from reports.run.files import temporary_folder
from reports.run.installed import sources
from reports.site.packages import ANSWERING, NotFetched, printed

SHIM = Path(__file__).with_suffix(".c")
# At -O2 emscripten 3.1.6 of Debian fails in a later step.
FLAGS = (
    *("-O1", "-DNDEBUG", "-sSINGLE_FILE=1", "-sMODULARIZE=1", "-sEXPORT_ES6=1", "-sENVIRONMENT=web,worker"),
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
    told = printed([compiler, "--version"], "emscripten does not tell its version", PATIENCE).splitlines()
    parts = (release, SHIM.read_text(encoding="utf-8"), " ".join(FLAGS), *told[:1])
    kept = cache / f"munk2d-{digest(repr(parts))}.js"
    if not kept.is_file():
        kept.parent.mkdir(parents=True, exist_ok=True)
        with temporary_folder(kept.parent) as folder:
            _compile(compiler, _sources(release, folder), folder / "munk2d.mjs").replace(kept)
    return kept.read_bytes()


def _sources(release: str, folder: Path) -> Path:
    """The folder of Munk2D in pymunk's source package of this release."""
    try:
        # Seconds without an answer, of which there may be two.
        return sources("pymunk", release, folder, "--retries", "0", "--timeout", str(ANSWERING // 2)) / "Munk2D"
    except BadInput as reason:
        raise NotFetched(str(reason)) from None


def _compile(compiler: str, sources: Path, output: Path) -> Path:
    files = sorted(str(path) for path in (sources / "src").glob("*.c") if path.name != THREADED)
    words = [compiler, *FLAGS, f"-I{sources / 'include'}", str(SHIM), *files, "-o", str(output)]
    printed(words, "emscripten refuses Munk2D", PATIENCE)
    return output
