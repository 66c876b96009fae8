"""`python -m reports.site.munk2d FILE`: Munk2D as one JavaScript file; `--install` first gets Debian's emscripten."""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from reports.site.munk2d.compiling import compiled
from reports.site.packages import NotFetched


def main() -> int:
    """Compile it; the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--install", action="store_true", help="first install Debian's package emscripten, by apt-get")
    given = parser.parse_args()
    if given.install:
        subprocess.run(["apt-get", "install", "--yes", "--no-install-recommends", "emscripten"], check=True)
    with tempfile.TemporaryDirectory() as cache:
        try:
            given.file.write_bytes(compiled(Path(cache)))
        except NotFetched as reason:
            print(f"crosscheck: {reason}", file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
