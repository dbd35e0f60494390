"""Pushes that the seed of a run draws."""

from __future__ import annotations

import itertools

import numpy as np

from pliant.experiments.pushes import pushes_of
from pliant.tasks.draws import Uniform
from pliant.tasks.parts import Disturbance

AGAIN_AND_AGAIN = Disturbance(
    frame="elbow",
    start=1.0,
    push=Uniform(uniform=(10.0, 30.0)),
    duration=Uniform(uniform=(0.2, 0.6)),
    gap=Uniform(uniform=(0.1, 0.4)),
)


def test_pushes_stay_in_their_ranges_and_repeat_with_the_seed() -> None:
    pushes = pushes_of([AGAIN_AND_AGAIN], 7, 20.0)
    assert pushes == pushes_of([AGAIN_AND_AGAIN], 7, 20.0)
    assert pushes != pushes_of([AGAIN_AND_AGAIN], 8, 20.0)
    assert len(pushes) > 15
    assert 1.1 <= pushes[0].start <= 1.4
    for push, following in itertools.pairwise(pushes):
        assert 10.0 <= np.linalg.norm(push.force) <= 30.0
        assert 0.2 <= push.duration <= 0.6
        assert 0.1 <= following.start - push.start - push.duration <= 0.4
    ways = np.array([push.force for push in pushes])
    assert np.linalg.norm(ways.mean(axis=0)) < 15.0  # in all directions: along one it would be 20 N


def test_no_push_begins_after_the_end_and_those_before_are_the_same() -> None:
    whole = pushes_of([AGAIN_AND_AGAIN], 7, 20.0)
    short = pushes_of([AGAIN_AND_AGAIN.model_copy(update={"end": 6.0})], 7, 20.0)
    assert whole[: len(short)] == short
    assert short[-1].start < 6.0 <= whole[len(short)].start
    assert pushes_of([AGAIN_AND_AGAIN], 7, 6.0) == short  # the end of the run is one, too


def test_one_push_is_as_written() -> None:
    one = Disturbance(push=(1.0, 2.0, 3.0), start=13.0, duration=0.5)
    (push,) = pushes_of([one], 0, 14.0)
    assert (push.frame, push.force, push.start, push.duration) == ("elbow", (1.0, 2.0, 3.0), 13.0, 0.5)
    assert pushes_of([one], 0, 12.0) == ()
