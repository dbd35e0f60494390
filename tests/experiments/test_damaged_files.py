"""Files that a user may hand over, damaged at random: read, or refused in one sentence."""

from __future__ import annotations

import io
import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pliant.errors import PliantError
from pliant.experiments.choice import chosen
from pliant.experiments.registry import get_study
from pliant.experiments.repeat import write_config
from pliant.references.toolpaths.files import read_path
from pliant.references.trajectories.sampled import read_motion
from pliant.robot import Robot

SEEDS = 100  # of each kind; 600 found nothing more
ODD = [
    "nan",
    "-inf",
    "1e300",
    "1" * 400,
    "\0",
    "[[",
    "{",
    '"',
    "=",
    "true",
    "é",
    "\ufeff",
    "-1",
    "0",
    "\n\n",
    "<!--",
    "&",
]
CSV = "x,y,z\n" + "".join(f"{0.01 * i},{0.002 * i},0.0\n" for i in range(8))
SAMPLED = "time,x,y,z\n" + "".join(f"{0.1 * i},{0.01 * i},0.0,0.3\n" for i in range(8))
MJCF = """<mujoco><compiler angle="radian"/><worldbody><body name="a"><joint name="j" axis="0 0 1" range="-1 1"/>
<geom size="0.1" mass="1"/><body name="b" pos="0.3 0 0"><joint name="k" axis="0 1 0" range="-2 2"/>
<geom size="0.1" mass="1"/></body></body></worldbody>
<actuator><motor joint="j" forcerange="-9 9"/><motor joint="k" forcerange="-9 9"/></actuator></mujoco>"""


def samples() -> bytes:
    stream = io.BytesIO()
    time = np.linspace(0.0, 1.0, 8)
    np.savez_compressed(stream, time=time, x=0.1 * time, y=0.0 * time, z=0.3 + 0.0 * time)
    return stream.getvalue()


def damaged(data: bytes, rng: random.Random) -> bytes:
    """One to three of: a byte changed, a piece lost, doubled, put elsewhere, or something odd put in."""
    for _ in range(rng.randint(1, 3)):
        at, length = rng.randrange(len(data)), rng.choice([1, 3, 20, 200])
        piece = data[at : at + length]
        match rng.randrange(5):
            case 0:
                data = data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
            case 1:
                data = data[:at] + data[at + length :]
            case 2:
                data = data[:at] + piece + data[at:]
            case 3:
                there = rng.randrange(len(data))
                data = data[:there] + piece + data[there:]
            case _:
                data = data[:at] + rng.choice(ODD).encode() + data[at:]
    return data or b"x"


def load_run(file: Path) -> object:
    return chosen(str(file), None, {}, {})


def whole(study: str, folder: Path) -> str:
    config = get_study(study).case(next(iter(get_study(study).cases)))
    return write_config(get_study(study), config, folder).read_text()


KINDS: dict[str, tuple[str, Callable[[Path], str | bytes], Callable[[Path], object]]] = {
    "task": (".toml", lambda folder: (Path(__file__).parents[2] / TASK).read_text(), load_run),
    "stack": (".toml", lambda folder: whole("stack", folder), load_run),
    "haptic": (".toml", lambda folder: whole("haptic", folder), load_run),
    "polishing": (".toml", lambda folder: whole("polishing", folder), load_run),
    "path": (".csv", lambda folder: CSV, lambda file: read_path(file, "m")),
    "samples": (".csv", lambda folder: SAMPLED, read_motion),
    "arrays": (".npz", lambda folder: samples(), read_motion),
    "urdf": (".urdf", lambda folder: (Path(__file__).parents[2] / LEG).read_text(), Robot.load),
    "mjcf": (".xml", lambda folder: MJCF, Robot.load),
}
TASK, LEG = "src/pliant/tasks/catalogue/wipe.toml", "src/pliant/robots/leg3.urdf"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.filterwarnings("ignore")  # what is odd but possible is warned of
def test_a_damaged_file_is_read_or_refused_in_one_sentence(kind: str, tmp_path: Path) -> None:
    suffix, content, load = KINDS[kind]
    made = content(tmp_path)
    data = made if isinstance(made, bytes) else made.encode()
    (tmp_path / f"whole{suffix}").write_bytes(data)
    load(tmp_path / f"whole{suffix}")
    refused: list[str] = []
    for seed in range(SEEDS):
        file = tmp_path / f"{seed}{suffix}"
        file.write_bytes(damaged(data, random.Random(f"{kind} {seed}")))
        try:
            load(file)
        except PliantError as error:
            refused.append(f"{seed}: {error}")
    assert [text for text in refused if len(text) > 1000 or len(text.splitlines()) != 1] == []
    assert len(refused) > SEEDS // 5  # much of the damage is of some consequence
