"""The cases of the study, and every run that each consists of: values of one configuration."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from pliant.experiments.config import merged
from pliant.mpc.config import OffsetFreeMpc
from pliant.simulation import Imperfections
from pliant.studies.polishing.config import PolishingConfig, Pushes
from pliant.studies.polishing.paper import STOCK
from pliant.studies.polishing.targets import BEST

TILTS = (-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0)
"""degrees, of the tables"""
FEW_TILTS = (-6.0, -2.0, 2.0, 6.0)
"""degrees, of ablations and sweeps"""
ALL = (*STOCK, BEST)
_DELAY = 5e-3  # s, the paper's δ_o
_STOCK_DELAY = dict.fromkeys(STOCK, 0.0) | {BEST: _DELAY}

Runs = Sequence[PolishingConfig]


def _imperfect(pid: bool = True, delay: float = 0.0) -> dict[str, Any]:
    return {"imperfections": Imperfections.p3(pid=pid, computation_delay=delay).model_dump()}


def _case(name: str, **changes: Any) -> PolishingConfig:
    return merged(PolishingConfig(case=name), changes)


_TILTED = {"tilt": math.radians(6.0)}
_FAST = {"speed": 6.0}

CASES: Mapping[str, PolishingConfig] = MappingProxyType(
    {
        config.case: config
        for config in (
            _case("ideal", preset="perfect"),
            _case("tables-2-3-4", **_imperfect()),
            _case("tables-2-3-4-delayed", controller=BEST, **_imperfect(delay=_DELAY)),
            _case("square", task={"pattern": "square"}, **_imperfect()),
            _case("slow", **_imperfect()),
            _case("slow-tilted", table=_TILTED, **_imperfect()),
            _case("fast-tilted", table=_TILTED, task=_FAST, **_imperfect()),
            _case("fast-pushed", task=_FAST, pushes=Pushes().model_dump(), **_imperfect()),
            _case("horizon", **_imperfect()),
            _case("stiffness", **_imperfect()),
            _case("force-weight", **_imperfect()),
            _case("iterations", **_imperfect()),
            _case("anchor", **_imperfect()),
            _case("ripple", **_imperfect()),
            _case("ablation", controller=BEST, **_imperfect(delay=_DELAY)),
            _case("robustness", controller=BEST, **_imperfect(pid=False, delay=_DELAY)),
        )
    }
)
"""name → what `pliant run polishing --case NAME` runs"""


def runs_of(case: PolishingConfig, seeds: int | None) -> Runs:
    """Every run of a case: controllers, variants, tilts, seeds (None: as many as the case needs)."""
    return _RUNS[case.case](case, seeds)


# ---------------------------------------------------------------------- tables


def _ideal(case: PolishingConfig, seeds: int | None) -> Runs:
    tuned = [merged(case, {"controller": name}) for name in STOCK]
    return [*tuned, *(merged(config, {"preset": "paper", "variant": "paper-weights"}) for config in tuned)]


def _tables(case: PolishingConfig, seeds: int | None) -> Runs:
    """Tables II to IV: tilts × seeds, with and without the torque loop."""
    delay = case.imperfections.computation_delay
    names = ALL if delay else STOCK
    rows = [
        merged(case, {"controller": name, "variant": "PID" if pid else "no PID", **_imperfect(pid, delay)})
        for pid in (True, False)
        for name in names
    ]
    return [run for row in rows for run in _drawn(row, TILTS, seeds or 10)]


def _drawn(config: PolishingConfig, tilts: Sequence[float], seeds: int) -> Runs:
    """A configuration on every tilt with other draws each; the first draw is seed 0 on the last tilt."""
    return [
        merged(config, {"table": {"tilt": math.radians(tilt)}, "seed": place * seeds + seed})
        for place, tilt in enumerate(reversed(tilts))
        for seed in range(seeds)
    ]


def _robot_like(case: PolishingConfig, seeds: int | None) -> Runs:
    """The paper's experiments on its robot: its three controllers without δ_o, pliant's own with it."""
    return [
        merged(case, {"controller": name, "seed": seed, "imperfections": {"computation_delay": _STOCK_DELAY[name]}})
        for name in ALL
        for seed in range(seeds or 5)
    ]


# ---------------------------------------------------------------------- sweeps


def _varied(case: PolishingConfig, seeds: int | None, rows: Sequence[tuple[str, str, Mapping[str, Any]]]) -> Runs:
    """Rows of (controller, variant, changes) on few tilts."""
    made = [
        merged(
            merged(case, {"imperfections": {"computation_delay": _STOCK_DELAY[name]}, "controller": name}),
            {"variant": variant, **changes},
        )
        for name, variant, changes in rows
    ]
    return [run for config in made for run in _drawn(config, FEW_TILTS, seeds or 3)]


def _horizon(case: PolishingConfig, seeds: int | None) -> Runs:
    nodes = [(name, f"N = {n}", {"control": {"horizon": n}}) for name in ALL for n in (1, 3, 5, 10)]
    length = 0.015  # s
    steps = [
        (name, f"N = {n} over 15 ms", {"control": {"horizon": n, "dt": length / n}})
        for name in ALL
        for n in (3, 10, 15)
    ]
    return _varied(case, seeds, [*nodes, *steps])


def _stiffness(case: PolishingConfig, seeds: int | None) -> Runs:
    rows = [
        ("force-feedback-mpc", f"K = {K:g}, B = {B:g}", {"control": {"contact": {"stiffness": [K], "damping": [B]}}})
        for K in (300.0, 1e3, 3e3, 6e3)
        for B in (25.0, 50.0, 100.0, 200.0)
        if 3e-3 * K < B
    ]
    return _varied(case, seeds, rows)


def _force_weight(case: PolishingConfig, seeds: int | None) -> Runs:
    rows: list[tuple[str, str, Mapping[str, Any]]] = []
    for name in ALL:
        force = merged(case, {"controller": name}).parameters().model_dump()["costs"]["force"]
        for factor in (0.01, 0.1, 1.0, 10.0):
            weights = {"weight": factor * force["weight"]}
            if force["terminal"] is not None:
                weights["terminal"] = factor * force["terminal"]
            rows.append((name, f"× {factor:g}", {"control": {"costs": {"force": weights}}}))
    return _varied(case, seeds, rows)


def _iterations(case: PolishingConfig, seeds: int | None) -> Runs:
    rows = [(name, f"at most {n}", {"control": {"max_iterations": n}}) for name in ALL for n in (1, 2, 8)]
    return _varied(case, seeds, rows)


def _anchor(case: PolishingConfig, seeds: int | None) -> Runs:
    """The table is believed 5 mm too high or too low: contact by the timetable, or where it is found."""
    rows = [
        (
            name,
            f"{1e3 * error:+g} mm, {'found' if found else 'timetable'}",
            {"table": {"height_error": error}, "task": {"found": found}},
        )
        for name in ALL
        for error in (-5e-3, 0.0, 5e-3)
        for found in (False, True)
    ]
    return _varied(case, seeds, rows)


def _ripple(case: PolishingConfig, seeds: int | None) -> Runs:
    strong = {"imperfections": {"ripple": {"amplitude": 5.0}}}
    kinds = {
        "no ripple": {},
        "ripple": strong,
        "ripple, Butterworth 15 Hz": {**strong, "estimation": {"wrench_cutoff": 15.0}},
    }
    names = ("force-feedback-mpc", BEST)
    return _varied(case, seeds, [(name, kind, changes) for name in names for kind, changes in kinds.items()])


# ---------------------------------------------------------------------- beyond the paper

_EVERYTHING = {"control": {"compensation": OffsetFreeMpc().compensation.model_dump()}}
_THREE_D = {
    "contact": {
        "dimension": 3,
        "integrator": "euler",
        "stiffness": [3e3, 3e3, 1e4],
        "damping": [35.0, 35.0, 100.0],
        "friction": 0.25,
    },
    "costs": {"force": {"activation": [0.0, 0.0, 1.0]}, "force_rate": {"activation": [0.0, 0.0, 1.0]}},
}


def _ablation(case: PolishingConfig, seeds: int | None) -> Runs:
    """Each part of the offset-free controller taken away or put into the others, at the paper's delay."""

    def without(**changes: Any) -> Mapping[str, Any]:
        return {"control": {"compensation": changes}}

    full = {
        "all": {},
        "no joint state filter": {"estimation": {"joint_memory": 0.0}},
        "no disturbance": without(disturbance=False),
        "no delay prediction": without(sensing_delay=0.0, computation_delay=0.0),
        "no averaging": without(averaging=0.0),
        "no force integral": without(force_integral=0.0),
        "K not estimated": without(environment=False),
        "with bounds": {"control": {"bounds": {"torque": True, "force_max": 80.0}}},
        "3-D with friction": {"control": _THREE_D},
    }
    rows = [(BEST, name, changes) for name, changes in full.items()]
    for name in STOCK:
        rows += [
            (name, "stock", {}),
            (name, "joint state filter", {"estimation": {"joint_memory": 0.3}}),
            (name, "everything", _EVERYTHING),
        ]
    made: list[PolishingConfig] = []
    for pid in (True, False):
        for name, variant, changes in rows:
            config = merged(case, {"controller": name, **_imperfect(pid, _DELAY)})
            label = f"{variant}, {'PID' if pid else 'no PID'}"
            made.append(merged(config, {"variant": label, **changes}))
    return [run for config in made for run in _drawn(config, FEW_TILTS, seeds or 3)]


