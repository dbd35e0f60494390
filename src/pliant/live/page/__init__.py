"""What the browser shows, and the controls on it."""
