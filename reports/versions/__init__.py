"""Comparison of released versions of engines. Every version has a separate folder and runs in a separate process."""
