"""The user's models as mechanisms: `from engines.importers import mujoco; mechanism = mujoco.read("model.xml")`."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from engines.reading import AS_IT_IS, Reading, ReadingTerms
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Importer:
    """Reads models of an engine; the first call imports the engine."""

    package: str

    def reading(self, model: Any, terms: ReadingTerms = AS_IT_IS) -> Reading:
        """Read a file, or an object of the engine.

        Raises ValueError if a file is no model, and Unsupported for an element without an ideal counterpart.
        """
        reader = import_module(f"{self.package}.reading")
        if isinstance(model, str | Path):
            return reader.READER.read(str(model), Path.cwd(), terms)
        return reader.read_object(model, terms)

    def read(self, model: Any, without: tuple[str, ...] = ()) -> Mechanism:
        return self.reading(model, ReadingTerms(without)).mechanism


mujoco = Importer("engines.mujoco")  # Reads MJCF, URDF or a mujoco.MjModel.
pymunk = Importer("engines.pymunk")  # Reads script.py[:NAME] or a pymunk.Space.


def read_object(model: Any, terms: ReadingTerms = AS_IT_IS) -> Reading:
    """Read an object of MuJoCo or pymunk; raises ValueError for another object."""
    for importer in (mujoco, pymunk):
        if any(kind.__module__.split(".")[0] == importer.package.split(".")[1] for kind in type(model).__mro__):
            return importer.reading(model, terms)
    raise ValueError(f"it is {type(model).__name__}; give a file, a mujoco.MjModel or a pymunk.Space")
