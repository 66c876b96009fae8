"""The grid's options and its table, from the package, so that an installed copy has them too."""

import signal

pytest_plugins = ["reports.gate.pytest_plugin", "pytester"]

# A shell that starts the tests in the background has them ignore Ctrl-C, and the programs that they start inherit it.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
