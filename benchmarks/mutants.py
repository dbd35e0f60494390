"""Faults that tests should notice: a seeded list of small changes of the code, and which test notices each.

    python -m benchmarks.mutants draw docs/data/mutants.json --seed 13 --per-folder 6
    python -m benchmarks.mutants run docs/data/mutants.json [--limit 300] [--folders controllers,mpc] [--suite]
    python -m benchmarks.mutants count docs/data/mutants.json

`draw` looks for places in every folder of `src/pliant` where a sign, a factor, a term, an axis or a bound can be wrong,
and draws as many from each folder with a fixed seed. `run` makes one change at a time in a copy of the tree and runs
the files of tests that own the changed module, then, where none fails, those that import it or its folder; with
`--suite`, survivors meet all the others. It writes what it finds into the list after each, and goes on where it was
stopped. The list says at which commit it was drawn: a line that a later one changed is judged there. A test that does
not end within 120 s has noticed. A change that means the same as before is marked by hand: `verdict = "equivalent"`
with a reason.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import asdict
from pathlib import Path

from benchmarks.mutant_places import ROOT, Mutant, function_at, places

SOURCE = ROOT / "src" / "pliant"
KINDS = ("sign", "factor 2", "dropped term", "swapped axis", "off by one")
UNFIT = ("templates", "plots", "draw.py", "presets.py", "__init__.py", "benchmark.py", "crocoddyl")
"""parts of paths whose lines are looks, data, wall times, or the oracle that tests compare with"""
_PER_TEST = 120  # s after which a test that does not end has noticed


def draw(seed: int, per_folder: int) -> list[Mutant]:
    """As many from each folder, each kind as often as it can be; at most one a line."""
    rng = random.Random(seed)
    folders: dict[str, list[Mutant]] = {}
    for path in sorted(SOURCE.rglob("*.py")):
        parts = path.relative_to(SOURCE).parts
        if not any(part in UNFIT for part in parts):
            folders.setdefault(parts[0] if len(parts) > 1 else "", []).extend(places(path))
    drawn: list[Mutant] = []
    for found in folders.values():
        rng.shuffle(found)
        by_kind = {kind: [m for m in found if m.kind == kind] for kind in KINDS}
        chosen: list[Mutant] = []
        while len(chosen) < per_folder and any(by_kind.values()):
            kind = rng.choice([kind for kind in KINDS if by_kind[kind]])
            mutant = by_kind[kind].pop()
            if all((mutant.file, mutant.function, mutant.text) != (m.file, m.function, m.text) for m in chosen):
                chosen.append(mutant)
        drawn += chosen
    return drawn


def owning(tree: Path, file: str) -> tuple[list[str], list[str], list[str]]:
    """Files of tests: those that own a module, those that import it or its folder, all others; nearest first."""
    module = file.removeprefix("src/").removesuffix(".py").replace("/", ".")
    folder, stem = module.rsplit(".", 1)
    texts = {path: path.read_text() for path in sorted((tree / "tests").rglob("test_*.py"))}
    named = [path for path in texts if path.name == f"test_{stem}.py"]
    direct = [path for path, text in texts.items() if module in text or f"from {folder} import {stem}" in text]
    near = [path for path, text in texts.items() if folder != "pliant" and folder in text]
    own = named or direct[:3] or near[:3]
    second = [path for path in dict.fromkeys([*direct, *near]) if path not in own]
    others = [path for path in texts if path not in own and path not in second]
    unfit = ("browser", "contracts")
    first, then, last = (
        [str(path.relative_to(tree)) for path in paths if not any(word in path.name for word in unfit)]
        for paths in (own, second, others)
    )
    return first, then, last


def mutated(mutant: Mutant, text: str) -> str:
    """A file's text with the change. Raises SystemExit if the line is no longer there."""
    lines = text.splitlines(keepends=True)
    same = [index for index, line in enumerate(lines) if line.strip() == mutant.text]
    same.sort(key=lambda index: function_at(text, index + 1) != mutant.function)  # its own function first
    if not same:
        raise SystemExit(f"{mutant.file} has no line {mutant.text!r} any more; draw the list again")
    at = same[0]
    line, shift = lines[at].encode(), len(lines[at]) - len(lines[at].lstrip())
    start, end = mutant.start + shift, mutant.end + shift
    if line[start:end].decode() != mutant.before:
        raise SystemExit(f"{mutant.file}: {mutant.before!r} is not at its place in {mutant.text!r}")
    lines[at] = (line[:start] + mutant.after.encode() + line[end:]).decode()
    return "".join(lines)


