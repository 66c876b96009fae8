"""The lists of mistakes: reading them, and making one mistake in a copy of the tree."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
LISTS = tuple(sorted(Path(__file__).parent.glob("*.toml")))
FIELDS = {"file", "mistake", "old", "new", "tests"}


class BadList(ValueError):
    """A mistake that is not described as it should be: which one, and what it lacks."""


@dataclass(frozen=True)
class Mutant:
    """One mistake: in `file`, `old` (which stands there exactly once) becomes `new`.

    `tests` are pytest's node ids or files, the likeliest to notice it first. `survives` is the reason for which it may
    get through, empty for all others.
    """

    name: str
    file: str
    mistake: str
    old: str
    new: str
    tests: tuple[str, ...]
    survives: str = ""

    def applied(self, root: Path) -> str:
        """The whole text of the file with the mistake in it; raises LookupError where `old` doesn't stand once."""
        path = root / self.file
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        found = text.count(self.old)
        if found != 1:
            raise LookupError(f"{self.name}: its text stands {found} times in {self.file}")
        return text.replace(self.old, self.new)


def read(paths: Iterable[Path] = LISTS) -> tuple[Mutant, ...]:
    """Every mistake of these lists; raises BadList for a field that is missing or unknown, or a name given twice."""
    found: dict[str, Mutant] = {}
    for path in paths:
        for name, fields in tomllib.loads(path.read_text(encoding="utf-8")).items():
            if name in found:
                raise BadList(f"{name}: two mistakes have this name")
            if missing := sorted(FIELDS - set(fields)):
                raise BadList(f"{name}: it has no {', '.join(missing)}")
            if unknown := sorted(set(fields) - FIELDS - {"survives"}):
                raise BadList(f"{name}: {', '.join(unknown)} is no field of a mistake")
            if not fields["tests"]:
                raise BadList(f"{name}: it names no test")
            found[name] = Mutant(name, **{**fields, "tests": tuple(fields["tests"])})
    return tuple(found.values())


def faults(mutant: Mutant, root: Path = ROOT) -> list[str]:
    """What is wrong with a mistake's description, in sentences: its text, its code, the tests that it names."""
    try:
        ast.parse(mutant.applied(root))
    except LookupError as reason:
        return [str(reason)]
    except SyntaxError as reason:
        return [f"{mutant.name}: what stands in {mutant.file} then is no Python: {reason}"]
    out = [f"{mutant.name}: its two texts are equal"] if mutant.old == mutant.new else []
    for test in mutant.tests:
        file, _, function = test.partition("::")
        path = root / file
        name = function.partition("[")[0]
        if not path.is_file() or (name and not re.search(rf"^def {name}\(", path.read_text(encoding="utf-8"), re.M)):
            out.append(f"{mutant.name}: there is no test {test}")
    return out


def wider_tests(mutant: Mutant, root: Path) -> tuple[str, ...]:
    """Every test file that imports the mistaken file's own package, but for the grid, which takes minutes."""
    module = mutant.file.removesuffix(".py").replace("/", ".")
    package = module.rpartition(".")[0] if module.count(".") > 1 else module
    package = package.removesuffix(".__init__")
    files = sorted((root / "tests").glob("test_*.py"))
    return tuple(
        f"tests/{path.name}"
        for path in files
        if path.name not in ("test_crosscheck.py", "test_mutants.py")
        and re.search(rf"\b{re.escape(package)}\b", path.read_text(encoding="utf-8"))
    )
