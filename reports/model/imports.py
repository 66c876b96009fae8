"""What a source file imports, and which of its strings look like files; kept beside a store, since parsing takes long.

What is kept goes by a digest of the file's bytes, and of this module's own: it is never stale. It may be deleted.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import re
from contextlib import suppress
from functools import cache
from importlib.util import resolve_name
from pathlib import Path

KEPT = "imports.json"
PATH = re.compile(r"[\w-][\w./-]{0,200}")
MOST = 5000  # files whose imports are kept: several times those of all that is ours

Named = tuple[frozenset[str], frozenset[str]]

_known: dict[str, Named] = {}


def named_in(text: bytes, package: str) -> Named:
    """(every module that a source's imports could mean, at any depth of nesting; its strings that look like files).

    `package` is what relative imports start from.
    """
    key = hashlib.sha256(package.encode() + b"\0" + text).hexdigest()[:32]
    if key not in _known:
        _known[key] = _read(text, package)
    return _known[key]


def _read(text: bytes, package: str) -> Named:
    names: set[str] = set()
    strings: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.Import(names=aliases):
                names.update(alias.name for alias in aliases)
            case ast.ImportFrom(module=module, names=aliases, level=level):
                origin = _absolute("." * level + (module or ""), package)
                names.add(origin)
                names.update(f"{origin}.{alias.name}" for alias in aliases)
            case (
                ast.Call(func=ast.Name(id="import_module" | "__import__"), args=[ast.Constant(value=str(name)), *_])
                | ast.Call(func=ast.Attribute(attr="import_module"), args=[ast.Constant(value=str(name)), *_])
            ):
                names.add(_absolute(name, package))
            case ast.Constant(value=str(word)) if PATH.fullmatch(word):
                strings.add(word)
    return frozenset(names), frozenset(strings)


def _absolute(name: str, package: str) -> str:
    """A module's whole name, of a relative import too; without its dots where they lead out of all packages."""
    try:
        return resolve_name(name, package)
    except ImportError:
        return name.lstrip(".")


@cache
def _reader() -> str:
    """A digest of this module: what another one read may be something else."""
    return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


def _digest(read: str) -> str:
    return hashlib.sha256(f"{_reader()}\0{read}".encode()).hexdigest()


def recall(folder: Path) -> int:
    """Take over what is kept in a folder; how many files' imports are known now. Nothing of what is damaged."""
    with suppress(OSError, ValueError, KeyError, TypeError, AttributeError):
        kept = json.loads((folder / KEPT).read_text(encoding="utf-8"))
        if kept["digest"] == _digest(kept["read"]):
            for key, (names, strings) in json.loads(kept["read"]).items():
                _known.setdefault(key, (frozenset(names), frozenset(strings)))
    return len(_known)


def keep(folder: Path) -> None:
    """Keep what is known in a folder, whole or not at all; without it only time is lost."""
    newest = dict(list(_known.items())[-MOST:])
    read = json.dumps({key: (sorted(names), sorted(strings)) for key, (names, strings) in newest.items()})
    half = folder / f"{KEPT}.{os.getpid()}.half"
    with suppress(OSError):
        try:
            half.write_text(json.dumps({"digest": _digest(read), "read": read}), encoding="utf-8")
            half.replace(folder / KEPT)
        finally:
            half.unlink(missing_ok=True)
