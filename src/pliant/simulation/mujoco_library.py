"""Functions of the MuJoCo library that the mujoco package has loaded, for compiled code."""

from __future__ import annotations

import ctypes
import functools
import warnings
from pathlib import Path

import mujoco

from pliant import _plant
from pliant.errors import RunFailedError

HALF_STEPS = ("mj_step1", "mj_step2")
FUNCTIONS = (
    *HALF_STEPS,
    "mj_contactForce",
    "mj_applyFT",
    "mj_rnePostConstraint",
    "mj_objectAcceleration",
    "mj_objectVelocity",
)
"""what a compiled period calls, in its order"""

_SAMPLE = """<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0.1 0 0.05"><freejoint/>
<geom size="0.06"/><site name="a"/></body><body pos="-0.1 0 0.05"><freejoint/><geom size="0.06"/></body>
</worldbody></mujoco>"""
"""a world with two contacts"""


@functools.cache
def addresses(names: tuple[str, ...]) -> tuple[int, ...]:
    """Addresses of functions in memory.

    Raises:
        RunFailedError: the package has no library, or one without such a function.
    """
    folder = Path(str(mujoco.__file__)).parent
    files = sorted([*folder.glob("libmujoco.so*"), *folder.glob("libmujoco*.dylib"), *folder.glob("mujoco.dll")])
    if not files:
        raise RunFailedError(f"no MuJoCo library in {folder}; reinstall the mujoco package")
    library = ctypes.CDLL(str(files[0]))
    found = [ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in names]
    return tuple(address for address in found if address is not None)


def mismatch() -> str:
    """Why compiled code must not access MuJoCo's structures: a sentence; empty if it may."""
    found = int(mujoco.mj_version())
    if found != _plant.MUJOCO_VERSION:
        return (
            f"pliant was compiled for MuJoCo {_version(_plant.MUJOCO_VERSION)} and found {_version(found)}: simulated"
            " robots run in Python, slower; reinstall pliant to compile it anew"
        )
    model = mujoco.MjModel.from_xml_string(_SAMPLE)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    if data.ncon < 2 or not _plant.same_layout(model, data):
        return "MuJoCo's structures differ from its headers: simulated robots run in Python"
    return ""


@functools.cache
def can_look_inside() -> bool:
    """Whether compiled code may access MuJoCo's structures; if not, a warning gives the reason, once."""
    why = mismatch()
    if why:
        warnings.warn(why, stacklevel=2)
    return not why


def _version(number: int) -> str:
    return f"{number // 1_000_000}.{number // 1000 % 1000}.{number % 1000}"
