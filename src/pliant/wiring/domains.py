"""Conditions under which each controller was found to be steady with suggested gains, as `benchmarks/domains.py` wrote
it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_name("domains.json")
HOLDS = "holds"


@dataclass(frozen=True)
class DomainRun:
    """One run: 20 N on a flat surface, 0.1 m at 0.05 m/s, drives of 30 Hz, friction 0.25."""

    controller: str
    robot: str
    stiffness: float
    """of the surface, N/m"""
    delay: float
    """s from a reading to the effect of its command"""
    verdict: str
    """`holds`, or what kept it from that"""
    place: str = ""
    """what stood otherwise than a level surface before an arm"""


@cache
def trials() -> tuple[DomainRun, ...]:
    """All runs."""
    return tuple(DomainRun(**one) for one in json.loads(FILE.read_text(encoding="utf-8")))
