"""The data of the suite: cells, tasks, outcomes, quantities and rows; how rows are measured; the parts of a page."""
