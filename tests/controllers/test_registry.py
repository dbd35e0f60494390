"""Controllers by name: every entry builds and runs, every field explains itself, bad numbers are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel, ValidationError

from pliant.controllers import presets
from pliant.controllers.config import FrameTaskConfig, StackConfig, TranslationConfig
from pliant.controllers.registry import CONTROLLERS, build_stack
from pliant.entries import Believed, find_entry, merged_entries
from pliant.errors import ConfigError
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference


@pytest.mark.parametrize("name", list(CONTROLLERS))
def test_every_entry_builds_and_runs(lwr4: Robot, name: str) -> None:
    entry = CONTROLLERS[name]
    controller = entry.build(lwr4, entry.default, 1e-3)
    zero = np.zeros(lwr4.n)
    estimate = Estimate(0.0, lwr4.home, zero, zero, zero)
    position, rotation = lwr4.placement(lwr4.home, "flange")
    elbow, _ = lwr4.placement(lwr4.home, "elbow")
    reference = Reference(0.0, (TaskReference("flange", position + 0.01, rotation), TaskReference("elbow", elbow)))
    command, _ = controller.step(estimate, reference, controller.init(estimate))
    assert np.isfinite(command.torque).all()
    assert np.all(np.abs(command.torque) <= lwr4.torque_limit)
    assert entry.advise(lwr4, entry.default, Believed(("flange",), 1e-3)) == ()
    assert entry.summary


def models(kind: type[BaseModel], seen: set[type[BaseModel]]) -> set[type[BaseModel]]:
    if kind in seen:
        return seen
    seen.add(kind)
    todo: list[Any] = [field.annotation for field in kind.model_fields.values()]
    while todo:
        annotation = todo.pop()
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            models(annotation, seen)
        todo += getattr(annotation, "__args__", ())
    return seen


@pytest.mark.parametrize("name", list(CONTROLLERS))
def test_every_field_has_a_description_and_every_number_a_unit(name: str) -> None:
    for kind in models(type(CONTROLLERS[name].default), set()):
        for key, field in kind.model_fields.items():
            assert field.description, f"{kind.__name__}.{key}"
            if "float" in str(field.annotation):
                assert isinstance(field.json_schema_extra, dict), f"{kind.__name__}.{key}"
                assert field.json_schema_extra["unit"], f"{kind.__name__}.{key}"


def test_configurations_survive_json() -> None:
    for entry in CONTROLLERS.values():
        assert type(entry.default).model_validate_json(entry.default.model_dump_json()) == entry.default


def test_unknown_names_and_double_names() -> None:
    with pytest.raises(ConfigError, match=r"no controller 'stak'.*did you mean 'stack'"):
        find_entry(CONTROLLERS, "stak")
    with pytest.raises(ConfigError, match="two controllers are called 'stack'"):
        merged_entries(CONTROLLERS, {"stack": CONTROLLERS["stack"]})
    assert merged_entries(CONTROLLERS, {}) == dict(CONTROLLERS)


def test_impossible_numbers_are_refused_with_a_sentence() -> None:
    with pytest.raises(ValidationError, match=r"frame 'flange'.*F_max = 10 < 5000 · 0\.02 = 100"):
        FrameTaskConfig(
            frame="flange",
            translation=TranslationConfig(stiffness=5000.0, force_max=10.0, range=0.05, linear_range=0.02),
        )
    with pytest.raises(ValidationError, match="finite number"):
        TranslationConfig(stiffness=float("nan"))
    with pytest.raises(ValidationError, match="Extra inputs"):
        TranslationConfig.model_validate({"stifness": 1.0})
    with pytest.raises(ValidationError, match="at least one task"):
        StackConfig(tasks={})


def test_axes_may_differ_and_a_task_can_be_dropped(lwr4: Robot) -> None:
    config = presets.SOFT_STACK.model_dump()
    config["tasks"]["elbow"] = None
    config["tasks"]["ee"]["translation"]["stiffness"] = (1000.0, 2000.0, 3000.0)
    stack = build_stack(lwr4, StackConfig.model_validate(config), 1e-3)
    assert [task.label for task in stack.tasks] == ["ee"]
    assert stack.tasks[0].tuning.stiffness[:3].tolist() == [1000.0, 2000.0, 3000.0]


def test_the_printed_parameters_are_the_papers() -> None:
    """[Stack] Table I, simulation: end effector, then elbow."""
    ee, elbow = (task.tuning for task in presets.TABLE_I_SIMULATION.frame_tasks())
    assert ee.stiffness.tolist() == [5000.0] * 3 + [100.0] * 3
    assert ee.force_max.tolist() == [150.0] * 3 + [100.0] * 3
    assert ee.range.tolist() == [0.006] * 3 + [0.63] * 3
    assert ee.linear_range is not None
    assert ee.linear_range.tolist() == [0.005] * 3 + [0.057] * 3
    assert elbow.force_max.tolist() == [50.0] * 3
