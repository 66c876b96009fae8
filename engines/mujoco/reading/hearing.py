"""What MuJoCo warns of while a user's model is read."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def heard() -> Iterator[list[str]]:
    """MuJoCo's warnings, which it would otherwise write into a file in the user's folder."""
    said: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda words: said.append(" ".join(str(words).split())))
    try:
        yield said
    finally:
        mujoco.set_mju_user_warning(before)
