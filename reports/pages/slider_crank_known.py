"""Where a method is known to fall short on the slider-crank, each with its reason."""

from __future__ import annotations

EULER = "by design: a first-order method loses two turns of a free crank at the steps that are run here"

KNOWN: dict[tuple[str, str, str], str] = {
    ("free_slider_crank", "pymunk default", "outcome"): EULER,
    ("free_slider_crank", "lagrange euler projection", "outcome"): EULER,
    ("free_slider_crank", "mujoco extended", "order"): (
        "ours: the loop's spring is at least five steps slow, which is too slow for this motion at 1e-2 s; "
        "order 4 shows from 1e-3 s on"
    ),
}
