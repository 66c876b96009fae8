"""Builds a site by Sphinx with MyST and Furo. Markdown pages and docstrings become HTML with MathML and a search page.

Lessons and the page of stored rows have other templates.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields
from importlib.util import find_spec
from pathlib import Path
from pkgutil import walk_packages
from tempfile import TemporaryDirectory
from typing import Any

from reports.model.ending import BadInput
from reports.plots.theme import DARK, LIGHT, Theme
from reports.site.markdown import mathml

HERE = Path(__file__).parent
NEEDED = ("sphinx", "myst_parser", "furo", "latex2mathml")
LINE = re.compile(r' (?:d|x|y)="[^"]*"')
LONG = re.compile(r"-?\d+\.\d{2,}(?![\de])")
PACKAGES = ("reference", "engines")
MARKUP = re.compile(r"[*|]|(?<=\w)_(?!\w)")  # in docstrings outside of code
MODULE = "{name}\n{line}\n\n.. automodule:: {name}\n   :members:\n"
# Kinds of Sphinx warnings that are ignored, since docstrings are plain text and headings skip levels.
HARMLESS = ("docutils", "autodoc", "ref.", "toc.", "myst.header")

# Templates of the sidebar. "lessons" belongs to this package, the other templates to Furo.
SIDEBAR = ("scroll-start", "brand", "search", "lessons", "navigation", "scroll-end")

Extra = tuple[str, dict[str, Any], str]  # page, context, template


@dataclass(frozen=True)
class Documents:
    """Files of a Sphinx project. `sources` are documents, and `extra` are copied without a change."""

    sources: Mapping[str, bytes]
    extra: Mapping[str, bytes]
    context: Mapping[str, Any]  # Values for the templates.
    add_pages: Callable[[Any], Iterator[Extra]]  # Receives the Sphinx application after all documents are written.


def require_packages() -> None:
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise BadInput(f"the site needs packages that are not installed ({', '.join(missing)}): pip install '.[site]'")


def build_html(documents: Documents) -> tuple[dict[str, bytes], list[str]]:
    """The files of the site by name, and Sphinx's warnings. Raises BadInput if a package is missing."""
    require_packages()
    from sphinx.application import Sphinx  # pyright: ignore[reportMissingImports]
    from sphinx.util.docutils import docutils_namespace  # pyright: ignore[reportMissingImports]

    with TemporaryDirectory() as folder, docutils_namespace(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the theme and MyST use deprecated functions of Sphinx
        source, extra, out = (Path(folder) / name for name in ("source", "extra", "out"))
        write_files(source, documents.sources)
        write_files(extra, documents.extra)
        log = io.StringIO()
        settings = {**configure(extra), "html_context": dict(documents.context)}
        app = Sphinx(source, None, out, Path(folder) / "trees", "html", settings, status=None, warning=log)
        app.connect("html-collect-pages", documents.add_pages)
        app.build()
        names = (path for path in sorted(out.rglob("*")) if path.is_file() and path.name != ".buildinfo")
        built = {path.relative_to(out).as_posix(): path.read_bytes() for path in names}
    lines = [re.sub(r"\x1b\[[\d;]*m", "", line).replace(folder, "") for line in log.getvalue().splitlines()]
    ours = [line for line in lines if "WARNING" in line and not any(f"[{kind}" in line for kind in HARMLESS)]
    return built, [line for line in ours if "docstring of" not in line]


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def setup(app: Any) -> None:
    """Register the renderer of formulas and the escaping of docstrings. Sphinx calls this function of an extension."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    app.connect("autodoc-process-docstring", escape_docstring)


def configure(extra: Path) -> dict[str, Any]:
    return {
        "project": "crosscheck",
        "extensions": ["myst_parser", "sphinx.ext.autodoc", __name__],
        "html_theme": "furo",
        "html_title": "crosscheck",
        "html_theme_options": {
            "light_css_variables": furo_colours(LIGHT),
            "dark_css_variables": furo_colours(DARK),
            "footer_icons": [],
        },
        "html_math_renderer": "mathml",
        "html_sidebars": {"**": [f"sidebar/{part}.html" for part in SIDEBAR]},
        "html_favicon": str(HERE / "static" / "icon.svg"),
        "html_static_path": [str(HERE / "static"), str(HERE / "assets" / "tables.js")],
        "html_css_files": ["pages.css"],
        "html_js_files": [("tables.js", {"type": "module"})],
        "html_extra_path": [str(extra)],
        "html_copy_source": False,
        "html_show_sphinx": False,
        "html_show_copyright": False,
        "templates_path": [str(HERE / folder) for folder in ("templates", "assets", "static")],
        "default_role": "code",
        "smartquotes": False,  # headings are looked up by their text, and options have two hyphens
        "myst_enable_extensions": ["dollarmath"],
        "myst_dmath_allow_space": False,
        "myst_dmath_allow_digits": False,
        "myst_dmath_double_inline": True,
        "myst_heading_anchors": 6,
        "myst_fence_as_directive": ["math"],
        "autodoc_typehints": "signature",
        "autodoc_typehints_format": "short",
        "autodoc_preserve_defaults": True,
        "python_use_unqualified_type_names": True,
        "toc_object_entries": False,
    }


def furo_colours(theme: Theme) -> dict[str, str]:
    return {
        "color-brand-primary": theme.ink,
        "color-brand-content": theme.second,
        "color-brand-visited": theme.second,
        "color-background-primary": theme.paper,
        "color-foreground-primary": theme.ink,
    }


def colours() -> str:
    """CSS with a variable for each role of a colour. The reader's choice overrides the system's colour scheme."""
    light, dark = (" ".join(f"--{f.name}: {getattr(theme, f.name)};" for f in fields(Theme)) for theme in (LIGHT, DARK))
    return (
        f":root {{ color-scheme: light dark; {light} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root:not([data-scheme=light]) {{ {dark} }} }}\n"
        f":root[data-scheme=dark] {{ color-scheme: dark; {dark} }}\n"
        ":root[data-scheme=light] { color-scheme: light }\n"
    )


def escape_docstring(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Escape the characters of plain text that reStructuredText would read as references or emphasis."""
    parts = re.split(r"(`[^`]*`)", "\n".join(lines))
    escaped = [part if index % 2 else MARKUP.sub(r"\\\g<0>", part) for index, part in enumerate(parts)]
    lines[:] = "".join(escaped).split("\n")


def visit_inline(translator: Any, node: Any) -> None:
    from docutils.nodes import SkipNode  # pyright: ignore[reportMissingImports]

    translator.body.append(mathml(node.astext()))
    raise SkipNode


def visit_block(translator: Any, node: Any) -> None:
    from docutils.nodes import SkipNode  # pyright: ignore[reportMissingImports]

    translator.body.append(f'<div class="math">{mathml(" ".join(node.astext().split()), True)}</div>')
    raise SkipNode


def quote_section(app: Any, page: str, heading: str) -> str | None:
    """The HTML of a section of a results page, with links for a page in another folder, or None if the section is
    missing."""
    from docutils import nodes  # pyright: ignore[reportMissingImports]

    name = f"results/{page}"
    if name not in app.env.all_docs:
        return None
    tree = app.env.get_and_resolve_doctree(name, app.builder)
    app.builder.post_process_images(tree)
    app.builder.imgpath = "../_images"
    app.builder.dlpath = "../_downloads"
    for section in tree.findall(nodes.section):
        if section[0].astext() == heading:
            body = "".join(app.builder.render_partial(child)["fragment"] for child in section[1:])
            body = body.replace("<img ", '<img loading="lazy" ')  # the section is closed at first
            body = re.sub(r' id="[^"]*"', "", body).replace('href="#', f'href="{page}.html#')
            return re.sub(r'href="(?!https?:|mailto:|\.\./)([^"]+)"', r'href="../results/\1"', body)
    return None


def reference_sources() -> dict[str, bytes]:
    """A document for each module, and an index. Sphinx fills the documents from docstrings."""
    names = [*PACKAGES]
    for package in PACKAGES:
        modules = walk_packages([str(HERE.parents[1] / package)], f"{package}.")
        names += [module.name for module in modules if not module.name.endswith("__main__")]  # its import runs it
    texts = {f"reference/{name}.rst": MODULE.format(name=name, line="=" * len(name)) for name in names}
    texts["reference/index.rst"] = "Reference\n=========\n\n.. toctree::\n   :glob:\n   :maxdepth: 1\n\n   *\n"
    return {name: text.encode() for name, text in texts.items()}


def lighten(picture: str) -> str:
    """A smaller SVG, in which coordinates of lines are rounded to a tenth of a point."""
    return LINE.sub(lambda found: LONG.sub(lambda digits: f"{float(digits[0]):.1f}", found[0]), picture)
