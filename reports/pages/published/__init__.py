"""Problems that others published, with answers that nobody here wrote."""
