"""Stale results: a byte or a version that a row depends on makes it run again, and nothing else does."""

from __future__ import annotations

import importlib
import importlib.metadata
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from engines.extrapolated import Extrapolated
from reports.grid import fingerprint as fingerprint_module
from reports.grid.fingerprint import fingerprint, modules_behind
from tests.toys import Toy

ROOT = Path(__file__).resolve().parent.parent


# Looking through all that is installed takes half a second, and is the same in every test.
DISTRIBUTIONS = cache(importlib.metadata.packages_distributions)


def forget() -> None:
    """Files and versions are read once a process; here they change. What a text says of imports does not."""
    for member in vars(fingerprint_module).values():
        if hasattr(member, "cache_clear"):
            member.cache_clear()


@pytest.fixture(autouse=True)
def _fresh(monkeypatch):
    monkeypatch.setattr(importlib.metadata, "packages_distributions", DISTRIBUTIONS)
    forget()
    yield
    forget()


# A package of somebody else: an engine in it, what it imports in every way there is, and what it does not import.
FILES = {
    "theirs/__init__.py": "",
    "theirs/plugin.py": """
from dataclasses import dataclass, field
from engines import Engine
from importlib import import_module
from pathlib import Path

from . import near
from .deep.inner import VALUE
import theirs.plain as other

LATE = import_module(".late", __package__)
LATER = __import__("theirs.later")
TABLE = Path(__file__).with_name("table.csv")
GRID = Path(__file__).parent / "data" / "grid.bin"

@dataclass(frozen=True)
class Base(Engine):
    variant: str = "default"
    name: str = "theirs"
    packages = ()
    order = step_cost = holder = print

@dataclass(frozen=True)
class Plugin(Base):
    settings: dict = field(default_factory=dict, hash=False)

    def build(self, mechanism, dt):
        raise NotImplementedError

def helper():
    from theirs import nested
""",
    "theirs/near.py": "from theirs import further",
    "theirs/further.py": "from .deep import inner",
    "theirs/deep/__init__.py": "from . import deepest",
    "theirs/deep/deepest.py": "",
    "theirs/deep/inner.py": "VALUE = 1",
    "theirs/plain.py": "import theirs.furthest",
    "theirs/furthest.py": "",
    "theirs/late.py": "",
    "theirs/later.py": "",
    "theirs/nested.py": "",
    "theirs/table.csv": "1,2",
    "theirs/data/grid.bin": "1",
    "theirs/unrelated.py": "from theirs import plugin",
    "theirs/notes.txt": "a file that no module names",
    "theirs/data/other.bin": "1",
    "theirs_too.py": "import theirs",
    # An engine that holds others, in every way that a field can; it imports none of them.
    "around.py": """
from dataclasses import dataclass
from typing import Any

@dataclass(frozen=True)
class Around:
    held: Any
    variant: str = "around"
    name: str = "around"
""",
}
UNRELATED = ("theirs/unrelated.py", "theirs/notes.txt", "theirs/data/other.bin", "theirs_too.py", "around.py")


@pytest.fixture
def theirs(tmp_path, monkeypatch):
    """Their package written down and on the path; gives (folder, an engine of theirs)."""
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    known = set(sys.modules)
    yield tmp_path, importlib.import_module("theirs.plugin").Plugin()
    for name in set(sys.modules) - known:
        del sys.modules[name]


def changed(path: Path, *values: Any) -> bool:
    """Whether one byte more in a file changes the fingerprint of these values."""
    before = fingerprint(*values)
    text = path.read_bytes()
    path.write_bytes(text + b"\n")
    forget()
    after = fingerprint(*values)
    path.write_bytes(text)
    forget()
    assert fingerprint(*values) == before  # it is the bytes, not when they were written
    return before != after


@pytest.mark.parametrize("name", [name for name in FILES if name not in UNRELATED])
def test_a_byte_changed_in_a_file_that_an_engine_needs_makes_its_rows_stale(theirs, name):
    folder, engine = theirs
    assert changed(folder / name, engine)


