"""The control loop that a page follows and steers."""
