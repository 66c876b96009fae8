"""Cells, tasks, outcomes, quantities, rows and their measurement, and the parts of a page."""
