"""The reference of the site: what docstrings say of every class and function, by pdoc, in the site's frame."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from reports.plots.theme import DARK, LIGHT, Theme
from reports.run.files import temporary_folder
from reports.site.packages import NotFetched

MODULES = ("reference", "engines")
PATIENCE = 300  # s
STYLE = re.compile(rb"<style>(.*?)</style>", re.DOTALL)
# pdoc's names of colours, by ours.
ROLES = {
    **{"text": "ink", "muted": "quiet", "link": "second", "link-hover": "first", "code": "grid", "active": "middling"},
    **{"accent": "grid", "accent2": "quiet", "nav-hover": "grid", "name": "second", "def": "third"},
    "annotation": "third",
}


def reference_pages() -> dict[str, bytes]:
    """Files below reference/ of the site. Raises NotFetched where pdoc is not installed or fails."""
    if find_spec("pdoc") is None:
        raise NotFetched("pdoc is not installed: pip install '.[site]'")
    with temporary_folder() as folder:
        theme, output = folder / "theme", folder / "pages"
        theme.mkdir()
        (theme / "theme.css").write_text(_sheet(), encoding="utf-8")
        words = [sys.executable, "-m", "reports.site.reference", *MODULES, "--no-show-source", "--no-search"]
        words += ["--template-directory", str(theme), "--output-directory", str(output)]
        ended = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE)
        if ended.returncode:
            raise NotFetched(f"pdoc failed: {(ended.stderr.strip().splitlines() or ['no reason'])[-1]}")
        found = {path.relative_to(output).as_posix(): path for path in sorted(output.rglob("*")) if path.is_file()}
        pages = {f"reference/{name}": framed(path.read_bytes(), name) for name, path in found.items()}
        del pages["reference/index.html"]  # the site has its own
    return shared_styles(pages)


BAR = """<div class="site pdoc"><a href="{up}index.html"><strong>crosscheck</strong></a>
<a href="{up}lessons/four_bar.html">Lessons</a> <a href="{up}results/index.html">Results</a>
<a href="{up}howto/index.html">How to</a> <a href="{up}reference/index.html">Reference</a></div>"""


def framed(page: bytes, name: str) -> bytes:
    """A page of pdoc below the site's own bar; a browser asks for an icon unless the page has one."""
    bar = BAR.format(up="../" * (1 + name.count("/")))
    told = page.replace(b"</head>", b'<link rel="icon" href="data:,"></head>', 1)
    return told.replace(b"<body>", f"<body>{bar}".encode(), 1)


def shared_styles(pages: dict[str, bytes]) -> dict[str, bytes]:
    """The pages with the styles that stand in each of them, most of a small page, as files of their own."""
    names: dict[bytes, str] = {}
    out: dict[str, bytes] = {}
    for page, text in pages.items():
        up = "../" * (page.count("/") - 1)

        def linked(found: re.Match[bytes], up: str = up) -> bytes:
            name = names.setdefault(found[1], f"style-{len(names)}.css")
            return f'<link rel="stylesheet" href="{up}{name}">'.encode()

        out[page] = STYLE.sub(linked, text) if page.endswith(".html") else text
    return out | {f"reference/{name}": text for text, name in names.items()}


FRAME = """
.site { position: sticky; top: 0; z-index: 1000; display: flex; flex-wrap: wrap; gap: 1.2rem; padding: 0.6rem 1.6rem;
  background: var(--pdoc-background); border-bottom: 1px solid var(--pdoc-line); }
nav.pdoc { top: 2.8rem; } main.pdoc { padding-top: 1rem !important; }
.pdoc .attr { overflow-x: visible !important; } .pdoc .signature { overflow-wrap: anywhere; }
.pdoc .param { white-space: pre-wrap !important; } .pdoc .attribution { display: none !important; }
"""


def _sheet() -> str:
    light, dark = _colours(LIGHT) + FRAME, _colours(DARK)
    # What pdoc colours by itself is too dark on dark paper.
    dark += " .pdoc-code .nb, .pdoc-code .kt { color: var(--def) } .pdoc-code .o { color: var(--muted) }"
    return f"{light}\n@media (prefers-color-scheme: dark) {{ {dark} :root {{ color-scheme: dark }} }}\n"


def _colours(theme: Theme) -> str:
    named = " ".join(f"--{name}: {getattr(theme, role)};" for name, role in ROLES.items())
    return f":root {{ --pdoc-background: {theme.paper}; --pdoc-line: {theme.grid}; }} .pdoc {{ {named} }}"


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
