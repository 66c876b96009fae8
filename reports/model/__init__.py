"""The data of the suite, such as cells, tasks, outcomes, rows and pages, and the measurement of rows."""
