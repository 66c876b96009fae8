"""A static site of the results: lessons with moving pictures, tables, charts, and engines that run in the page."""
