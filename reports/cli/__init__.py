"""The command line. Every command has a file."""
