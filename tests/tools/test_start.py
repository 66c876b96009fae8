"""How the program starts: what help needs is loaded, and no more."""

from __future__ import annotations

import subprocess
import sys

import pytest

# numpy alone takes as long to load as all that help needs; what follows from it, ten times as long.
HEAVY = ("numpy", "scipy", "matplotlib", "pymunk", "mujoco", "numba", "reference.joints", "engines")


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"], ["report", "--help"], ["shapes", "--help"]])
def test_help_loads_nothing_that_a_run_needs(words):
    code = f"import sys\nfrom reports.__main__ import main\nsys.argv = ['crosscheck', *{words!r}]\ntry:\n    main()\n"
    code += f"except SystemExit:\n    print(*[name for name in {HEAVY!r} if name in sys.modules], file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "Usage" in done.stdout
    assert done.stderr.split() == []
