"""What `__init__.py` offers, for type checkers; a test compares the two. Packages and modules are found as such."""

from pliant.errors import ConfigError as ConfigError
from pliant.errors import PliantError as PliantError
from pliant.errors import RobotError as RobotError
from pliant.errors import RunFailedError as RunFailedError
from pliant.estimation import EnvironmentEstimator as EnvironmentEstimator
from pliant.estimation import JointStateFilter as JointStateFilter
from pliant.estimation import MomentumObserver as MomentumObserver
from pliant.estimation import WrenchEstimator as WrenchEstimator
from pliant.face.result import Comparison as Comparison
from pliant.face.result import RunResult as RunResult
from pliant.face.rollout import Rollout as Rollout
from pliant.face.rollout import rollout as rollout
from pliant.face.run import compare as compare
from pliant.face.run import run as run
from pliant.interfaces import Controller as Controller
from pliant.interfaces import Needs as Needs
from pliant.robot import Robot as Robot
from pliant.robot import Tool as Tool
from pliant.simulation import Ball as Ball
from pliant.simulation import Box as Box
from pliant.simulation import ForceSensor as ForceSensor
from pliant.simulation import Imperfections as Imperfections
from pliant.simulation import ImperfectPlant as ImperfectPlant
from pliant.simulation import MujocoPlant as MujocoPlant
from pliant.simulation import Plane as Plane
from pliant.simulation import Push as Push
from pliant.simulation import Scene as Scene
from pliant.simulation import Surface as Surface
from pliant.simulation import floor as floor
from pliant.simulation import table as table
from pliant.simulation import wall as wall
from pliant.tasks import Task as Task
from pliant.tasks import load_task as load_task
from pliant.telemetry.log import Log as Log
from pliant.telemetry.summary import Metric as Metric
from pliant.wiring.registry import find_controller as find_controller

__version__: str