@pytest.mark.parametrize("name", UNRELATED)
def test_a_byte_changed_in_a_file_that_no_module_of_it_names_does_not(theirs, name):
    folder, engine = theirs
    assert not changed(folder / name, engine)


def test_bytes_count_and_not_names_alone_and_names_and_not_bytes_alone(theirs):
    folder, engine = theirs
    before = fingerprint(engine)
    (folder / "theirs/furthest.py").rename(folder / "theirs/renamed.py")
    (folder / "theirs/plain.py").write_text("import theirs.renamed", encoding="utf-8")
    forget()
    renamed = fingerprint(engine)
    assert renamed != before
    # The same two texts, exchanged between two files.
    (folder / "theirs/late.py").write_text("A = 1", encoding="utf-8")
    forget()
    one = fingerprint(engine)
    (folder / "theirs/late.py").write_text("", encoding="utf-8")
    (folder / "theirs/later.py").write_text("A = 1", encoding="utf-8")
    forget()
    assert len({before, renamed, one, fingerprint(engine)}) == 4


def test_the_same_bytes_under_another_name_are_another_source(theirs):
    folder, engine = theirs
    text = "try:\n    import theirs.quick_a\nexcept ImportError:\n    import theirs.quick_b\n"
    (folder / "theirs/furthest.py").write_text(text, encoding="utf-8")
    (folder / "theirs/quick_a.py").write_text("VALUE = 1", encoding="utf-8")
    forget()
    before = fingerprint(engine)
    (folder / "theirs/quick_a.py").rename(folder / "theirs/quick_b.py")
    forget()
    assert fingerprint(engine) != before


def test_a_checkout_in_another_folder_has_the_same_fingerprint(theirs, tmp_path, monkeypatch):
    folder, engine = theirs
    before = fingerprint(engine)
    other = tmp_path / "elsewhere"
    other.mkdir()
    (folder / "theirs").rename(other / "theirs")
    for name, module in sys.modules.items():
        if name.split(".")[0] == "theirs" and module.__file__:
            monkeypatch.setattr(module, "__file__", module.__file__.replace(str(folder), str(other)))
    monkeypatch.syspath_prepend(other)
    forget()
    assert fingerprint(engine) == before


def test_what_an_engine_holds_counts_wherever_it_holds_it(theirs):
    folder, inner = theirs
    path = folder / "theirs/furthest.py"
    Around = importlib.import_module("around").Around
    kind = type(inner)
    for held in (inner, (1, [inner]), {"inner": inner}, {kind: 1}, frozenset({inner}), kind, Around(inner)):
        assert changed(path, Around(held)), held
    module = sys.modules["theirs.plugin"]
    assert changed(path, Around(module.helper))
    assert changed(path, replace(inner, settings={"base": Toy(), "other": inner}))
    assert not changed(path, Around("theirs"))
    assert changed(path, Extrapolated(inner, "extended", (1, 2), (2,)))


def test_the_classes_that_an_engine_derives_from_count(theirs):
    folder, _ = theirs
    (folder / "derived.py").write_text(
        "from dataclasses import dataclass\nimport theirs.plugin as p\n\n\ndef derive():\n    return p.Plugin", "utf-8"
    )
    derived = type("Derived", (importlib.import_module("derived").derive(),), {"__module__": "derived"})()
    assert {"derived", "theirs.plugin"} <= modules_behind(derived)
    assert {"derived", "theirs.plugin"} <= modules_behind((type(derived),))


def needed(*values: Any) -> set[str]:
    """The files of ours, without their ending, that the digest of these values reads."""
    read = []
    with pytest.MonkeyPatch.context() as patch:
        original = Path.read_bytes
        patch.setattr(Path, "read_bytes", lambda path: read.append(path) or original(path))
        forget()
        fingerprint(*values)
    return {path.relative_to(ROOT).with_suffix("").as_posix() for path in read if path.is_relative_to(ROOT)}
