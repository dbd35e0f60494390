"""Paths of a tool on a surface: patterns and files, laid on it, timed, and oriented by its normal."""
