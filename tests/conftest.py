"""The grid's options and its table, from the package, so that an installed copy has them too."""

pytest_plugins = ["reports.pytest_plugin", "pytester"]
