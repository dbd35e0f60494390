"""Messages between the control loop and the page."""
