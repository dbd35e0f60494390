"""Where each controller holds still with suggested gains: robots, stiffness of the surface, delays of the loop.

    python benchmarks/domains.py                                    every controller; robots of the catalogue
    python benchmarks/domains.py --controllers haptic --robots panda --stiffness 3e3,1e5 --delays 0,0.002,0.01
    python benchmarks/domains.py --grid iiwa14                      with the whole grid of stiffness and delay for one
    python benchmarks/domains.py --write                            what `pliant list controllers NAME` prints

A run presses 20 N on a flat surface and slides 0.1 m at 0.05 m/s; drives of 30 Hz, friction 0.25, the surface where it
is believed. The delay is shared by sensing (a fifth, whole periods) and computation. A run *holds* if it does not fail,
and, for a controller that regulates a force, if it loses no contact on the path, stays below 60 N and no line of the
force's spectrum between 2 and 100 Hz is above 10 % of the wanted force. The surface leans towards an arm whose tool
cannot stand upright on a level one (`TILTED`); a leg does the same with its foot on a floor (`foot.toml`).
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

import pliant
from pliant.errors import PliantError
from pliant.face.result import RunResult
from pliant.robots import CATALOGUE, is_available
from pliant.telemetry.steadiness import largest_line
from pliant.wiring.domains import FILE
from pliant.wiring.registry import controllers, find_controller

FORCE = 20.0  # N
ROBOTS = tuple(name for name, entry in CATALOGUE.items() if is_available(entry))
DRIVE = 30.0  # Hz
TILTED = {"z1": -45.0}  # degrees
FOOT = Path(__file__).with_name("foot.toml")
LEGS = {"leg3": ("foot", "foot"), "anymal": ("foot-anymal", "LF_FOOT")}  # robot → case of the file, frame
BOUNDS = {
    "contact_lost": (0.0, "% of contact lost"),
    "force_peak": (60.0, "N at most"),
    "force_line": (10.0, "% in one line of the spectrum"),
}


def loop(delay: float) -> tuple[dict[str, float], dict[str, Any]]:
    """The timing that is believed, and what is true of the loop and its drives."""
    sensing = round(delay / 5.0, 3)
    imperfect = {
        "computation_delay": delay - sensing,
        "sensing": {"delay": sensing},
        "actuation": {"bandwidth": 2.0 * math.pi * DRIVE},
    }
    return {"sensing_delay": sensing, "computation_delay": delay - sensing}, imperfect


def changes(robot: str, stiffness: float, delay: float) -> dict[str, Any]:
    """Of the task that ships."""
    timing, imperfect = loop(delay)
    return {
        "path": {"pattern": "line", "size": (0.1, 0.1), "speed": 0.05},
        "force": {"normal": FORCE},
        "surface": {"stiffness": stiffness, "tilt": TILTED.get(robot, 0.0)},
        "limits": {"force": 200.0},
        "timing": timing,
        "truth": {"shift": 0.0, "tilt": 0.0, "imperfections": imperfect},
        "accept": {},
    }


def stand(controller: str, robot: str, stiffness: float, delay: float) -> RunResult:
    """A leg's run on its floor."""
    timing, imperfect = loop(delay)
    floor = {"floor": {"stiffness": stiffness}}
    changed: dict[str, Any] = {"timing": timing, "truth": {"imperfections": imperfect}, "scene": floor}
    return pliant.run(FOOT, case=LEGS[robot][0], controller=controller, **changed)


def slid(made: RunResult, frame: str) -> dict[str, float]:
    """Metrics of a leg's run, from where it began to slide, of a force along the floor's normal."""
    begins = {name: time for time, name in made.log.phases()}["slide"]
    name = f"truth/{frame}/wrench"
    time, force = made.log.time(name), made.log[name][:, 2]
    force, peak = force[time >= begins], float(force.max())
    wanted = np.full(len(force), FORCE)
    return {
        "force_error": float(np.mean(np.abs(force - wanted))),
        "contact_lost": 100.0 * float(np.mean(force <= 0.0)),
        "force_peak": peak,
        "force_line": 100.0 * largest_line(force, wanted, float(np.median(np.diff(time)))),
    }


def run(controller: str, robot: str, stiffness: float, delay: float) -> str:
    """ "holds", or what kept it from that, in a few words and with numbers."""
    try:
        if robot in LEGS:
            result = stand(controller, robot, stiffness, delay)
        else:
            result = pliant.run("wipe", controller=controller, robot=robot, **changes(robot, stiffness, delay))
    except PliantError as error:
        return f"not begun: {str(error).partition(';')[0]}"
    if result.failure is not None:
        return f"failed: {result.failure}"
    if not find_controller(controller).regulates_force:
        return "holds"
    of_leg = slid(result, LEGS[robot][1]) if robot in LEGS else {}
    found = of_leg or {name: metric.value for name, metric in result.metrics.items()}
    for name, (bound, unit) in BOUNDS.items():
        if not found.get(name, math.nan) <= bound:
            error, lost = found["force_error"], found["contact_lost"]
            return f"{found.get(name, math.nan):.3g} {unit}; mean error {error:.2g} N, contact lost {lost:.2g} %"
    return "holds"


def numbers(text: str) -> list[float]:
    return [float(part) for part in text.split(",")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--controllers", default=",".join(controllers()))
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--stiffness", default="3e3,3e4", help="N/m")
    parser.add_argument("--delays", default="0.002", help="s")
    parser.add_argument("--grid", default="", help="robots that get 3e3,1e4,3e4,1e5 N/m at 0, 2, 5 and 10 ms")
    parser.add_argument("--write", action="store_true", help="puts what is found where `pliant list` reads it")
    asked = parser.parse_args()
    cells = [(robot, k, delay) for robot in asked.robots.split(",")
             for k in numbers(asked.stiffness) for delay in numbers(asked.delays)]  # fmt: skip
    cells += [(robot, k, delay) for robot in asked.grid.split(",") if robot
              for k in (3e3, 1e4, 3e4, 1e5) for delay in (0.0, 0.002, 0.005, 0.01)]  # fmt: skip
    kept: list[dict[str, Any]] = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else []
    for controller in asked.controllers.split(","):
        for robot, stiffness, delay in dict.fromkeys(cells):
            verdict = run(controller, robot, stiffness, delay)
            print(f"{controller} {robot} {stiffness:g} N/m {1e3 * delay:g} ms: {verdict}", flush=True)
            cell: dict[str, Any] = {"controller": controller, "robot": robot, "stiffness": stiffness, "delay": delay}
            kept = [one for one in kept if any(one[key] != value for key, value in cell.items())]
            place = "foot on a floor" if robot in LEGS else f"surface at {TILTED[robot]:g}°" if robot in TILTED else ""
            kept.append({**cell, "verdict": verdict, **({"place": place} if place else {})})
        if asked.write:
            lines = ",\n".join(json.dumps(one, ensure_ascii=False) for one in kept)
            Path(FILE).write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
