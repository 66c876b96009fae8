"""The assertions about every cell: theory's bounds, the judge, the committed rows, and known deviations."""
