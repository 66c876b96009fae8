"""What is measured: cells, tasks, outcomes, quantities, the row and how it is measured, and what a page is made of."""
