"""Haptic exploration with a leg: [HapFIC] Tiseo et al. 2021, regenerated beside the algorithm as printed."""

from pliant.studies.haptic.study import STUDY

__all__ = ["STUDY"]
