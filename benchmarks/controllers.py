"""Time per step of the two-task stack, as JSON. Run: OMP_NUM_THREADS=1 python benchmarks/controllers.py [steps]"""

from __future__ import annotations

import json
import sys

from pliant.controllers.benchmark import run


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 20000
    results = {"stack": run(steps), "stack with every channel read": run(steps, read_diagnostics=True)}
    print(json.dumps(results, indent=2, ensure_ascii=False))


if __name__ == "__main__":
    main()
