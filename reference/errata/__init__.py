"""The chapter's printed slips, each as a computation."""

from reference.errata.catalogue import ERRATA
from reference.errata.erratum import Erratum, Values

__all__ = ["ERRATA", "Erratum", "Values"]
