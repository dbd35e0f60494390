"""Command lines made at random from what a user might type, and from what nobody would."""

from __future__ import annotations

import os
import random
import struct
from pathlib import Path

NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "1e300",
    "1e-300",
    "1" + 23 * "0",
    "1" * 5000,
    "0x10",
    "1_0",
    "٣",
    "1e",
    "--1",
)
WORDS = ("", " ", "é", "a" * 5000, "[", "[[[", "{}", "=", "..", ".", "/", "-", "--", "~", "%s{0}", "\ufeff", "\udcff")
WORDS += (
    "[red]x[/red]",
    "[/]",
    "\x1b[31m",
    "a\nb",
    "a\tb",
    "None",
    "true",
    "'",
    '"',
    "stack ",
    "STACK",
    "stakc",
    "\x00",
)
PATHS = (
    "/dev/null",
    "/dev/zero",
    "/dev/full",
    "/proc/self/mem",
    "~no-such-user/x",
    "/proc/1/x",
    "x" * 300,
    "a/" * 3000,
)
_HOLD = ("--set", "path.kind=hold", "--set", "path.ramp=0", "--set", "duration=0.05")
RUNS = (
    ("stack", "rest-plain", ("--set", "duration=0.05")),
    ("stack", "figure8-plain", _HOLD),
    ("haptic", "floor", ("--set", "duration=0.05")),
    ("polishing", "ideal", ("--set", "duration=0.05")),
    ("toy", "fine", ()),
    ("toy", "physics", ()),
    ("wipe", "wipe", ("--set", "duration=0.05")),
)
"""study, case, and what makes it short"""
CONTROLLERS = (
    "stack",
    "spring",
    "haptic",
    "offset-free-mpc",
    "idle",
    "stak",
    "a:b",
    "odd.py:X",
    ":",
    "os:getcwd",
    "a.b.c:D",
)
ROBOTS = ("iiwa14", "leg3", "panda", "nobody", "iiwa 14")
KEYS = ("duration", "seed", "period", "physics_step", "robot", "case", "study", "controller", "locked", "joint_limits")
KEYS += ("path.kind", "path.period", "wall.friction", "control.tasks.ee.frame", "behaviour", "gains.a", "own_metrics")
KEYS += ("", ".", "a..b", "__class__", "model_config", "control", "surface.stiffness", "truth.tilt", "torque_step")
VALUES = (
    "{}",
    "[]",
    "[1,2]",
    "{a=1}",
    '"x"',
    "0.1",
    "1.5",
    "hold",
    "null",
    "true",
    "1979-05-27",
    "[[]]",
    "{uniform=[1,0]}",
)
METRICS = ("json:dumps", "os:getcwd", "nothing:there", "odd.py:f", "a", ":", "builtins:len")
SUFFIXES = (".toml", ".urdf", ".xml", ".mcap", ".csv", ".npz", ".parquet", ".py", ".json", "")
_TOML = 'study = "stack"\ncase = "figure8-plain"\nduration = 0.05\n'
_ROBOT = '<robot name="r"><link name="a"/></robot>'
CONTENTS: dict[str, bytes] = {
    "empty": b"",
    "bom": b"\xef\xbb\xbf" + _TOML.encode(),
    "utf16": _TOML.encode("utf-16"),
    "latin": _TOML.encode() + b"# \xe9\xff\n",
    "nul": bytes(4096),
    "text": b"this is nothing of that kind\n",
    "robot": _ROBOT.encode(),
    "entity": b'<!DOCTYPE a [<!ENTITY b "c"><!ENTITY d "&b;&b;">]><robot name="&d;"/>',
    "deep": b"<a>" * 5000,
    "nested": b"a = " + b"[" * 5000,
    "digits": b"duration = " + b"9" * 5000 + b"\n",
    "table": b'study = "stack"\n[path]\n[path]\n',
    "list": b'study = ["stack"]\ncase = {}\n',
    "task": b'format = 1\nrobot = "iiwa14"\n[surface]\nshape = "cube"\n',
    "future": b'format = 2\nrobot = "iiwa14"\n',
    "zip": b"PK\x03\x04" + struct.pack("<20H", *range(20)),
    "mcap": b"\x89MCAP0\r\n" + bytes(64),
    "parquet": b"PAR1" + bytes(64) + b"PAR1",
    "code": b"def f(log, config):\n    return 1\nclass X:\n    pass\n",
    "broken": b"def f(:\n",
    "exits": b"raise SystemExit(3)\n",
    "interrupts": b"raise KeyboardInterrupt\n",
    "raises": b"1 / 0\n",
}


def odd_files(folder: Path) -> list[str]:
    """Writes them. Returns their names, and those of what is no file."""
    names: list[str] = []
    for name, content in CONTENTS.items():
        for suffix in SUFFIXES:
            (folder / f"{name}{suffix}").write_bytes(content)
            names.append(f"{name}{suffix}")
    for suffix in SUFFIXES:
        (folder / f"folder{suffix}").mkdir()
        os.mkfifo(folder / f"pipe{suffix}")
        (folder / f"loop{suffix}").symlink_to(f"loop{suffix}")
        names += [f"folder{suffix}", f"pipe{suffix}", f"loop{suffix}", f"missing{suffix}"]
    (folder / "odd.py").write_text("class X:\n    pass\ndef f(log, config):\n    return 1\n")
    return names


