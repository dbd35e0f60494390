"""Contact laws and their numbers."""
