"""`pliant.run`, `pliant.compare` and their results."""
