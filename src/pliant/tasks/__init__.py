"""What is asked of a robot, as data: where, along which path, with which force; and how the world differs from it.

No code here knows a controller, a simulator or a file format of robots.
"""

from pliant.tasks.files import load_task
from pliant.tasks.task import Task

__all__ = ["Task", "load_task"]
