"""The name under which installed packages offer controllers; apart, so that it is read without a controller's
libraries."""

GROUP = "pliant.controllers"
"""entry-point group"""
