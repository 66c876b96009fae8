"""The joints and force elements that an engine builds. Every other kind is refused by name, in one place."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from engines.tree import spanning_tree
from reference.forces import ForceElement
from reference.joints import Joint
from reference.mechanism import Mechanism


class Unsupported(Exception):
    """An engine cannot represent this mechanism; the message is one sentence that says why.

    The refusal of a kind of element has these fields, so that no code reads the sentence. They are "" in all others.

    engine: the engine's name
    kind: the name of the element's class
    lacking: the reason, without the element's name
    documentation: the address at which the engine's documentation says that it has no such element
    """

    def __init__(
        self, sentence: str, *, engine: str = "", kind: str = "", lacking: str = "", documentation: str = ""
    ) -> None:
        super().__init__(sentence)
        self.engine, self.kind, self.lacking, self.documentation = engine, kind, lacking, documentation


@dataclass(frozen=True)
class Lack:
    """Why an adapter does not build a kind of element.

    `documentation`: the address at which the engine's documentation says that it has no such element; "" if the engine
    may have one that the adapter does not use.
    """

    reason: str
    documentation: str = ""


@dataclass(frozen=True)
class Capability:
    """The exact classes of joints and force elements that an adapter builds.

    engine: its name in messages
    joints, forces: tables of constructions by class, or the classes; `forces` is None where our code evaluates every
        force element by its own law
    lacks: the reasons against classes that are not built
    lacks_in_loops: the reasons against joints that are built, but not where they close a loop of the tree

    A class in none of these is newer than the adapter, which would leave the element out of its model silently.
    """

    engine: str
    joints: Collection[type]
    forces: Collection[type] | None = None
    lacks: Mapping[type, Lack] = field(default_factory=dict)
    lacks_in_loops: Mapping[type, Lack] = field(default_factory=dict)

    @property
    def absent(self) -> frozenset[type]:
        """The classes that the engine, by its documentation, does not have."""
        return frozenset(kind for kind, lack in self.lacks.items() if lack.documentation)

    def require(self, mechanism: Mechanism) -> None:
        """Raises Unsupported for the first joint or force element that the engine does not build."""
        if refusal := self.refusal(mechanism):
            raise refusal

    def refusal(self, mechanism: Mechanism) -> Unsupported | None:
        """The refusal of the first joint or force element that the engine does not build; None if it builds all."""
        for joint in mechanism.joints:
            if type(joint) not in self.joints:
                return self._refused("joint", joint, self.lacks)
        for force in mechanism.forces:
            if self.forces is not None and type(force) not in self.forces:
                return self._refused("force", force, self.lacks)
        for joint in spanning_tree(mechanism).loops if self.lacks_in_loops else ():
            if type(joint) in self.lacks_in_loops:
                return self._refused("joint", joint, self.lacks_in_loops)
        return None

    def _refused(self, word: str, element: Joint | ForceElement, lacks: Mapping[type, Lack]) -> Unsupported:
        kind = type(element)
        lack = lacks.get(kind, Lack(f"{self.engine} has no construction for a {kind.__name__} here"))
        address = f" ({lack.documentation})" if lack.documentation else ""
        return Unsupported(
            f"{word} {element.name!r}: {lack.reason}{address}",
            engine=self.engine,
            kind=kind.__name__,
            lacking=lack.reason,
            documentation=lack.documentation,
        )
