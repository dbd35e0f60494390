"""A case with another controller, robot, tool, surface or path, as the page offers them: what belongs together is
changed together."""

from __future__ import annotations

from typing import Any, get_args

from pliant.configuration import merged
from pliant.experiments.base import CaseConfig
from pliant.experiments.registry import get_study
from pliant.robots import CATALOGUE, is_available
from pliant.robots.tool import ToolShape
from pliant.studies.task.config import TaskCase
from pliant.surfaces import HoleSurface
from pliant.tasks.files import CATALOGUE as TASKS
from pliant.tasks.surface_config import SurfaceConfig
from pliant.wiring.registry import find_controller

TOOLS: tuple[str, ...] = get_args(ToolShape)
SURFACES: tuple[str, ...] = get_args(SurfaceConfig.model_fields["shape"].annotation)
PATTERNS = ("raster", "spiral", "circle", "line", "square", "lemniscate", "hold")
EXAMPLE_MESH = TASKS / "parts" / "wave.ply"
_BY_POINTS = ("mesh", "hole", "edge")
"""surfaces that the explicit law of contact alone can do"""


def robots_for(config: CaseConfig) -> tuple[str, ...]:
    """Robots whose files are on this machine, the case's own among them."""
    names = tuple(name for name, entry in CATALOGUE.items() if is_available(entry))
    return names if config.robot in names else (*names, config.robot)


def with_controller(study: str, config: CaseConfig, name: str) -> CaseConfig:
    """Another controller; the parameters of one of another family are its own. Raises ConfigError."""
    changes: dict[str, Any] = {"controller": name}
    if "control" not in type(config).model_fields or config.control_by_name:
        return merged(config, changes)
    cases = get_study(study).cases
    plain = cases[config.case].config if config.case in cases else config
    if find_controller(config.controller).family != find_controller(name).family:
        plain = type(config).model_validate({**plain.model_dump(), "control": {}})
    return merged(plain, {**changes, "robot": config.robot})


def with_robot(config: CaseConfig, name: str) -> CaseConfig:
    """Another robot, with the joints locked that its entry locks; a start in joint angles belonged to the one before.

    Raises ConfigError.
    """
    start = {"start": None} if isinstance(config, TaskCase) else {}
    return merged(config, {"robot": name, "locked": None, **start})


def with_tool(config: TaskCase, shape: str) -> CaseConfig:
    """Another shape of the tool, as wide as the one before. Raises ConfigError."""
    edge = 2.0 * config.tool.radius
    changes: dict[str, Any] = {"tool": {"shape": shape, "edges": (edge, edge) if shape == "box" else None}}
    if shape != "sphere":
        changes["simulation"] = {"contact": "explicit"}
    return merged(config, changes)


def with_surface(config: TaskCase, shape: str) -> CaseConfig:
    """Another part, of the usual size, where the robot reaches it well; a mesh is the task's own, or an example's.

    Raises ConfigError.
    """
    radius = HoleSurface.radius if shape == "hole" else SurfaceConfig().radius
    file = (config.surface.file or str(EXAMPLE_MESH)) if shape == "mesh" else None
    part = {"shape": shape, "pose": None, "hollow": False, "radius": radius, "file": file}
    changes: dict[str, Any] = {"surface": part, "path": {"at": None}}
    if shape in _BY_POINTS:
        changes["simulation"] = {"contact": "explicit"}
    return merged(config, changes)


def with_path(config: TaskCase, pattern: str, size: tuple[float, float]) -> CaseConfig:
    """Another path on the surface. Args: size: m, along and across. Raises ConfigError."""
    file = config.path.file if pattern == "file" else None
    return merged(config, {"path": {"pattern": pattern, "size": size, "file": file}})
