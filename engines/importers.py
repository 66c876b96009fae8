"""Models of one's own as mechanisms: `from engines.importers import mujoco; mechanism = mujoco.read("model.xml")`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from engines.reading import Reading
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Importer:
    """What reads an engine's models; the engine itself is imported when one is read."""

    package: str

    def reading(self, model: Any, without: Sequence[str] = (), step: float | None = None) -> Reading:
        """A file, or an object of the engine's, as the mechanism, what was left out, and the model, ready to be run.

        `without`: kinds of elements to switch off; step [s]: the user's, instead of the model's own. Raises ValueError
        where a file is no model, and Unsupported, in a sentence that names the element, for what has no ideal
        counterpart.
        """
        reader = import_module(f"{self.package}.reading")
        if isinstance(model, str | Path):
            return reader.READER.read(str(model), Path.cwd(), without, "", step)
        return reader.read_object(model, without, step)

    def read(self, model: Any, without: Sequence[str] = ()) -> Mechanism:
        """The mechanism of a file or of an object; see `reading`."""
        return self.reading(model, without).mechanism


mujoco = Importer("engines.mujoco")  # MJCF, URDF, a mujoco.MjModel
pymunk = Importer("engines.pymunk")  # script.py[:NAME], a pymunk.Space


def read_object(model: Any, without: Sequence[str] = (), step: float | None = None) -> Reading:
    """An engine's own object, by its kind. Raises ValueError for anything else."""
    for importer in (mujoco, pymunk):
        if any(kind.__module__.split(".")[0] == importer.package.split(".")[1] for kind in type(model).__mro__):
            return importer.reading(model, without, step)
    raise ValueError(f"it is {type(model).__name__}; give a file, a mujoco.MjModel or a pymunk.Space")
