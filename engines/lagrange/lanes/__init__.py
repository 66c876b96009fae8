"""Machine code that steps several mechanisms in each vector register, for `engines.lagrange.batch`."""
