"""The stack of passive task-space controllers: [Stack] Tiseo et al. 2020, regenerated and compared with baselines."""

from pliant.studies.stack.study import STUDY

__all__ = ["STUDY"]
