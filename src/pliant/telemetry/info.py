"""Identity of the run in a log."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import pliant
from pliant.errors import ConfigError


def _nothing() -> Mapping[str, Any]:
    return MappingProxyType({})


@dataclass(frozen=True, slots=True)
class RunInfo:
    """Identity of one run, written into its log. It holds nothing that differs between two runs of the same seed."""

    study: str = ""
    case: str = ""
    controller: str = ""
    robot: str = ""
    seed: int | None = None
    joints: tuple[str, ...] = ()
    """(n,) joint names; empty: they are numbered"""
    torque_limits: tuple[float, ...] = ()
    """(n,) N·m; empty: not known"""
    config: Mapping[str, Any] = field(default_factory=_nothing)
    """the whole typed configuration as plain data (`model_dump(mode="json")`)"""
    version: str = pliant.__version__

    def as_metadata(self) -> dict[str, str]:
        """The same as text, for an MCAP metadata record.

        Raises:
            ConfigError: the configuration is not plain data.
        """
        try:
            config = json.dumps(dict(self.config), ensure_ascii=False, sort_keys=True)
        except (TypeError, ValueError) as error:
            raise ConfigError(f"the configuration in a log must be plain data (JSON): {error}") from error
        return {
            "version": self.version,
            "study": self.study,
            "case": self.case,
            "controller": self.controller,
            "robot": self.robot,
            "seed": "" if self.seed is None else str(self.seed),
            "joints": json.dumps(list(self.joints), ensure_ascii=False),
            "torque_limits": json.dumps([float(limit) for limit in self.torque_limits]),
            "config": config,
        }

    @staticmethod
    def from_metadata(data: Mapping[str, str]) -> RunInfo:
        """Reads what `as_metadata` wrote; fields that are missing stay at their defaults."""
        seed = data.get("seed", "")
        return RunInfo(
            study=data.get("study", ""),
            case=data.get("case", ""),
            controller=data.get("controller", ""),
            robot=data.get("robot", ""),
            seed=int(seed) if seed else None,
            joints=tuple(json.loads(data.get("joints", "[]"))),
            torque_limits=tuple(json.loads(data.get("torque_limits", "[]"))),
            config=json.loads(data.get("config", "{}")),
            version=data.get("version", ""),
        )
