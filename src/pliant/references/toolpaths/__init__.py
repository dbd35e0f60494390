"""Tool paths on a surface, from patterns and files, with timing and orientation."""
