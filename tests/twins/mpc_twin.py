"""Python twin of one node of the MPC core, on pinocchio: values only, written to be read.

Every quantity is taken from pinocchio's own algorithms, none from the kernel; derivatives come from finite differences.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant import _mpc

from .mpc_robots import TestChain

Vector = np.ndarray
WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
LOCAL = pin.ReferenceFrame.LOCAL


@dataclass
class Twin:
    """A node: call it with (x, u) for (x_next, cost, λ, λ̇)."""

    robot: TestChain
    kind: str
    dim: int
    axes: str
    dt: float
    parameters: _mpc.Nodes
    bandwidth: float = 50.0  # Hz
    baumgarte: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        self.model = self.robot.model
        self.data = self.model.createData()
        self.tool, self.contact = (self.model.getFrameId(name) for name in ("tool", "contact"))

    # Contact in its axes -----------------------------------------------------------------------------------------

    def rows(self, six: Vector) -> Vector:
        """A frame quantity (6, …), in LOCAL or in world axes by `axes`, cut down to the contact's components."""
        if self.axes == "surface":
            six = self.in_task(six)
        return six[{0: [], 1: [2], 3: [0, 1, 2], 6: range(6)}[self.dim]]

    def in_task(self, six: Vector) -> Vector:
        """A quantity (6, …) in world axes, in those of the task."""
        to_task = self.parameters.task_rotation[0].T
        return np.concatenate([to_task @ six[:3], to_task @ six[3:]])

    def kinematics(self, q: Vector, v: Vector) -> tuple[Vector, Vector, Vector]:
        """J (m, n), ẋ = J v (m,), and dJ/dt v (m,)."""
        frame = LOCAL if self.axes == "local" else WORLD
        pin.computeJointJacobians(self.model, self.data, q)
        jacobian = self.rows(pin.computeFrameJacobian(self.model, self.data, q, self.contact, frame))
        pin.forwardKinematics(self.model, self.data, q, v, np.zeros(self.model.nv))
        acceleration = pin.getFrameAcceleration if self.axes == "local" else pin.getFrameClassicalAcceleration
        drift = self.rows(acceleration(self.model, self.data, self.contact, frame).vector)
        return jacobian, jacobian @ v, drift

    def deflection(self, q: Vector) -> Vector:
        """(m,) offset from the anchor in contact axes."""
        pin.framesForwardKinematics(self.model, self.data, q)
        placement = self.data.oMf[self.contact]
        anchor = self.parameters.anchor_rotation[0]
        linear = placement.translation - self.parameters.anchor_translation[0]
        angular = anchor @ pin.log3(anchor.T @ placement.rotation)  # world axes
        if self.axes == "local":
            linear, angular = placement.rotation.T @ linear, placement.rotation.T @ angular
        return self.rows(np.concatenate([linear, angular]))

    # Dynamics ----------------------------------------------------------------------------------------------------

    def mass(self, q: Vector) -> Vector:
        """(n, n) M(q) with rotors."""
        return np.array(pin.crba(self.model, self.data, q, pin.Convention.WORLD))

    def bias(self, q: Vector, v: Vector) -> Vector:
        """(n,) h(q, v) with joint damping."""
        return pin.rnea(self.model, self.data, q, v, np.zeros(self.model.nv)) + self.robot.damping * v

    def force(self, q: Vector, v: Vector, torque: Vector, extra: Vector) -> Vector:
        """(m,) contact force by the kind of model."""
        if self.dim == 0 or not self.parameters.contact_active[0]:
            return np.zeros(self.dim)
        if self.kind == "force_feedback":
            return extra
        jacobian, speed, drift = self.kinematics(q, v)
        if self.kind == "naive_viscoelastic":
            return -self.parameters.stiffness[0] * self.deflection(q) - self.parameters.damping[0] * speed
        n, m = len(q), self.dim
        kp, kd = self.baumgarte
        kkt = np.block([[self.mass(q), jacobian.T], [jacobian, np.zeros((m, m))]])  # [FFMPC] eq. 4
        right = np.concatenate([torque - self.bias(q, v), -drift - kd * speed - kp * self.deflection(q)])
        return -np.linalg.solve(kkt, right)[n:]

    def slid(self, rate: Vector, force: Vector) -> Vector:
        """(2,) tangential force after a step of a bristle that gives way, from the rate (2,) of one that does not."""
        K, mu = self.parameters.stiffness[0, :2], self.parameters.sliding_friction[0]
        motion = -rate / K  # ẋ + (B/K) ẍ
        speed = motion @ motion / np.sqrt(motion @ motion + 1e-3**2)
        limit = mu * (force[2] / 2 + np.sqrt(force[2] ** 2 / 4 + 1.0**2))
        return limit * (force[:2] + self.dt * rate) / (limit + self.dt * K * speed)

    def __call__(self, x: Vector, u: Vector) -> tuple[Vector, float, Vector, Vector]:
        """x_next (nx,), cost, λ (m,), λ̇ (m,)."""
        n, p, on = self.model.nv, self.parameters, self.parameters.contact_active[0]
        q, v, extra = x[:n], x[n : 2 * n], x[2 * n :]
        torque = extra if self.kind == "torque_feedback" else u
        force = self.force(q, v, torque, extra)
        jacobian, speed, drift = self.kinematics(q, v)
        acceleration = np.linalg.solve(self.mass(q), torque - self.bias(q, v) + jacobian.T @ force)
        rate, next_extra = np.zeros(self.dim), extra
        if self.kind == "force_feedback":
            if on:  # [FFMPC] eq. 18
                rate = -p.stiffness[0] * speed - p.damping[0] * (jacobian @ acceleration + drift)
                if np.isfinite(p.sliding_friction[0]):
                    rate[:2] = (self.slid(rate[:2], extra) - extra[:2]) / self.dt
            next_extra = extra + self.dt * rate
        if self.kind == "torque_feedback":  # [FFMPC] eq. 13
            alpha = np.exp(-2 * np.pi * self.bandwidth * self.dt)
            next_extra = alpha * extra + (1 - alpha) * u
        next_v = v + self.dt * acceleration
        x_next = np.concatenate([q + self.dt * next_v, next_v, next_extra])
        shown = extra if self.kind == "force_feedback" else force
        return x_next, self.cost(q, v, u, torque, jacobian, force, rate), shown, rate

    def cost(self, q: Vector, v: Vector, u: Vector, torque: Vector, J: Vector, force: Vector, rate: Vector) -> float:
        """dt · ½ Σ w r², [FFMPC] eq. 25–29."""
        p, m = self.parameters, self.model
        pin.forwardKinematics(m, self.data, q, v)
        placement = pin.updateFramePlacement(m, self.data, self.tool)
        velocity = pin.getFrameVelocity(m, self.data, self.tool, WORLD).vector
        load = pin.rnea(m, self.data, q, np.zeros(m.nv), np.zeros(m.nv)) - J.T @ force
        on = float(p.contact_active[0])
        terms = [
            (p.state_weight, np.concatenate([q, v]) - p.state_reference[0]),
            (p.control_weight, u - p.control_reference[0]),
            (p.torque_gravity_weight, torque - load),
            (p.control_gravity_weight, (u - load) * (self.kind == "torque_feedback")),
            (p.translation_weight, p.task_rotation[0].T @ (placement.translation - p.translation_reference[0])),
            (p.rotation_weight, pin.log3(p.rotation_reference[0].T @ placement.rotation)),
            (p.velocity_weight, self.in_task(velocity - p.velocity_reference[0])),
            (p.force_weight * on, force - p.force_reference[0]),
            (p.force_rate_weight * on, rate * (self.kind == "force_feedback")),
        ]
        return 0.5 * self.dt * sum(float(weight[0] @ residual**2) for weight, residual in terms)


