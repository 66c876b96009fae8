"""Numerical methods that the references share: integrators with a stated error, elliptic functions, derivatives."""
