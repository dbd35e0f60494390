"""The command line. Each command lives in a file of its own and is imported when it is called."""

from pliant.cli.app import main

__all__ = ["main"]