class Typist:
    """Types a command line: what exists, and more or fewer things that are odd.

    Args:
        seed: of every draw.
        files: names of odd files.
    """

    def __init__(self, seed: int, files: list[str]) -> None:
        self.rng, self.files = random.Random(f"command {seed}"), files
        self.oddness = self.rng.choice((0.02, 0.1, 0.3))

    def line(self) -> list[str]:
        commands = {
            self.run: 10,
            self.study: 4,
            self.compare: 3,
            self.task: 3,
            self.doctor: 4,
            self.new: 3,
            self.log: 3,
            self.live: 2,
            self.other: 2,
        }
        made = self.rng.choices(list(commands), list(commands.values()))[0]()
        if self.rng.random() < 0.3 * self.oddness:
            made.insert(self.rng.randrange(len(made) + 1), self.any())
        return made

    def pick(self, *among: str) -> str:
        """One of these, or now and then something else."""
        return self.rng.choice(among) if self.rng.random() > self.oddness else self.any()

    def any(self) -> str:
        kinds = (NUMBERS, WORDS, PATHS, self.files, VALUES)
        return self.rng.choice(self.rng.choice(kinds))

    def sets(self) -> list[str]:
        made: list[str] = []
        while self.rng.random() < 0.5:
            value = self.rng.choice(self.rng.choice((NUMBERS, WORDS, VALUES, self.files)))
            made += ["--set", f"{self.pick(*KEYS)}={value}" if self.rng.random() < 0.9 else self.any()]
        return made

    def some(self, chance: float, option: str, *among: str) -> list[str]:
        return [option, self.pick(*among)] if self.rng.random() < chance else []

    def out(self) -> list[str]:
        return self.some(0.3, "--out", "out", "a/b/c")

    def run(self) -> list[str]:
        study, case, short = self.rng.choice(RUNS)
        line = ["run", self.pick(study), *self.some(0.8, "--case", case)]
        line += self.some(0.3, "--controller", *CONTROLLERS) + self.some(0.2, "--robot", *ROBOTS)
        line += self.some(0.3, "--seed", "1", "2") + self.some(0.1, "--metric", *METRICS) + self.out() + self.sets()
        return line + ([*short, "--no-figures"] if self.rng.random() < 0.6 else ["--show-config"])

    def study(self) -> list[str]:
        line = ["study", self.pick("toy"), "--case", self.pick("fine", "bug", "physics")]
        line += self.some(0.8, "--seeds", "1", "2") + self.some(0.2, "--jobs", "1")
        line += self.some(0.1, "--scheduler", "tcp://a", "tcp://:1", "http://a:1", "tcp://127.0.0.1:1")
        line += self.some(0.1, "--resume", "out", "a/b/c") + self.some(0.1, "--tune", "idle")
        return line + self.some(0.1, "--trials", "2", "0", "-1") + self.out() + self.sets()

    def compare(self) -> list[str]:
        names = ",".join(self.pick("idle", "other", *CONTROLLERS) for _ in range(self.rng.randint(0, 3)))
        line = ["compare", self.pick("toy"), "--controllers", names]
        return line + self.some(0.8, "--seeds", "1", "2") + self.out() + self.sets()

    def task(self) -> list[str]:
        action = self.pick("schema", "schema", "check")
        target = [] if action == "schema" else [self.any() if self.rng.random() < 0.9 else "wipe"]
        return ["task", action, *target, *self.some(0.3, "--robot", *ROBOTS), *self.out(), *self.sets()]

    def doctor(self) -> list[str]:
        line = ["doctor", *([self.pick(*ROBOTS, *self.files)] if self.rng.random() < 0.9 else [])]
        return line + self.some(0.3, "--locked", "A7=0", "A1=0.5") + self.some(0.3, "--config", *self.files)

    def new(self) -> list[str]:
        what = self.pick("task", "controller")
        name = self.pick("raster", "hold", "file") if what == "task" else self.pick("Mine", "SoftSpring")
        return [
            "new",
            what,
            name,
            *self.some(0.7, "-o", f"{self.rng.random()}.toml", f"n{self.rng.getrandbits(20)}.py"),
        ]

    def log(self) -> list[str]:
        return ["log", self.pick(*self.files), *(["--plot"] if self.rng.random() < 0.5 else []), *self.out()]

    def live(self) -> list[str]:
        """Of nothing that could be shown: a page would stay."""
        target = self.rng.choice([name for name in self.files if name.endswith((".mcap", ".py"))])
        return ["live", target, "--port", self.pick("0", "-1", "99999")]

    def other(self) -> list[str]:
        known = self.rng.random() < 0.5
        return ["list", self.pick("robots", "tasks")] if known else [self.pick("bench", "--version", "fly"), self.any()]
