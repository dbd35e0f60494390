"""The compiled exploration of a frame against the same in Python, tick by tick and bit for bit."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np
import pytest

from pliant._references import FrameCore, pressed
from pliant.axis_modes import AxisModes
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.frame import ExploredFrame, FrameRules
from pliant.references.exploration.rules import AxisPhase
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array, exp3
from tests.references.explored import PERIOD, tuned
from tests.twins.exploration.frame import FrameTwin

LIMITED = AxisModes(("force", "motion", "force", "free", "motion", "force"), speed=0.03, deviation=0.01)
TURNED = exp3(np.array([0.2, -0.1, 0.4]))


@dataclass
class Ticks:
    """What a frame is told in 1500 ticks: forces of a surface that its offsets press into, with jumps of everything."""

    config: ExplorationConfig = field(default_factory=ExplorationConfig)
    axes: int = 3
    modes: AxisModes | None = None
    rotation: Array | None = None
    seed: int = 0
    softness: float = 1.0
    found: list[tuple[Array, Array]] = field(default_factory=list)
    phases: set[float] = field(default_factory=set)

    def play(self) -> None:
        core, twin, random = ExploredFrame(), FrameTwin(), np.random.default_rng(self.seed)
        rules, other = FrameRules(self.config), FrameRules(self.config.model_copy(update={"reset": False}))
        tuning, stiff = tuned(self.axes), 2e4 * self.softness
        for tick in range(1500):
            if tick % 300 == 0:
                tuning = tuned(self.axes, random.uniform(0.004, 0.03))
                desired = random.uniform(-40.0, 60.0, 6) * (random.random(6) < 0.6)
                place, velocity = random.uniform(-0.004, 0.004, 3), random.normal(size=6) * 0.05
                desired[3:] *= 0.1
            if tick % 500 == 450:
                rules, other = other, rules
            modes = None if tick // 400 == 2 else self.modes
            there = np.array([*place, 0.0, 0.0, 0.0]) + twin.offsets
            measured = -stiff * there * np.array([1, 1, 1, 1e-3, 1e-3, 1e-3]) + random.normal(size=6) * 0.3
            if tick % 97 == 50:
                measured[2] = np.nan
            self.tick(core, twin, rules, tuning, desired, measured, place, velocity, tick, modes)

    def tick(self, core, twin, rules, tuning, desired, measured, place, velocity, tick, modes) -> None:
        core.prepare(rules, tuning, modes, self.rotation)
        time = tick * PERIOD
        ours, _, turns, clamped = core.core.step(desired, measured, place, velocity, time, PERIOD)
        felt = measured.tolist() if np.isfinite(measured).all() else None
        told = desired.tolist(), felt, place.tolist(), velocity.tolist()
        twin.step(rules, tuning, *told, time, PERIOD, modes, self.rotation)
        self.found.append((ours, reported(twin)))
        assert core.core.offsets == twin.offsets
        assert turns == any(twin.offsets[3:])
        assert clamped == any(axis.clamped for axis in twin.axes)
        self.phases |= set(ours[self.axes : 2 * self.axes].tolist())


def reported(twin: FrameTwin) -> Array:
    count = len(twin.limits)
    axes = twin.axes[:count]
    names = ("phase", "stiffness", "reachable", "unreachable", "clamped")
    return np.array([*twin.offsets[:count], *[getattr(axis, name) for name in names for axis in axes]], dtype=float)


CASES = {
    "axes": Ticks(),
    "soft": Ticks(softness=0.05, seed=1),
    "seeking": Ticks(ExplorationConfig(seek=True), seed=2),
    "six axes": Ticks(axes=6, seed=3),
    "modes": Ticks(axes=6, modes=LIMITED, seed=4),
    "turned": Ticks(axes=6, modes=dataclasses.replace(LIMITED, rotation=TURNED), rotation=TURNED, seed=5),
    "printed": Ticks(ExplorationConfig(mode="paper"), seed=6),
    "normal": Ticks(ExplorationConfig(direction="normal"), seed=7),
    "normal of six": Ticks(ExplorationConfig(direction="normal"), axes=6, seed=8),
}


@pytest.mark.parametrize("name", CASES)
def test_it_is_its_twin(name: str) -> None:
    ticks = dataclasses.replace(CASES[name], found=[], phases=set())
    ticks.play()
    ours, theirs = (np.array(column) for column in zip(*ticks.found, strict=True))
    np.testing.assert_array_equal(ours, theirs)
    if name in ("axes", "soft", "six axes", "modes"):
        assert ticks.phases == {float(one) for one in AxisPhase}, "each phase was met"
    far = dataclasses.replace(
        ticks, found=[], config=ticks.config.model_copy(update={"resolution": 0.02, "gain": 44.0})
    )
    far.play()
    assert not np.array_equal(ours, np.array([one for one, _ in far.found])), "other parameters move it otherwise"


def test_a_wrench_is_looked_at() -> None:
    place = np.zeros(3)
    assert [pressed(wrench, place) for wrench in (np.zeros(6), np.eye(6)[5], np.full(6, np.nan))] == [0, 1, -1]
    assert pressed(np.zeros(6), np.array([0.0, np.inf, 0.0])) == -1


def test_parts_that_do_not_fit_are_refused() -> None:
    core, six = FrameCore(), np.zeros(6)
    with pytest.raises(ValueError, match="bounds of its axes first"):
        core.step(six, six, six[:3], six, 0.0, PERIOD)
    with pytest.raises(ValueError, match="three axes or six"):
        core.limit([(1.0, 1.0, 1.0)] * 4)
    with pytest.raises(ValueError, match="16 numbers"):
        core.rule([0.0] * 15, [0.0] * 16, [False] * 6, False, False, 0.0, [0.0] * 4)
    core.limit([(1.0, 1.0, 1.0)] * 3)
    core.step(six, None, six[:3], six, 0.0, PERIOD)  # control
    for desired, measured in ((six[:5], six), (six, six[:5])):
        with pytest.raises(ValueError, match="fewer numbers"):
            core.step(desired, measured, six[:3], six, 0.0, PERIOD)


def test_rules_are_told_in_their_order() -> None:
    rules = FrameRules(ExplorationConfig()).linear
    assert rules.numbers == tuple(float(getattr(rules, one.name)) for one in dataclasses.fields(rules))
    assert isinstance(tuned(), ImpedanceTuning)
