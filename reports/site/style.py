"""The colours of the site, those of the charts: one set for light paper and one for dark."""

from __future__ import annotations

from dataclasses import fields

from reports.plots.theme import DARK, LIGHT, Theme


def colours() -> str:
    """CSS that sets a variable a role; the reader's own choice stands above the system's."""
    light, dark = _variables(LIGHT), _variables(DARK)
    return (
        f":root {{ color-scheme: light dark; {light} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root:not([data-scheme=light]) {{ {dark} }} }}\n"
        f":root[data-scheme=dark] {{ color-scheme: dark; {dark} }}\n"
        ":root[data-scheme=light] { color-scheme: light }\n"
    )


def _variables(theme: Theme) -> str:
    return " ".join(f"--{field.name}: {getattr(theme, field.name)};" for field in fields(Theme))
