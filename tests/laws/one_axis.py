"""A mass on one axis, pulled by a scalar fractal impedance, that touches a spring: the twin of a leg on a floor."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.references.schedule import LatestReference
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference

FOOT = "foot"


@dataclass
class Impedance:
    """Hyperbolic-tangent profile, capped convergence, phases from the rate of the error."""

    K_0: float = 12000.0  # N/m
    F_max: float = 300.0  # N
    x_b: float = 0.025  # m
    turning: float = 0.0
    converging: bool = False
    last: float | None = None
    rate: float = 0.0
    held: float = 0.0

    def profile(self, error: float) -> float:
        x_0 = min(0.95 * self.x_b, 0.95 * self.F_max / self.K_0)
        a = abs(error)
        if a <= x_0:
            return self.K_0 * error
        F_0, w = self.K_0 * x_0, (self.x_b - x_0) / (2 * math.pi)
        rise = (math.tanh((a - self.x_b) / w + math.pi) + math.tanh(math.pi)) / (1 + math.tanh(math.pi))
        return math.copysign(F_0 + (self.F_max - F_0) * rise, error)

    def step(self, error: float, period: float) -> float:
        last = error if self.last is None else self.last
        self.last = error
        self.rate += (1 - math.exp(-500 * period)) * ((error - last) / period - self.rate)
        outward = math.copysign(1.0, error) * self.rate
        if error * self.turning <= 0 or abs(error) >= abs(self.turning) or outward > 5e-4:
            self.converging, self.held = False, 0.0
        elif outward < -5e-4:
            self.converging, self.held = True, 0.0
        else:
            self.held += period
            self.converging = self.converging and self.held <= 0.03
        if not self.converging:
            self.turning = error
            return self.profile(error)
        share = error / self.turning
        m = max(share, 1 - share)
        size = min(abs(self.profile(self.turning)) * (2 * m - 1), abs(self.profile(m * self.turning)))
        return math.copysign(size, self.turning) * (1.0 if share >= 0.5 else -1.0)


@dataclass
class World:
    """A mass over a surface at x = 0 that pushes upwards; `side` = −1 turns everything upside down."""

    mass: float = 1.5  # kg
    stiffness: float = 1e6  # N/m
    damping: float = 1e3  # N s/m
    side: float = 1.0
    x: float = 0.0
    v: float = 0.0
    force: float = 0.0
    drag: float = 0.0  # N s/m, acts always
    pushed: float = field(default=0.0)  # N, disturbance

    def step(self, command: float, period: float, dt: float = 2e-5) -> None:
        for _ in range(max(1, round(period / dt))):
            depth, speed = -self.side * self.x, -self.side * self.v
            force = 0.0
            if depth > 0:
                s = min(depth / 1e-3, 1.0)
                force = max(0.0, s * s * (3 - 2 * s) * (self.stiffness * depth + self.damping * speed))
            self.force = self.side * force
            self.v += (command + self.force + self.pushed - self.drag * self.v) / self.mass * dt
            self.x += self.v * dt


@dataclass
class Log:
    time: np.ndarray
    force: np.ndarray
    offset: np.ndarray
    command: np.ndarray
    x: np.ndarray
    phase: np.ndarray
    unreachable: np.ndarray
    reachable: np.ndarray


def tuning(K_0: float = 12000.0, F_max: float = 300.0, x_b: float = 0.025) -> ImpedanceTuning:
    return ImpedanceTuning(np.full(3, K_0), np.full(3, F_max), np.full(3, x_b))


def reference(z: float, F_d: float, tuned: ImpedanceTuning, config: ExplorationConfig | None = None) -> Reference:
    task = TaskReference(FOOT, np.array([0.0, 0.0, z]), wrench=np.array([0, 0, F_d, 0, 0, 0]), tuning=tuned)
    return Reference(0.0, (task,), tuning=config)


def run(world, events, seconds, config=None, period=1e-3, noise=0.0, seed=0, impedance=None, delay=0, dt=2e-5) -> Log:
    """Closed loop. events: [(time, z, F_d, tuning, config or None)], in order."""
    random = np.random.default_rng(seed)
    mailbox = LatestReference(reference(*events[0][1:4]))
    source = HapticExploration(mailbox, config or ExplorationConfig())
    zero = np.zeros(1)
    state = source.init(Estimate(0.0, zero, zero, zero, zero))
    fic = impedance or Impedance()
    rows, pending, forces = [], list(events), []
    for tick in range(round(seconds / period)):
        t = tick * period
        while pending and t >= pending[0][0] - 1e-9:
            mailbox.put(reference(*pending.pop(0)[1:]))
        felt = world.force + noise * random.normal()
        forces.append(felt)
        late = forces[max(0, len(forces) - 1 - delay)]
        wrench = np.array([0, 0, late, 0, 0, 0])
        shifted, state = source.step(Estimate(t, zero, zero, zero, zero, {FOOT: wrench}), state)
        task = shifted.tasks[0]
        assert task.tuning is not None
        fic.K_0, fic.F_max, fic.x_b = (
            float(v[2]) for v in (task.tuning.stiffness, task.tuning.force_max, task.tuning.range)
        )
        command = fic.step(float(task.position[2]) - world.x, period)
        d = shifted.diagnostics
        channel = {
            n: float(d[f"exploration/{FOOT}/{n}"][2]) if f"exploration/{FOOT}/{n}" in d else 0.0
            for n in ("offset", "phase", "unreachable", "reachable", "stiffness")
        }
        rows.append(
            (
                t,
                world.force,
                channel["offset"],
                command,
                world.x,
                channel["phase"],
                channel["unreachable"],
                channel["reachable"],
            )
        )
        world.step(command, period, dt)
    return Log(*np.array(rows).T)
