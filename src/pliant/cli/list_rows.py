"""The rows of `pliant list`, from the controllers, studies and tasks themselves.

    python -m pliant.cli.list_rows

writes them into `lists.json`, from where the command reads them without a library of a run.
"""

from __future__ import annotations

import json
from typing import Any

from pliant.cli.list_file import FILE
from pliant.entries import ControllerEntry
from pliant.experiments.registry import get_study, study_names
from pliant.tasks import Task
from pliant.tasks.files import catalogue, load_task, read_task
from pliant.tasks.phase import Track
from pliant.wiring.registry import OWN, broken_controllers, controllers

Rows = list[list[str]]


def own_rows() -> dict[str, Rows]:
    """The rows of what is part of pliant: list → rows."""
    own = [_controller_row(entry) for entry in OWN.values()]
    return {"controllers": own, "studies": study_rows(), "tasks": task_rows()}


def controller_rows() -> Rows:
    """Name, family, needs, guarantees and summary of each controller, those of other packages with them."""
    broken = [[name, "broken", "", "", why] for name, why in broken_controllers().items()]
    return [_controller_row(entry) for entry in controllers().values()] + broken


def study_rows() -> Rows:
    """Study, case and controller of each case."""
    cases = [(name, case.config) for name in study_names() for case in get_study(name).cases.values()]
    return [[name, config.case, config.controller] for name, config in cases]


def task_rows() -> Rows:
    """Name, robot, surface, path and description of each task and of its variants."""
    rows = Rows()
    for name in catalogue():
        found = read_task(name)
        rows.append([name, *_told(found.task)])
        rows += [[f"  --case {variant}", *_told(load_task(name, variant))] for variant in found.variants]
    return rows


def text_of(lists: dict[str, Rows]) -> str:
    """The file's text: a line per row."""
    parts = [
        f"  {json.dumps(name)}: [\n"
        + ",\n".join(f"    {json.dumps(row, ensure_ascii=False)}" for row in rows)
        + "\n  ]"
        for name, rows in lists.items()
    ]
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _controller_row(entry: ControllerEntry[Any]) -> list[str]:
    needs = ", ".join(entry.needs(entry.default).words()) or "–"
    force = "" if entry.regulates_force else "; regulates no force"
    return [entry.name, entry.family, needs, entry.guarantees, entry.summary + force]


def _told(task: Task) -> list[str]:
    """Robot; what is touched, and the path on it; of a list of phases the things that stand around, and what moves."""
    if not task.phase:
        return [task.robot, task.surface.shape, task.path.pattern, task.description]
    things = ", ".join(dict.fromkeys(thing.shape for thing in task.scene.values())) or "nothing"
    tracks = [track.shape for track in task.phase[0].tracks.values() if isinstance(track, Track)]
    count = len(task.phase)
    return [task.robot, things, tracks[0] if tracks else f"{count} phase{'s' if count > 1 else ''}", task.description]


if __name__ == "__main__":
    FILE.write_text(text_of(own_rows()), encoding="utf-8")
