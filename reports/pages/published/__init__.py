"""Problems and results that others published."""
