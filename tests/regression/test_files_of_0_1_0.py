"""What 0.1.0 wrote is read: a configuration of each of its cases, a log, a summary.

The files were written by the code of version 0.1.0; its compiled cores were today's.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.experiments.registry import run_of
from pliant.experiments.repeat import from_log
from pliant.experiments.runner import run_case
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Summary

HERE = Path(__file__).parent
CONFIGURATIONS = json.loads((HERE / "configurations_0_1_0.json").read_text())


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_a_configuration_of_every_case_is_read(name: str) -> None:
    for values in CONFIGURATIONS[name]:
        _, config = run_of(name, values)
        assert (config.case, config.controller, config.seed) == (values["case"], values["controller"], values["seed"])
    odd = {**CONFIGURATIONS[name][0], "gone_since": 1}
    with pytest.raises(ConfigError, match="unknown key 'gone_since'; valid:"):  # baseline
        run_of(name, odd)


def test_a_log_is_read_and_its_run_is_made_again_with_todays_program() -> None:
    log = Log.open(HERE / "haptic_0_1_0.mcap")
    assert (log.info.version, log.info.study, log.info.case) == ("0.1.0", "haptic", "floor-noise")
    assert np.isfinite(log["command/torque"]).all()
    study, config = from_log(HERE / "haptic_0_1_0.mcap")
    again = run_case(study, config)
    assert again.config == config
    assert config.duration == 0.02


def test_a_summary_is_read() -> None:
    (case,) = Summary.read(HERE / "summary_0_1_0.json").cases
    assert (case.case, case.controller, case.variant, case.name) == ("figure8-plain", "stack", "", "stack")
    assert case.metric("RMSE x").paper == 5.6
