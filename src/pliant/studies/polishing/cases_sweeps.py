"""[FFMPC]'s studies of parameters: horizon, contact model, force weight, iterations, and what stands beside them."""

from __future__ import annotations

from pliant.configuration import merged
from pliant.experiments.case import Case, Changes, Row
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.rows import ALL, BEST, ROWS, SWEPT, against, case_config, imperfect, varied

_LENGTH = 0.015  # s, of a horizon whose nodes change
_RIPPLE: Changes = {"imperfections": {"ripple": {"amplitude": 5.0}}}


def _sweep(name: str, rows: list[Row], *figures: object) -> Case[PolishingConfig]:
    return Case(case_config(name, **imperfect()), rows, SWEPT, figures=[*figures, ROWS])  # pyright: ignore


def force_weight(controller: str, factor: float) -> Row:
    """The controller's own force weights, all times a factor."""

    def changes(base: PolishingConfig) -> Changes:
        force = merged(base, {"controller": controller}).parameters().model_dump()["costs"]["force"]
        weights = {name: factor * force[name] for name in ("weight", "terminal") if force[name] is not None}
        row = varied(controller, "", {"control": {"costs": {"force": weights}}})
        return row.changed(base)

    return Row(f"× {factor:g}", controller, changes, factor)


def _anchor(controller: str, error: float, found: bool) -> Row:
    """The table is believed 5 mm too high or too low: contact by the timetable, or where it is found."""
    label = f"{1e3 * error:+g} mm, {'found' if found else 'timetable'}"
    return varied(controller, label, {"table": {"height_error": error}, "task": {"found": found}})


def _model(stiffness: float, damping: float) -> Row:
    contact = {"stiffness": [stiffness], "damping": [damping]}
    return varied("force-feedback-mpc", f"K = {stiffness:g}, B = {damping:g}", {"control": {"contact": contact}})


def _rippled(controller: str) -> list[Row]:
    """The paper's remedy ([FFMPC] VIII-C.1) at several cutoffs, alone and with its lag filled in by the motion."""
    rows = [varied(controller, "no ripple", {}), varied(controller, "ripple", _RIPPLE)]
    for stiffness, how in ((None, "Butterworth"), (1e4, "without lag")):
        for cutoff in (10.0, 15.0, 20.0, 30.0, 40.0, 60.0):
            filtered = {"wrench_cutoff": cutoff, "wrench_stiffness": stiffness}
            rows.append(varied(controller, f"ripple, {how} {cutoff:g} Hz", {**_RIPPLE, "estimation": filtered}))
    return rows


_NODES = [varied(name, f"N = {n}", {"control": {"horizon": n}}, float(n)) for name in ALL for n in (1, 3, 5, 10)]
_STEPS = [
    varied(name, f"N = {n} over 15 ms", {"control": {"horizon": n, "dt": _LENGTH / n}})
    for name in ALL
    for n in (3, 10, 15)
]

SWEEP_CASES: tuple[Case[PolishingConfig], ...] = (
    _sweep("horizon", [*_NODES, *_STEPS], against("nodes N of 3 ms")),
    _sweep(
        "stiffness",
        [_model(K, B) for K in (300.0, 1e3, 3e3, 6e3) for B in (25.0, 50.0, 100.0, 200.0) if 3e-3 * K < B],
    ),
    Case(
        case_config("force-weight", **imperfect()),
        [force_weight(name, factor) for name in ALL for factor in (0.01, 0.1, 1.0, 10.0)],
        SWEPT,
        figures=[against("factor of the force weight", log_x=True)],
    ),
    Case(
        case_config("iterations", **imperfect()),
        [varied(name, f"at most {n}", {"control": {"max_iterations": n}}, float(n)) for name in ALL for n in (1, 2, 8)],
        SWEPT,
        figures=[against("most SQP iterations per solve")],
    ),
    _sweep(
        "anchor",
        [_anchor(name, error, found) for name in ALL for error in (-5e-3, 0.0, 5e-3) for found in (False, True)],
    ),
    _sweep("ripple", [row for name in ("force-feedback-mpc", BEST) for row in _rippled(name)]),
)
