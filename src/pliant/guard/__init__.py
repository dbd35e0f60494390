"""The guard at the border of every part of the loop: what is not a sound signal reaches no law and no robot."""

from pliant.guard.border import PATIENCE as PATIENCE
from pliant.guard.border import Guard as Guard
from pliant.guard.border import Watched as Watched
from pliant.guard.faults import Fault as Fault
