"""How cells and tasks are run and kept: supervised workers, the queue, clusters, the store."""
