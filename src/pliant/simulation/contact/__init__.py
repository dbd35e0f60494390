"""Contact laws and their parameters."""
