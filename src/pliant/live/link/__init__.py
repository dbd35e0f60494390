"""What loop and page say to each other."""
