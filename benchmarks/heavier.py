"""A robot whose links are heavier by a factor, as a URDF: an arm that no catalogue has.

    python benchmarks/heavier.py panda 2 panda_masses_x2.urdf && pliant run wipe --robot panda_masses_x2.urdf

Masses and inertias are multiplied, limits stay.
"""

from __future__ import annotations

import argparse
import re
from importlib.resources import files
from pathlib import Path


def heavier(text: str, factor: float) -> str:
    """A URDF with every mass and inertia times a factor."""

    def times(found: re.Match[str]) -> str:
        return f'{found[1]}"{float(found[2]) * factor!r}"'

    def whole(found: re.Match[str]) -> str:
        return re.sub(r'(\w+=)"([^"]*)"', times, found[0])

    return re.sub(r"<(mass|inertia)\s[^>]*>", whole, text)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", help="iiwa14, panda, ur5e, … that pliant ships, or a URDF file")
    parser.add_argument("factor", type=float)
    parser.add_argument("out", type=Path)
    asked = parser.parse_args()
    shipped = files("pliant.robots") / f"{asked.robot}.urdf"
    text = shipped.read_text(encoding="utf-8") if shipped.is_file() else Path(asked.robot).read_text(encoding="utf-8")
    name = re.search(r'<robot[^>]*name="([^"]+)"', text)
    if name is not None:
        text = text.replace(f'name="{name[1]}"', f'name="{name[1]}_{asked.factor:g}"', 1)
    asked.out.write_text(heavier(text, asked.factor), encoding="utf-8")


if __name__ == "__main__":
    main()
