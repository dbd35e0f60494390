"""Which geoms can touch, in which order, and whose surface rules."""

from __future__ import annotations

from pliant.simulation import Ball, Box, Scene, Surface, floor
from pliant.simulation.contact.pairs import pairs_of

SOFT, HARD = Surface(1e3), Surface(1e6)
GROUND = floor(0.0, Surface(1e4))
BOX = Box("box", (0.2, 0.2, 0.2), (0.0, 0.0, 0.1), 1.0, surface=HARD)
BALL = Ball("ball", 0.1, (0.5, 0.0, 0.1), 1.0, SOFT)
POST = Box("post", (0.2, 0.2, 0.2), (1.0, 0.0, 0.1), 0.0, surface=HARD)


def test_the_robot_meets_everything_with_the_things_own_surface() -> None:
    pairs = pairs_of(Scene((GROUND, BOX)), ["foot", "shank"])
    assert ("foot", "floor", GROUND.surface) in pairs
    assert ("shank", "box", HARD) in pairs


def test_things_meet_once_in_the_order_of_the_law_with_the_moving_or_softer_surface() -> None:
    pairs = pairs_of(Scene((GROUND, BOX, BALL, POST)), [])
    assert pairs == [
        ("box", "floor", HARD),
        ("ball", "floor", SOFT),
        ("ball", "box", SOFT),
        ("box", "post", HARD),
        ("ball", "post", SOFT),
    ]


def test_what_cannot_move_does_not_meet() -> None:
    assert pairs_of(Scene((GROUND, POST)), []) == []


def test_two_boxes_meet_through_the_corners_of_both_under_the_explicit_law_only() -> None:
    explicit = pairs_of(Scene((BOX, POST), contact="explicit"), [])
    assert [(a, b) for a, b, _ in explicit] == [("box", "post"), ("post", "box")]
    assert len(pairs_of(Scene((BOX, POST)), [])) == 1
