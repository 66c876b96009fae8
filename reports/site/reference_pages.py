"""The reference of the site: pages that pdoc makes of the docstrings, in the colours of the site."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import find_spec

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
        words = [sys.executable, "-m", "pdoc", "--no-show-source", "--no-search", "--template-directory", str(theme)]
        words += ["--footer-text", "crosscheck", "--output-directory", str(output), *MODULES]
        ended = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE)
        if ended.returncode:
            raise NotFetched(f"pdoc failed: {(ended.stderr.strip().splitlines() or ['no reason'])[-1]}")
        found = {path.relative_to(output).as_posix(): path for path in sorted(output.rglob("*")) if path.is_file()}
        # A browser asks for an icon unless the page has one.
        icon = (b"</head>", b'<link rel="icon" href="data:,"></head>')
        pages = {f"reference/{name}": path.read_bytes().replace(*icon, 1) for name, path in found.items()}
    return shared_styles(pages)


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


def _sheet() -> str:
    light, dark = _colours(LIGHT), _colours(DARK)
    # What pdoc colours by itself is too dark on dark paper.
    dark += " .pdoc-code .nb, .pdoc-code .kt { color: var(--def) } .pdoc-code .o { color: var(--muted) }"
    return f"{light}\n@media (prefers-color-scheme: dark) {{ {dark} :root {{ color-scheme: dark }} }}\n"


def _colours(theme: Theme) -> str:
    named = " ".join(f"--{name}: {getattr(theme, role)};" for name, role in ROLES.items())
    return f":root {{ --pdoc-background: {theme.paper}; }} .pdoc {{ {named} }}"
