"""Exact multipliers in machine code, by numba; imported by `engines.lagrange.loading` alone, and only to step."""
