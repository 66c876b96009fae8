"""Changes in engines that are known by name, with where they are told. No page looks for a step here: rows show it."""

from __future__ import annotations

from dataclasses import dataclass

from reports.run.installed import numbers

CHANGELOG = "https://mujoco.readthedocs.io/en/stable/changelog.html"


@dataclass(frozen=True)
class Change:
    """`version` is the first release with it; `worse`: whether errors became larger by it."""

    engine: str
    version: str
    what: str  # a clause: "loops got their velocity term"
    source: str  # an address
    worse: bool = False


CHANGES = (
    Change(
        "mujoco",
        "3.7.0",
        "`connect` and `weld` got the velocity term of their acceleration, -(dJ/dt) v, which they had lacked",
        CHANGELOG,
    ),
    Change(
        "mujoco",
        "4.0.0",
        "the sparse Cholesky factor of Newton's Hessian became wrong for some trees that branch and close across",
        "https://github.com/google-deepmind/mujoco/issues/3767",
        worse=True,
    ),
    Change(
        "mujoco",
        "4.0.1",
        "that factor was mended",
        "https://github.com/google-deepmind/mujoco/issues/3767",
    ),
)


def named(engine: str, before: str, after: str, worse: bool) -> tuple[Change, ...]:
    """The changes for the worse, or for the better, that are known of the releases after the one up to the other."""
    return tuple(
        each
        for each in CHANGES
        if (each.engine, each.worse) == (engine, worse) and numbers(before) < numbers(each.version) <= numbers(after)
    )
