"""What is run and kept: cells, measuring, the supervised pool, the store, and the gates."""