def randomise(p: _mpc.Nodes, seed: int) -> None:
    """Every weight positive, every reference away from zero."""
    rng = np.random.default_rng(seed)
    for name in ("state", "control", "translation", "rotation", "velocity", "force"):
        getattr(p, f"{name}_weight")[...] = rng.uniform(0.1, 1.0, getattr(p, f"{name}_weight").shape)
        if name != "rotation":
            getattr(p, f"{name}_reference")[...] = rng.normal(size=getattr(p, f"{name}_reference").shape)
    p.torque_gravity_weight = rng.uniform(0.1, 1.0, p.torque_gravity_weight.shape)
    p.control_gravity_weight = rng.uniform(0.1, 1.0, p.control_gravity_weight.shape)
    p.force_rate_weight = rng.uniform(1e-4, 1e-3, p.force_rate_weight.shape)
    p.stiffness = rng.uniform(100.0, 1000.0, p.stiffness.shape)
    p.damping = rng.uniform(10.0, 100.0, p.damping.shape)
    p.anchor_translation = rng.normal(size=p.anchor_translation.shape)
    for name in ("rotation_reference", "anchor_rotation", "task_rotation"):
        getattr(p, name)[...] = [pin.exp3(rng.normal(size=3)) for _ in range(p.count)]


KINDS = ("force_feedback", "classical", "torque_feedback", "free", "naive_viscoelastic")
AXES = ("local", "world", "surface")


def node_and_twin(
    robot: TestChain, kind: str, dim: int, axes: str, seed: int = 0, dt: float = 3e-3, active: bool = True
) -> tuple[_mpc.Node, Twin]:
    """The kernel's node and its twin, sharing random parameters."""
    baumgarte = (3.0, 10.0)
    model = _mpc.Model(kind, dim, axes, baumgarte=baumgarte, torque_bandwidth=40.0)
    node = _mpc.Node(robot.chain, model, dt)
    randomise(node.parameters, seed)
    node.parameters.contact_active = active
    return node, Twin(robot, kind, dim, axes, dt, node.parameters, 40.0, baumgarte)


def random_point(node: _mpc.Node, robot: TestChain, seed: int) -> tuple[Vector, Vector]:
    """A state near the robot's home with speeds of 1 rad/s and forces of 5 N, and a torque of 5 N·m."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=node.nx)
    n = robot.model.nv
    x[:n] = robot.home + 0.3 * x[:n]
    x[2 * n :] *= 5.0
    return x, 5.0 * rng.normal(size=n)
