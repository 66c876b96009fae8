"""Cells and tasks are run by supervised workers or a cluster, and stored."""
