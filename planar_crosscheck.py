"""The program's start, under the one name that is ours alone: it says when another package hides one of ours.

`reference`, `engines` and `reports` are general names, and Python takes the first package of a name that it finds.
"""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec

PACKAGES = ("reference", "engines", "reports")
HERE = os.path.dirname(os.path.realpath(__file__))


def clash(packages: tuple[str, ...] = PACKAGES) -> str:
    """A sentence about the first package that is not the one beside this file; empty if all are. Imports none."""
    for name in packages:
        try:
            found = find_spec(name)
        except (ImportError, ValueError):  # a module of this name was put there by hand
            found = None
        folders = [] if found is None else list(found.submodule_search_locations or [found.origin])
        if os.path.join(HERE, name) not in map(os.path.realpath, filter(None, folders)):
            where = f"is another one, at {folders[0]}" if folders else "is missing"
            return (
                f"the package {name!r} {where}, and ours is at {os.path.join(HERE, name)}: start from another folder, "
                "or in an environment of its own"
            )
    return ""


def main() -> None:
    """The program `crosscheck`. Always raises SystemExit."""
    told = clash()
    if told:
        print(f"crosscheck: {told}", file=sys.stderr)
        sys.exit(2)
    from reports.__main__ import main as program

    program()


if __name__ == "__main__":
    main()
