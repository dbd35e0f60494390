"""The processes and the web server of the page."""
