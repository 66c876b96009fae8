"""Comparison of released versions of engines; each has its own folder and runs in its own process."""
