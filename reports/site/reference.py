"""The reference of the site: what docstrings say of every class and function, by pdoc, in the site's frame."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from reports.model.fingerprint import ROOT
from reports.run.files import temporary_folder
from reports.run.installed import environment
from reports.site.packages import NotFetched, printed

MODULES = ("reference", "engines")
TEMPLATES = Path(__file__).parent / "templates" / "pdoc"
PATIENCE = 300  # s


def reference_pages() -> dict[str, bytes]:
    """Files below reference/ of the site. Raises NotFetched where pdoc is not installed or fails."""
    if find_spec("pdoc") is None:
        raise NotFetched("pdoc is not installed: pip install '.[site]'")
    with temporary_folder() as folder:
        words = [sys.executable, "-m", "reports.site.reference", *MODULES, "--no-show-source", "--no-search"]
        words += ["--template-directory", str(TEMPLATES), "--output-directory", str(folder)]
        printed(words, "pdoc failed", PATIENCE, env=environment(ROOT))
        found = (path for path in sorted(folder.rglob("*")) if path.is_file())
        pages = {f"reference/{path.relative_to(folder).as_posix()}": path.read_bytes() for path in found}
    return pages | {"reference/pdoc.css": pages.pop("reference/index.html")}


class AsWritten(str):
    """An annotation that is told as its source has it."""

    def __repr__(self) -> str:
        return str(self)


def main(words: list[str]) -> None:
    """Run pdoc; types are told as they are written, since what they stand for may be half a page."""

    def kept(told: Any, *_: Any, **__: Any) -> Any:
        return AsWritten(told) if isinstance(told, str) else told

    for name in ("pdoc.doc", "pdoc.doc_types"):
        import_module(name).safe_eval_type = kept  # type: ignore[attr-defined]
    import_module("pdoc.__main__").cli(words)


if __name__ == "__main__":
    main(sys.argv[1:])
