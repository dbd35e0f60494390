"""Contact tasks as data: surface, path, force, and the true world.

The code here depends on no controller, simulator or robot file format.
"""

from pliant.tasks.files import load_task
from pliant.tasks.task import Task

__all__ = ["Task", "load_task"]
