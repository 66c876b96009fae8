"""Physics engines of the browser under test: planck, p2, Rapier and Jolt, run by Node."""

from engines.browser.engine import VARIANTS, install

__all__ = ["VARIANTS", "install"]