def noticed(tree: Path, mutant: Mutant, text: str, tests: list[str], limit: float) -> str | None:
    """The first test that fails with a change and passes without it; None if there is none within the limit."""
    path, unsound = tree / mutant.file, []
    original = path.read_text()
    while tests:
        path.write_text(text)
        failed = _failing(tree, tests, limit, unsound)
        path.write_text(original)
        if failed is None or _failing(tree, [failed], limit, []) is None:
            return failed
        unsound.append(failed)  # it fails without the change as well: it says nothing
    return None


def _failing(tree: Path, tests: list[str], limit: float, without: list[str]) -> str | None:
    environment = os.environ | {"PYTHONPATH": str(tree / "src"), "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    options = ["-q", "-x", "-n", "0", "-p", "no:cacheprovider", "--no-header", f"--timeout={_PER_TEST}"]
    options += [f"--deselect={name}" for name in without]
    command = [sys.executable, "-m", "pytest", *options, *tests]
    try:
        done = subprocess.run(
            command, cwd=tree, env=environment, capture_output=True, text=True, timeout=limit, check=False
        )
    except subprocess.TimeoutExpired:
        return None
    failed = [line.split()[1] for line in done.stdout.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    return failed[0] if failed else None


def run(path: Path, limit: float, folders: list[str], suite: bool) -> None:
    """Judges every open mutant, one after the other."""
    mutants = read(path)
    with tempfile.TemporaryDirectory() as scratch:
        tree = Path(scratch) / "tree"
        shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(".git", "__pycache__", "build", "site"))
        for mutant in mutants:
            again = suite and mutant.verdict == "survived"
            if (mutant.verdict != "open" and not again) or not any(f"pliant/{name}" in mutant.file for name in folders):
                continue
            text = mutated(mutant, (tree / mutant.file).read_text())
            first, then, last = owning(tree, mutant.file)
            by = None
            for tests in [last] if again else [first, then]:
                by = by or noticed(tree, mutant, text, tests, limit)
            mutant.verdict, mutant.by = ("survived", "") if by is None else ("killed", by.split("[")[0])
            write(path, mutants)
            print(
                f"{mutant.verdict} {mutant.file}:{mutant.function} {mutant.before} → {mutant.after}: {mutant.by}",
                flush=True,
            )


def count(path: Path) -> int:
    """Prints how many were noticed; 1 if fewer than 95 % of 60."""
    found = Counter(mutant.verdict for mutant in read(path))
    judged = found["killed"] + found["survived"]
    print(f"{found['killed']} of {judged} noticed, {found['equivalent']} equivalent, {found['open']} open")
    return int(judged < 60 or found["killed"] < 0.95 * judged or found["open"] > 0)


def read(path: Path) -> list[Mutant]:
    """The list."""
    return [Mutant(**entry) for entry in json.loads(path.read_text())["mutants"]]


def write(path: Path, mutants: list[Mutant], commit: str | None = None) -> None:
    """The list, an entry a line. Args: commit: at which it was drawn; None: as the file says."""
    drawn = json.dumps(json.loads(path.read_text())["drawn at"] if commit is None else commit)
    lines = ",\n".join(json.dumps(asdict(mutant), ensure_ascii=False) for mutant in mutants)
    path.write_text(f'{{"drawn at": {drawn}, "mutants": [\n{lines}\n]}}\n')


def main() -> int:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("draw", "run", "count"))
    parser.add_argument("list", type=Path)
    parser.add_argument("--seed", type=int, default=13)
    parser.add_argument("--per-folder", type=int, default=6)
    parser.add_argument("--limit", type=float, default=300.0, help="s for the tests of one mutant")
    parser.add_argument("--folders", default="", help="of src/pliant, with commas between; default: all")
    parser.add_argument("--suite", action="store_true", help="survivors, by the files of tests that do not own them")
    asked = parser.parse_args()
    if asked.what == "draw":
        commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True)
        write(asked.list, draw(asked.seed, asked.per_folder), commit.stdout.strip())
    elif asked.what == "run":
        run(asked.list, asked.limit, asked.folders.split(","), asked.suite)
    return count(asked.list)


if __name__ == "__main__":
    sys.exit(main())
