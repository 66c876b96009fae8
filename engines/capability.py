"""The joints and force elements that an engine builds. Every other kind is refused by name, in one place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from engines.contract import Unsupported
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Capability:
    """The exact classes of joints and of force elements that the adapter of `engine` builds.

    `forces` is None where our code evaluates force elements by their own law, whatever it is. `lacks`: the reason, with
    its source, for a class that the engine does not have. A class that is in none of them is newer than the adapter,
    which would leave the element out of its model without a warning.
    """

    engine: str
    joints: frozenset[type]
    forces: frozenset[type] | None = None
    lacks: Mapping[type, str] = field(default_factory=dict)

    def require(self, mechanism: Mechanism) -> None:
        """Raises Unsupported for the first joint or force element that the engine does not build."""
        for word, elements, builds in (
            ("joint", mechanism.joints, self.joints),
            ("force", mechanism.forces, self.forces),
        ):
            for element in elements:
                if builds is not None and type(element) not in builds:
                    kind = type(element)
                    reason = self.lacks.get(kind, f"{self.engine} has no construction for a {kind.__name__} here")
                    raise Unsupported(f"{word} {element.name!r}: {reason}")
