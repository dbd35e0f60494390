"""Every task of the catalogue and every variant of it runs, in a short form: its first periods."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import loop
from pliant.studies.task.study import study_of
from pliant.tasks.files import catalogue
from pliant.telemetry import Recorder

TICKS = 60


@pytest.mark.study
@pytest.mark.parametrize("name", catalogue())
def test_a_task_that_ships_begins_as_it_is_written(name: str) -> None:
    """Torques within the limits, at least one that is not zero, no failure."""
    study = study_of(name)
    for case in study.cases:
        wired = study.build(study.case(case))
        recorder = Recorder(None, channels=wired.channels)
        outcome = loop.run(
            wired.plant, wired.estimator, wired.source, wired.controller, range(TICKS), [recorder], wired.robot
        )
        assert outcome.failure is None, (case, outcome.failure)
        log = recorder.log()
        torque = log["command/torque"]
        assert torque.shape == (TICKS, wired.robot.n), case
        assert np.abs(torque).max() > 0.0, case
        assert np.all(np.abs(torque) <= wired.robot.torque_limit * (1.0 + 1e-9)), case
