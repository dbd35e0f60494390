"""The guard checks every signal between the parts of the loop; invalid signals reach neither controller nor robot."""

from pliant.guard.border import PATIENCE as PATIENCE
from pliant.guard.border import Guard as Guard
from pliant.guard.border import Watched as Watched
from pliant.guard.faults import Fault as Fault
