"""Examples 03 and 05 on every robot of the catalogue that is installed, and on robot files.

    python benchmarks/examples_on_robots.py                         all robots of the catalogue that are installed
    python benchmarks/examples_on_robots.py lwr4 my_arm.urdf        these

Prints the line of each example, or the sentence with which a robot is refused. Exits 1 where the mean force of example
05 is not 20 ± 0.5 N. The spread while it draws its circle is larger on some arms: friction along the table couples into
the normal force of that controller.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import re
import sys
from pathlib import Path
from types import ModuleType

from pliant.errors import PliantError
from pliant.robots import CATALOGUE, is_available

EXAMPLES = Path(__file__).parents[1] / "examples"


def loaded(name: str) -> ModuleType:
    """An example by the name of its file, without its ending."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def said(example: ModuleType, robot: str) -> str:
    """What the example prints about a robot in its line of results, or why it refuses the robot."""
    out = io.StringIO()
    try:
        with contextlib.redirect_stdout(out):
            example.main(robot)
    except PliantError as error:
        return f"{robot}: refused: {error}"
    lines = [line for line in out.getvalue().splitlines() if not line.startswith(("warning", "note", " "))]
    return lines[0] if lines else f"{robot}: said nothing"


def main(robots: list[str]) -> int:
    stack, press = loaded("03_stack_on_your_urdf"), loaded("05_force_feedback_mpc")
    missed = 0
    for robot in robots or [name for name, entry in CATALOGUE.items() if is_available(entry)]:
        line = said(press, robot)
        found = re.search(r"got (-?[\d.]+|nan) ± ([\d.]+|nan) N", line)
        good = "refused" in line or (found is not None and abs(float(found[1]) - 20.0) < 0.5)
        missed += not good
        print("03", said(stack, robot), "\n05", line, "" if good else "  ← missed", flush=True)
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
