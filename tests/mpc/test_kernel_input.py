"""Bad input gets one sentence that names the rule and what was got."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest

from pliant import _mpc
from tests.twins.mpc_robots import random_chain

from .kernel_problem import polishing


def one_joint(**change: object) -> _mpc.Chain:
    data: dict[str, object] = {
        "rotations": np.eye(3)[None],
        "translations": np.zeros((1, 3)),
        "joint_types": ["revolute"],
        "axes": [[0.0, 0.0, 1.0]],
        "masses": [1.0],
        "coms": np.zeros((1, 3)),
        "inertias": np.eye(3)[None],
    }
    return _mpc.Chain(**(data | change))


CASES: list[tuple[str, Callable[[], object]]] = [
    (r"1 to 8 joints, got 0", lambda: one_joint(joint_types=[])),
    (r"1 to 8 joints, got 9", lambda: one_joint(joint_types=["revolute"] * 9)),
    (r"joint_types must be one of revolute, prismatic, got 'screw'", lambda: one_joint(joint_types=["screw"])),
    (r"axes\[0\] must have length 1", lambda: one_joint(axes=[[0.0, 0.0, 2.0]])),
    (r"masses\[0\] must not be negative, got -1", lambda: one_joint(masses=[-1.0])),
    (r"rotations\[0\] is not a rotation matrix", lambda: one_joint(rotations=-np.eye(3)[None])),
    (r"coms must have shape \(1, 3\), got \(3,\)", lambda: one_joint(coms=np.zeros(3))),
    (r"kind must be one of force_feedback, .*, got 'forcefeedback'", lambda: _mpc.Model("forcefeedback", 1)),
    (r"contact_dim must be 1, 3 or 6, got 2", lambda: _mpc.Model("classical", 2)),
    (r"contact_dim must be 0 for kind 'free', got 1", lambda: _mpc.Model("free", 1)),
    (r"axes must be one of local, world, surface, got 'LOCAL'", lambda: _mpc.Model("classical", 1, "LOCAL")),
    (r"torque_bandwidth must be positive, got 0", lambda: _mpc.Model("torque_feedback", 1, torque_bandwidth=0.0)),
    (r"integrator must be one of euler, exponential", lambda: _mpc.Model("classical", 1, integrator="rk4")),
    (r"horizon must be at least 1, got 0", lambda: _mpc.Solver(one_joint(), _mpc.Model("free", 0), 0, 1e-3)),
    (r"dt must be positive", lambda: _mpc.Node(one_joint(), _mpc.Model("free", 0), -1.0)),
    (r"valid are: sse2|valid are: neon", lambda: _mpc.use_instruction_set("mmx")),
]


@pytest.mark.parametrize(("message", "make"), CASES)
def test_construction(message: str, make: Callable[[], object]) -> None:
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("translation_weight", -1.0, r"translation_weight must be finite and not negative, but node 0 has -1"),
        ("force_weight", np.nan, r"force_weight must be finite and not negative"),
        ("stiffness", 0.0, r"stiffness of a contact must be positive, but node 0 has 0"),
        ("stiffness", 1e5, r"stiffness · dt must stay below damping, but node 0 has 100000 · 0.003 against 100"),
        ("damping", -2.0, r"damping of a contact must be positive"),
        ("rotation_reference", 0.0, r"rotation_reference must be a rotation matrix"),
        ("torque_lower", 5.0, r"torque_lower must not exceed torque_upper"),
        ("friction", -0.1, r"friction must not be negative"),
        ("state_reference", np.inf, r"state_reference must be finite"),
    ],
)
def test_node_parameters(name: str, value: float, message: str) -> None:
    solver, x0 = polishing(random_chain(7, 1))
    if name == "torque_lower":
        solver.nodes.torque_upper = 4.0
    setattr(solver.nodes, name, value)
    with pytest.raises(ValueError, match=message):
        solver.solve(x0)


def test_unknown_attribute_is_an_error() -> None:
    solver, _ = polishing(random_chain(7, 1))
    with pytest.raises(AttributeError):
        solver.nodes.force_wieght = 1.0  # type: ignore[attr-defined]


def test_shapes() -> None:
    solver, x0 = polishing(random_chain(7, 1))
    with pytest.raises(ValueError, match=r"x0 must have shape \(15,\), got \(14,\)"):
        solver.solve(x0[:-1])
    with pytest.raises(ValueError, match="us must be finite"):
        solver.solve(x0, us=np.full((5, 7), np.nan))
    with pytest.raises(ValueError, match="broadcast"):
        solver.nodes.force_reference = np.zeros((3, 3))


def test_views_write_through_and_outlive_the_solver() -> None:
    solver, _ = polishing(random_chain(7, 1))
    view = solver.nodes.force_reference
    view[2:] = 7.0
    np.testing.assert_array_equal(solver.nodes.force_reference[:, 0], [20, 20, 7, 7, 7, 7])
    solver.nodes.copy_node(5, 0)
    assert view[0, 0] == 7.0
    del solver
    assert view[5, 0] == 7.0


@pytest.mark.parametrize(("name", "code"), [("sse2", 0), ("z80", 1)])
def test_environment_variable_forces_the_instruction_set(name: str, code: int) -> None:
    if name not in (*_mpc.available_instruction_sets(), "z80"):
        pytest.skip("not on this platform")
    run = subprocess.run(
        [sys.executable, "-c", "from pliant import _mpc; print(_mpc.instruction_set())"],
        env={**os.environ, "PLIANT_ISA": name},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert run.returncode == code
    if code:
        assert "PLIANT_ISA names the instruction set 'z80'" in run.stderr
    else:
        assert run.stdout.strip() == name
