"""Running cells and tasks in supervised workers or on a cluster, and storing their results."""
