"""pliant: contact control for torque-controlled robots.

    result = pliant.run("haptic", controller="haptic", duration=1.5)
    print(result.table())

The names below are the public interface; docs/python.md explains each with an example that runs. They are imported on
first use. Beside them, `pliant.controllers()` and `pliant.robots()` list what can be chosen by name, and
`pliant.errors` holds every error. Everything else in the package may change between two versions.
"""

# pyright: reportUnsupportedDunderAll=false
import importlib
from typing import Any

from pliant.lazy import first_use

__version__ = "0.2.0.dev0"

_WHERE = {
    "run": "pliant.face.run",
    "compare": "pliant.face.run",
    "rollout": "pliant.face.rollout",
    "Rollout": "pliant.face.rollout",
    "RunResult": "pliant.face.result",
    "Comparison": "pliant.face.result",
    "Log": "pliant.telemetry.log",
    "Metric": "pliant.telemetry.summary",
    "Task": "pliant.tasks",
    "load_task": "pliant.tasks",
    "Robot": "pliant.robot",
    "Tool": "pliant.robot",
    "MujocoPlant": "pliant.simulation",
    "ImperfectPlant": "pliant.simulation",
    "Imperfections": "pliant.simulation",
    "ForceSensor": "pliant.simulation",
    "Push": "pliant.simulation",
    "Scene": "pliant.simulation",
    "Surface": "pliant.simulation",
    "Plane": "pliant.simulation",
    "Box": "pliant.simulation",
    "Ball": "pliant.simulation",
    "floor": "pliant.simulation",
    "table": "pliant.simulation",
    "wall": "pliant.simulation",
    "WrenchEstimator": "pliant.estimation",
    "JointStateFilter": "pliant.estimation",
    "MomentumObserver": "pliant.estimation",
    "EnvironmentEstimator": "pliant.estimation",
    "Controller": "pliant.interfaces",
    "Needs": "pliant.interfaces",
    "find_controller": "pliant.wiring.registry",
    "PliantError": "pliant.errors",
    "ConfigError": "pliant.errors",
    "RobotError": "pliant.errors",
    "RunFailedError": "pliant.errors",
}
"""name → module that has it"""
_PACKAGES = ("controllers", "errors", "robots")

__all__ = [
    "Ball",
    "Box",
    "Comparison",
    "ConfigError",
    "Controller",
    "EnvironmentEstimator",
    "ForceSensor",
    "ImperfectPlant",
    "Imperfections",
    "JointStateFilter",
    "Log",
    "Metric",
    "MomentumObserver",
    "MujocoPlant",
    "Needs",
    "Plane",
    "PliantError",
    "Push",
    "Robot",
    "RobotError",
    "Rollout",
    "RunFailedError",
    "RunResult",
    "Scene",
    "Surface",
    "Task",
    "Tool",
    "WrenchEstimator",
    "__version__",
    "compare",
    "controllers",
    "errors",
    "find_controller",
    "floor",
    "load_task",
    "robots",
    "rollout",
    "run",
    "table",
    "wall",
]


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return importlib.import_module(f"pliant.{name}")
    return first_use(__name__, _WHERE, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
