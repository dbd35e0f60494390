"""Joint configurations for the motion of a frame."""
