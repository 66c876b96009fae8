"""Faults of released engines, with scripts that show the faults and wrong formulas that reproduce them."""
