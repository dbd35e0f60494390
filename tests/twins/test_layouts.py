"""What compiled cores and Python have to agree on without a type saying so: the order of numbers in a row."""

from __future__ import annotations

from dataclasses import fields

import pytest

from pliant import _contact, _impedance
from pliant.controllers import energy_ledger
from pliant.controllers.passivity_account import AccountSettings
from pliant.controllers.presets import STIFF_STACK
from pliant.controllers.registry import build_stack
from pliant.errors import ShapeError
from pliant.robot import Robot
from pliant.simulation.contact.material import ContactMaterial


def test_the_ledger_has_the_channels_of_the_core_in_their_order() -> None:
    assert energy_ledger.TOTALS == _impedance.ENERGIES
    assert tuple(name for name, _ in energy_ledger.AXIS_ROWS) == _impedance.AXIS_ROWS
    assert (*energy_ledger.TASK_SUMS, energy_ledger.MOMENT_SCALE) == _impedance.TASK_SUMS


def test_settings_and_materials_are_handed_over_in_the_order_of_the_core() -> None:
    """Numbers that differ from each other, so that two that changed places would be seen."""
    account = AccountSettings()
    row = dict(zip(_impedance.ACCOUNT, account.numbers(1e-3), strict=True))
    for name in _impedance.ACCOUNT[:-3]:
        assert row[name] == getattr(account, name), name
    assert (row["peak_keep"], row["surprise_keep"], row["forgiveness"]) == account.rates(1e-3)
    assert tuple(field.name for field in fields(ContactMaterial)) == _contact.MATERIAL
    numbers = [float(place) for place, _ in enumerate(_contact.MATERIAL)]
    assert ContactMaterial(*numbers).row().tolist() == numbers


def test_a_table_of_another_length_than_the_cores_output_is_refused(
    lwr4: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    build_stack(lwr4, STIFF_STACK, 1e-3)  # baseline: as they are, they fit
    monkeypatch.setattr(energy_ledger, "TASK_SUMS", energy_ledger.TASK_SUMS[:-1])
    with pytest.raises(ShapeError, match="channels of the ledger end at"):
        build_stack(lwr4, STIFF_STACK, 1e-3)