def _robustness(case: PolishingConfig, seeds: int | None) -> Runs:
    """What the tuning was not made for, one thing at a time."""
    noise = case.imperfections.sensing
    louder = {
        "noise_q": 3e-3,
        "noise_v": 3e-3,
        "noise_force": 3.0 * noise.noise_force,
        "noise_torque": (0.09, 0.09, 0.06, 0.06, 0.03, 0.03),
    }
    rows: dict[str, Mapping[str, Any]] = {
        "as tuned": {},
        "friction 0.5": {"table": {"friction": 0.5}},
        "6 rad/s": {"task": _FAST},
        "tool 0.5 kg heavier": {"unknown_mass": 0.5},
        "noise × 3": {"imperfections": {"sensing": louder}},
        "pushed": {"pushes": {"force": 20.0 * math.sqrt(2.0)}},
        "δ_o taken 1 ms too long": {"delay_error": 1e-3},
        "δ_o taken 1 ms too short": {"delay_error": -1e-3},
    }
    for stiffness in ("3e3", "3e4", "1e5"):
        rows[f"table {stiffness} N/m"] = {"table": {"stiffness": float(stiffness)}}
    return _varied(case, seeds, [(BEST, name, changes) for name, changes in rows.items()])


_RUNS: Mapping[str, Callable[[PolishingConfig, int | None], Runs]] = {
    "ideal": _ideal,
    "tables-2-3-4": _tables,
    "tables-2-3-4-delayed": _tables,
    "square": _robot_like,
    "slow": _robot_like,
    "slow-tilted": _robot_like,
    "fast-tilted": _robot_like,
    "fast-pushed": _robot_like,
    "horizon": _horizon,
    "stiffness": _stiffness,
    "force-weight": _force_weight,
    "iterations": _iterations,
    "anchor": _anchor,
    "ripple": _ripple,
    "ablation": _ablation,
    "robustness": _robustness,
}
