"""Faults of released engines, each with a script that shows it and the wrong formula that reproduces it."""
