"""The energy ledger of a stack of impedances: its channels and their meaning.

Every tick adds, for each axis, the work h·Δx̃ of the force that was held during the last period. From it follow

    supplied   by the moving references     Σ h·Δx_d     (for a rotation Σ (J_l⁻ᵀ h)·Δθ_d)
    delivered  to the robot                 supplied − Σ h·Δx̃
    tuning     by changes of the parameters storage after minus before, at the same error
    stored     in the springs               Σ E(x̃)
    dissipated by the attractors            Σ (∫h dx̃ + tuning − (E(x̃) − E(x̃_0)))
    clamped    held back by torque limits   Σ (wanted − sent)·Δq
    spendable  by the accounts, next period Σ of what each axis may spend; no energy of the balance below

so that supplied + tuning = delivered + dissipated + (stored − stored at the start) at every tick. What an axis
dissipates is its storage margin: a passive law keeps it at or above zero, except for the leakage of sampling.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pliant.errors import ShapeError
from pliant.flat_channels import FlatLayout

TOTALS = ("stored", "supplied", "delivered", "dissipated", "tuning", "clamped", "spendable")
"""channels `energy/…` of the whole stack, J"""
AXIS_ROWS = (
    ("force", "N, N·m"),  # h, the force conjugate to the error
    ("error", "m, rad"),  # target minus actual
    ("rate", "m/s, rad/s"),  # filtered rate of the error
    ("rate_threshold", "m/s, rad/s"),  # ε of the phase logic
    ("phase", "1"),  # 0 diverging, 1 converging
    ("turning_point", "m, rad"),  # x_m
    ("storage_margin", "J"),  # ∫h dx̃ + tuning − (E(x̃) − E(x̃_0))
    ("account", "J"),  # balance of the passivity account; 0 for laws without one
)
"""channels `LABEL/…` with one entry per axis: name, unit"""
TASK_SUMS = ("energy_stored", "energy_supplied", "energy_dissipated", "energy_tuning")
"""channels `LABEL/…` of one task, J"""
MOMENT_SCALE = "moment_scale"
"""channel `LABEL/…`: factor on h of the rotations that keeps each moment within its F_max"""


@dataclass(frozen=True)
class LedgerChannel:
    """Where a channel stands in the output of a step."""

    start: int
    size: int
    """0 for a scalar"""
    unit: str


def channel_table(joints: int, tasks: Sequence[tuple[str, int]], account: bool = True) -> dict[str, LedgerChannel]:
    """Name → place of every channel of a stack.

    Args:
        joints: number of joints; torque and clamped torque come first.
        tasks: (label, axes) of each task.
        account: whether the axes have a passivity account; without one nothing is spendable, and no channel says so.
    """
    table: dict[str, LedgerChannel] = {}
    place = 2 * joints
    for name in TOTALS:
        table[f"energy/{name}"] = LedgerChannel(place, 0, "J")
        place += 1
    if not account:
        del table["energy/spendable"]
    for label, axes in tasks:
        table[f"{label}/wrench"] = LedgerChannel(place, 6, "N, N·m")
        place += 6
        for name, unit in AXIS_ROWS:
            table[f"{label}/{name}"] = LedgerChannel(place, axes, unit)
            place += axes
        for name in TASK_SUMS:
            table[f"{label}/{name}"] = LedgerChannel(place, 0, "J")
            place += 1
        table[f"{label}/{MOMENT_SCALE}"] = LedgerChannel(place, 0, "1")
        place += 1
    return table


def require_length(table: Mapping[str, LedgerChannel], numbers: int) -> None:
    """Raises ShapeError unless the channels end where the output of the compiled core ends."""
    end = max(channel.start + max(channel.size, 1) for channel in table.values())
    if end != numbers:
        raise ShapeError(
            f"channels of the ledger end at {end} numbers, the compiled core writes {numbers}; "
            "compile pliant again: the core is of another version"
        )


def layout_of(table: Mapping[str, LedgerChannel]) -> FlatLayout:
    """The channels in the array that begins with the first of them."""
    begin = min(channel.start for channel in table.values())
    starts = {name: (channel.start - begin, channel.size) for name, channel in table.items()}
    return FlatLayout({name: slice(at, at + size) if size else at for name, (at, size) in starts.items()})
