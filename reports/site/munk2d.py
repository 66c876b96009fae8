"""Munk2D, the engine in pymunk, as WebAssembly. `python -m reports.site.munk2d` compiles it by emscripten.

The compiled file is part of the package, so `crosscheck site` needs no compiler. The first line of the file has the
release of pymunk and a digest of the sources.
"""

from __future__ import annotations

import re
from importlib.metadata import version
from pathlib import Path

from reports.model.fingerprint import digest
from reports.run.files import temporary_folder
from reports.run.installed import sources
from reports.site.packages import printed

SHIM = Path(__file__).with_name("munk2d.c")
COMPILED = SHIM.with_suffix(".js")
# s: timeout of emscripten, which builds its library first. At -O2 emscripten 3.1.6 of Debian fails in a later step.
COMPILING = 600
FLAGS = (
    *("-O1", "-DNDEBUG", "-sSINGLE_FILE=1", "-sMODULARIZE=1", "-sEXPORT_ES6=1", "-sENVIRONMENT=web,worker"),
    *("-sEXPORTED_FUNCTIONS=_munk_run,_malloc,_free", "-sALLOW_MEMORY_GROWTH=1", "-sFILESYSTEM=0"),
)
THREADED = "cpHastySpace.c"  # This source file needs threads, which the page does not have.


def source_digest(release: str) -> str:
    """Return the digest of munk2d.c, the compiler's flags and pymunk's release. The release determines Munk2D."""
    return digest(repr((release, SHIM.read_text(encoding="utf-8"), FLAGS)))


def compiled_from(text: str) -> tuple[str, str]:
    """Return the release of pymunk and the digest in the first line of a compiled file."""
    found = re.match(r"// Munk2D of pymunk (\S+), sources (\S+)\n", text)
    return (found[1], found[2]) if found else ("", "")


def compile_munk2d(release: str) -> str:
    """Return a JavaScript file with Munk2D from a release of pymunk. The file begins with the licence of Munk2D.

    Raises BadInput if pip cannot fetch the sources, NotFetched if emscripten fails.
    """
    with temporary_folder(Path.cwd()) as folder:
        engine = sources("pymunk", release, folder) / "Munk2D"
        files = sorted(str(path) for path in (engine / "src").glob("*.c") if path.name != THREADED)
        output = folder / "munk2d.mjs"
        command = ["emcc", *FLAGS, f"-I{engine / 'include'}", str(SHIM), *files, "-o", str(output)]
        printed(command, "emscripten refuses Munk2D", COMPILING)
        licence = (engine / "LICENSE.txt").read_text(encoding="utf-8").strip()
        head = f"// Munk2D of pymunk {release}, sources {source_digest(release)}\n/*\n{licence}\n*/\n"
        return head + output.read_text(encoding="utf-8")


if __name__ == "__main__":
    COMPILED.write_text(compile_munk2d(version("pymunk")), encoding="utf-8")
