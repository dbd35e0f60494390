"""Controllers that are combinations: haptic exploration in front of an impedance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pydantic import Field

from pliant.controllers.attractor import Law
from pliant.controllers.config import FrameTaskConfig, StackConfig, TranslationConfig
from pliant.controllers.profiles import Shape
from pliant.controllers.registry import advise_stack, build_stack
from pliant.controllers.stack import Stack, needs_of_law
from pliant.controllers.suggest import STACK_RULES, suggest_stack
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.interfaces import Needs, ReferenceSource
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.haptic_exploration import CHANNELS, HapticExploration
from pliant.robot import Robot
from pliant.rules import Rule
from pliant.signals import ImpedanceTuning

_PROMPT = 1e-3  # s; a loop that is later than this is a late one
_DAMPED = 0.4  # damping of a mass Λ as a multiple of Λ / delay; the limit of stability is π/2
_DAMPED_PROMPT = 30.0  # 1/s; damping of the tool on its contact in a prompt loop
# largest k_I times the delay of the loop; a contact's mode of 80 rad/s with damping ratio 0.5 is unstable at 0.4
_SLOWER = 0.18
_SOFTEST = 3e3  # N/m; a contact of which nothing is believed
_FLOOR = 0.6  # of the stiffness of contact and impedance in series: the lower bound of K̂ in a late loop
_NOISES = 6.0  # standard deviations of the filtered force at which contact begins
_RULES = (
    Rule(
        "impedance.motion_damping",
        "0.4 / (period + delays) in a loop later than 1 ms, else 30 /s where the task has no impedance of its own",
        "damping of a mass with a delay T is stable up to π/2 / T",
    ),
    *(rule.under("impedance") for rule in STACK_RULES if rule.keys != "joint_damping"),
    Rule(
        "exploration.gain",
        "0.18 / (period + delays), 45 /s at most",
        "measured: 0.4 / T is unstable on a contact of 80 rad/s with damping ratio 0.5",
    ),
    Rule("exploration.seek", "on where phases say when to touch", "the task"),
    Rule(
        "exploration.stiffness_floor",
        "beyond 1 ms: 0.6 of K_0 and the believed stiffness in series, 3e3 N/m where nothing is believed",
        "a late force makes each contact seem soft within the window of K̂",
    ),
    Rule(
        "exploration.contact_o*",
        "1 N, or six standard deviations of the filtered force; half of it where contact ends",
        "white noise σ is σ √(T / (2 τ + T)) after a filter of τ",
    ),
)


class HapticConfig(ControllerConfig):
    """Haptic exploration in front of a stack of fractal impedances."""

    impedance: StackConfig = Field(description="the impedance of the frames")
    exploration: ExplorationConfig | None = Field(
        default=ExplorationConfig(), description="motion of the targets that regulates the force; none: no exploration"
    )

    def driven_frames(self) -> tuple[str, ...]:
        return self.impedance.driven_frames()

    def impedances(self) -> Mapping[str, ImpedanceTuning]:
        return self.impedance.impedances()

    def whole_tuning(self) -> ExplorationConfig | None:
        return self.exploration


def _build(robot: Robot, config: HapticConfig, period: float) -> Stack:
    return build_stack(robot, config.impedance, period)


def _advise(robot: Robot, config: HapticConfig, believed: Believed) -> tuple[str, ...]:
    return advise_stack(robot, config.impedance, believed.period, believed.late)


def _yields(config: HapticConfig) -> bool:
    return config.exploration is None or config.exploration.mode == "adaptive"


def _needs(config: HapticConfig) -> Needs:
    return replace(needs_of_law(config.impedance.law), wrench=config.exploration is not None)


def _suggest(robot: Robot, config: HapticConfig, believed: Believed) -> HapticConfig:
    """The stack that suits; where phases say when to touch, a frame that should and does not goes and looks.

    In a late loop k_I is 0.18 / (period and delays) at most, and K̂ is at least 0.6 of K_0 and the believed stiffness of
    the surface (3e3 N/m where nothing is believed) in series: force follows the target late there, so that within the
    window of K̂ each contact seems soft. What differs from the reference's motion is damped with 0.4 / (period and
    delays), in every direction: the tool on its contact and the arm on its soft rotation are springs that nothing else
    damps, and a late stiffness drives them; and self-motion of an arm with joints to spare, which the model's error of
    gravity drives. A prompt loop damps with 30 /s, unless the task says its own impedance or the algorithm is the
    printed one.
    """
    exploration, impedance = config.exploration, suggest_stack(robot, config.impedance, believed)
    if exploration is not None:
        late = believed.late
        changes: dict[str, object] = {
            "gain": min(exploration.gain, _SLOWER / late),
            "seek": exploration.seek or any(believed.phases.values()),
        }
        own = believed.presses is None or believed.presses in believed.tunings or exploration.mode == "paper"
        damping = _DAMPED / late if late > _PROMPT else impedance.motion_damping if own else _DAMPED_PROMPT
        impedance = impedance.model_copy(update={"motion_damping": damping})
        if late > _PROMPT:
            changes["stiffness_floor"] = max(exploration.stiffness_floor, _floor(impedance, believed))
        heard = _NOISES * _filtered_noise(exploration, believed)
        if heard > exploration.contact_on:
            changes |= {"contact_on": heard, "contact_off": max(0.5 * heard, exploration.contact_off)}
        exploration = exploration.model_copy(update=changes)
    return config.model_copy(update={"impedance": impedance, "exploration": exploration})


def _filtered_noise(exploration: ExplorationConfig, believed: Believed) -> float:
    """N: standard deviation of the force that begins a contact."""
    passed = believed.period / (2.0 * exploration.contact_filter + believed.period)
    return believed.noise_force * math.sqrt(passed)


def _floor(impedance: StackConfig, believed: Believed) -> float:
    """N/m: lower bound of K̂ along the softest translation of the frame that presses; 0 where it has none."""
    frame = believed.presses or believed.frames[0]
    tuning = believed.tunings.get(frame) or impedance.impedances().get(frame)
    stiffness = [] if tuning is None else [float(k) for k in tuning.stiffness[:3] if k > 0.0]
    if not stiffness:
        return 0.0
    contact = believed.stiffness or _SOFTEST
    return _FLOOR * min(stiffness) * contact / (min(stiffness) + contact)


def _filter(source: ReferenceSource[Any], robot: Robot, config: HapticConfig) -> ReferenceSource[Any]:
    return source if config.exploration is None else HapticExploration(source, config.exploration, config.impedances())


def _channels(config: HapticConfig, frames: Sequence[str]) -> Mapping[str, str]:
    return {f"exploration/{frame}/{name}": unit for frame in frames for name, unit in CHANNELS.items()}


_FOOT = FrameTaskConfig(
    frame="foot",
    translation=TranslationConfig(
        stiffness=(6000.0, 6000.0, 12000.0), force_max=(150.0, 150.0, 300.0), range=(0.025, 0.025, 0.025)
    ),
    profile=Shape.TANH,
)
_DEFAULT = HapticConfig(impedance=StackConfig(tasks={"ee": _FOOT}))


def _entry(
    name: str, summary: str, fixed: Mapping[str, Any], *, guarantees: str, regulates: bool, planner: str = ""
) -> ControllerEntry[HapticConfig]:
    plain = ControllerEntry(name, summary, _DEFAULT, _build, fixed=fixed)
    return ControllerEntry(
        name,
        summary,
        plain.over(_DEFAULT),
        _build,
        _advise,
        family="haptic",
        guarantees=guarantees,
        regulates_force=regulates,
        yields=_yields,
        needs=_needs,
        suggest=_suggest,
        rules=_RULES,
        fixed=fixed,
        filter=_filter,
        filter_channels=_channels,
        planner=planner,
    )


RECIPES: Mapping[str, ControllerEntry[Any]] = {
    entry.name: entry
    for entry in (
        _entry(
            "haptic",
            "haptic exploration in front of a fractal impedance: regulates the contact force without a"
            " model of the surface",
            {},
            guarantees="impedance as `stack`; the target moves by x_b at most",
            regulates=True,
        ),
        _entry(
            "haptic-paper",
            "the same with the algorithm and the law of Tiseo et al. 2021 as printed",
            {"impedance": {"law": Law.HAPFIC}, "exploration": {"mode": "paper"}},
            guarantees="–",
            regulates=True,
            planner="attractor",
        ),
        _entry(
            "haptic-hold",
            "the same impedance without exploration",
            {"exploration": None},
            guarantees="as `stack`",
            regulates=False,
        ),
    )
}
"""name → entry"""
