"""The joints and force elements that an engine builds. An engine refuses every other kind of element by name."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from engines.tree import spanning_tree
from reference.forces import ForceElement
from reference.joints import Joint
from reference.mechanism import Mechanism


class Unsupported(Exception):
    """An engine cannot represent this mechanism; the message is one sentence that says why.

    If an engine has no element of a kind, the exception has these fields. Otherwise the fields are "", but `lacking`
    may have a short form of the sentence.

    engine: the engine's name.
    kind: the name of the element's class.
    lacking: the reason, without the element's name.
    documentation: address of the engine's documentation which says that the engine has no such element.
    """

    def __init__(
        self, sentence: str, *, engine: str = "", kind: str = "", lacking: str = "", documentation: str = ""
    ) -> None:
        super().__init__(sentence)
        self.engine, self.kind, self.lacking, self.documentation = engine, kind, lacking, documentation


@dataclass(frozen=True)
class Lack:
    """Why an adapter does not build a kind of element.

    `documentation`: address of the engine's documentation which says that the engine has no such element. The address
    is "" if the engine may have such an element.
    """

    reason: str
    documentation: str = ""


@dataclass(frozen=True)
class Capability:
    """The exact classes of joints and force elements that an adapter builds.

    engine: the engine's name in messages.
    joints, forces: the classes, or tables of constructions by class; `forces` is None if our code evaluates all force
        elements.
    lacks: why the adapter does not build a class.
    lacks_in_loops: why the adapter does not build a class of joints that closes a loop of the tree.
    """

    engine: str
    joints: Collection[type]
    forces: Collection[type] | None = None
    lacks: Mapping[type, Lack] = field(default_factory=dict)
    lacks_in_loops: Mapping[type, Lack] = field(default_factory=dict)

    @property
    def absent(self) -> frozenset[type]:
        return frozenset(kind for kind, lack in self.lacks.items() if lack.documentation)

    def require(self, mechanism: Mechanism) -> None:
        if refusal := self.refusal(mechanism):
            raise refusal

    def refusal(self, mechanism: Mechanism) -> Unsupported | None:
        """The refusal of the first joint or force element that the engine does not build, or None."""
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
