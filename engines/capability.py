"""The joints and force elements that an engine builds. Every other kind is refused by name, in one place."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from engines.contract import Unsupported
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Capability:
    """The exact classes of joints and force elements that an adapter builds.

    engine: its name in messages
    joints, forces: tables of constructions by class, or the classes; `forces` is None where our code evaluates every
        force element by its own law
    lacks: for a class that is not built, the reason, with the address in the engine's documentation where it has none

    A class in none of these is newer than the adapter, which would leave the element out of its model silently.
    """

    engine: str
    joints: Collection[type]
    forces: Collection[type] | None = None
    lacks: Mapping[type, str] = field(default_factory=dict)

    def require(self, mechanism: Mechanism) -> None:
        """Raises Unsupported for the first joint or force element that the engine does not build."""
        for word, elements, built in (
            ("joint", mechanism.joints, self.joints),
            ("force", mechanism.forces, self.forces),
        ):
            for element in elements:
                kind = type(element)
                if built is not None and kind not in built:
                    reason = self.lacks.get(kind, f"{self.engine} has no construction for a {kind.__name__} here")
                    raise Unsupported(f"{word} {element.name!r}: {reason}")
