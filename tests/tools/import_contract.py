"""The contract for import-linter that engines import only an allow-list of modules of the reference.

A list of forbidden modules would not cover new modules. An allow-list refuses every closed form, also if an adapter
imports it through another module. pyproject.toml names this class and has the list.
"""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatchcase
from typing import cast

from grimp import ImportGraph
from importlinter import Contract, ContractCheck, fields, output


class AllowListContract(Contract):
    """From the package `within`, `source` may import only the modules in `allowed`, also indirectly.

    An entry that ends in ".*" allows a package with all its modules.
    """

    type_name = "allow_list"

    source = fields.StringField()
    within = fields.StringField()
    allowed = fields.ListField(subfield=fields.StringField())

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        source, within = str(self.source), str(self.within)
        upstream = graph.find_upstream_modules(source, as_package=True)
        reached = {name for name in upstream if name.startswith(f"{within}.")}
        chains = {
            name: graph.find_shortest_chain(source, name, as_packages=True)
            for name in sorted(reached)
            if not self._is_allowed(name)
        }
        unused = [entry for entry in self._entries() if not any(self._matches(name, entry) for name in reached)]
        return ContractCheck(kept=not chains and not unused, metadata={"chains": chains, "unused": unused})

    def _is_allowed(self, name: str) -> bool:
        return any(self._matches(name, entry) for entry in self._entries())

    def _entries(self) -> list[str]:
        # An instance has a list in place of the field, which the field's type does not express.
        return [str(entry) for entry in cast(Iterable[object], self.allowed)]

    @staticmethod
    def _matches(name: str, entry: str) -> bool:
        return fnmatchcase(name, entry) or (entry.endswith(".*") and name == entry[:-2])

    def render_broken_contract(self, check: ContractCheck) -> None:
        for name, chain in check.metadata["chains"].items():
            output.print_error(f"{self.source} may not reach {name}: {' -> '.join(chain or ())}")
        for entry in check.metadata["unused"]:
            output.print_error(f"{entry} is allowed, and {self.source} does not import it: take it off the list")
