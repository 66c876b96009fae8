"""Exact motions kept beside a store, so that workers and later runs share them: some take seconds.

A file is named by all that its motion depends on, and so is never stale. The folder may be deleted at any time.
"""

from __future__ import annotations

import io
import os
import struct
import time
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np

from reference.kinds import Floats
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.model.digest import LONG, digest

FOLDER = "truths"
SHORT = 5e-3  # s: a motion that takes less is worked out again sooner than it is read
# What reading a damaged file raises; RuntimeError: parts that say that they are encrypted, or packed in another way.
DAMAGES = (
    *(OSError, ValueError, KeyError, EOFError, RuntimeError, MemoryError),
    *(struct.error, zlib.error, zipfile.BadZipFile),
)
PARTS = ("t", "pose", "twist", "reaction")


def kept_motion(scene: Scene, t: Floats, name: str, folder: Path | None) -> Trajectory:
    """The scene's motion at instants t (times,) [s], read from the folder or kept there; `name`: `Cell.truth`.

    A folder that is None or is not there is not used. Raises ValueError where the scene refuses.
    """
    if folder is None or not folder.is_dir():
        return scene.motion(t)
    file = folder / f"{digest(name.encode() + t.tobytes(), LONG)}.npz"
    with suppress(*DAMAGES), np.load(io.BytesIO(file.read_bytes())) as kept:
        return Trajectory(*(kept[part] for part in PARTS))
    begin = time.process_time()
    found = scene.motion(t)
    if time.process_time() - begin > SHORT:
        _keep(found, file)
    return found


def _keep(found: Trajectory, file: Path) -> None:
    """Write it whole or not at all; without it only time is lost."""
    half = file.with_name(f"{file.stem}.{os.getpid()}.half")
    with suppress(OSError):
        try:
            with half.open("wb") as stream:
                np.savez(stream, **{part: getattr(found, part) for part in PARTS})
            half.replace(file)
        finally:
            half.unlink(missing_ok=True)
