"""Examples 05 and 06 do what their docstrings say."""

from __future__ import annotations

import re

import pytest

from benchmarks.examples_on_robots import EXAMPLES, loaded

PRESSING = "05_force_feedback_mpc"


@pytest.mark.parametrize("robot", ["iiwa14", "lwr4", "ur5e"])
def test_it_finds_the_table_and_presses(robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    loaded(PRESSING).main(robot)
    said = capsys.readouterr().out
    found = re.fullmatch(rf"{robot}: contact felt at ([\d.]+) s, asked 20 N, got ([\d.]+) ± ([\d.]+) N\n", said)
    assert found, said
    felt, mean, spread = (float(text) for text in found.groups())
    assert 0.4 < felt < 0.7  # 10 mm at 20 mm/s
    assert mean == pytest.approx(20.0, abs=0.5)
    assert spread < 1.5


def test_it_is_short() -> None:
    source = (EXAMPLES / f"{PRESSING}.py").read_text().split('"""', 2)[2]
    code = [line for line in source.splitlines() if line.strip() and not line.strip().startswith("#")]
    body = [line for line in code if not line.startswith(("import", "from"))]
    assert len(body) <= 40


def test_compensation_presses_where_the_stock_controller_does_not(capsys: pytest.CaptureFixture[str]) -> None:
    module = loaded("06_offset_free_mpc")
    means: dict[str, float] = {}
    for which in ("offset-free", "stock"):
        module.main(which)
        found = re.match(rf"{which}: asked 20 N, got ([\d.]+) ± ([\d.]+) N", capsys.readouterr().out)
        assert found
        means[which] = float(found[1])
    assert means["offset-free"] == pytest.approx(20.0, abs=0.2)
    assert abs(means["stock"] - 20.0) > 2.0  # baseline
