"""Joint configurations that go with the motion of a frame."""
