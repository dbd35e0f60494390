"""The imperfect robot, link by link, in Python."""
