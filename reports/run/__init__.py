"""Functions that run cells and tasks in supervised workers or on a cluster, and store the results."""
