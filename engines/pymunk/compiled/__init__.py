"""The part of the adapter that is compiled where numba is installed: see `engines.lagrange.loading`."""
