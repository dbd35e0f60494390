"""The polishing study: press on a table and draw a circle under predictive control."""

from pliant.studies.polishing.study import STUDY

__all__ = ["STUDY"]
