"""Every controller by name, and the loop that one of them and a task make together."""
