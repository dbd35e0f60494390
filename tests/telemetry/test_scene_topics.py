"""Frames, shapes, paths and forces in a log, as readers see them that share no code with pliant."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.robot import Robot
from pliant.spatial import rotation_of_quaternion
from pliant.telemetry import Log
from pliant.telemetry.mcap.scene_messages import MARKERS, SCENE_DEFINITIONS, TRANSFORMS
from pliant.telemetry.scene_markers import markers_of
from pliant.visual_shapes import Look

STORE = get_typestore(Stores.ROS2_HUMBLE)
DURATION = 0.6  # s
TOPICS = {"/tf": TRANSFORMS, "/pliant/scene": MARKERS, "/pliant/path": MARKERS, "/pliant/force": MARKERS}


def recorded(folder: Path, **changes: Any) -> Path:
    """A leg pushes a box, whose frames and shapes are in the log."""
    study = get_study("haptic")
    config = study.case("box-tip").model_copy(update={"duration": DURATION, **changes})
    result = run_case(study, config, folder, figures=False)
    assert result.log is not None
    return result.log


def read(path: Path) -> dict[str, list[tuple[int, bytes, Any]]]:
    """Topic → time (ns), bytes and message, with ROS 2's own definitions instead of those in the file."""
    found: dict[str, list[tuple[int, bytes, Any]]] = {}
    with AnyReader([path]) as reader:
        for connection, time, data in reader.messages():
            if connection.topic in TOPICS:
                assert connection.msgtype == TOPICS[connection.topic]
                message = STORE.deserialize_cdr(data, connection.msgtype)
                found.setdefault(connection.topic, []).append((time, bytes(data), message))
    return found


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded(tmp_path_factory.mktemp("scene"))


@pytest.fixture(scope="module")
def topics(path: Path) -> dict[str, list[tuple[int, bytes, Any]]]:
    return read(path)


def test_the_bytes_are_those_that_another_writer_makes(topics: dict[str, list[tuple[int, bytes, Any]]]) -> None:
    assert set(topics) == set(TOPICS)
    for topic, messages in topics.items():
        for _, data, message in messages:
            assert bytes(STORE.serialize_cdr(message, TOPICS[topic])) == data


def test_the_definitions_in_the_file_are_those_of_ros_2() -> None:
    for name, text in SCENE_DEFINITIONS.items():
        for kind, (_, fields) in get_types_from_msg(text, name).items():
            assert fields == STORE.fielddefs[kind][1], kind


def test_frames_are_where_pinocchio_has_them(path: Path, topics: dict[str, list[tuple[int, bytes, Any]]]) -> None:
    log, robot = Log.open(path), Robot.load("leg3")
    data = robot.model.createData()
    moved = 0
    for time, _, message in topics["/tf"]:
        row = int(np.argmin(np.abs(log.time("truth/q") - time * 1e-9)))
        pin.framesForwardKinematics(robot.model, data, log["truth/q"][row])
        for one in message.transforms:
            assert one.header.frame_id == "world"
            assert one.header.stamp.sec * 10**9 + one.header.stamp.nanosec == time
            place, turn = one.transform.translation, one.transform.rotation
            position = np.array([place.x, place.y, place.z])
            if one.child_frame_id == "box":
                np.testing.assert_allclose(position, log["truth/objects/box/pose"][row][:3], atol=1e-12)
            elif robot.model.existFrame(one.child_frame_id):
                pose = data.oMf[robot.model.getFrameId(one.child_frame_id)]
                np.testing.assert_allclose(position, pose.translation, atol=1e-9)
                R = rotation_of_quaternion([turn.w, turn.x, turn.y, turn.z])
                np.testing.assert_allclose(R, pose.rotation, atol=1e-9)
                moved += 1
    assert moved >= 3 * len(topics["/tf"])  # the three joints at least: a wrong name would compare nothing


def test_the_tree_is_whole_and_30_hz(topics: dict[str, list[tuple[int, bytes, Any]]]) -> None:
    """Every marker moves with the world or a frame that each message of /tf has: else a view would not draw it."""
    frames = [{one.child_frame_id for one in message.transforms} for _, _, message in topics["/tf"]]
    assert all(found == frames[0] for found in frames)
    assert "foot_world_aligned" in frames[0]  # what the wrenches of the log refer to
    for topic in ("/pliant/scene", "/pliant/path", "/pliant/force"):
        for _, _, message in topics[topic]:
            assert {marker.header.frame_id for marker in message.markers} <= frames[0] | {"world"}
    assert len(topics["/tf"]) == pytest.approx(30 * DURATION, abs=1)


def test_robot_scene_and_path_are_there_from_the_first_sample(
    path: Path, topics: dict[str, list[tuple[int, bytes, Any]]]
) -> None:
    ((time, _, scene),) = topics["/pliant/scene"]
    assert time == round(1e9 * Log.open(path).time()[0])
    assert {marker.ns for marker in scene.markers} == {"robot", "scene"}
    box = [marker for marker in scene.markers if marker.header.frame_id == "box"]
    assert [[one.scale.x, one.scale.y, one.scale.z] for one in box] == [[0.12, 0.2, 0.2]]
    assert len({(marker.ns, marker.id) for marker in scene.markers}) == len(scene.markers)
    ((begin, _, paths),) = topics["/pliant/path"]
    assert begin == time
    log = Log.open(path)
    for marker in paths.markers:
        signal, _, _, frame = marker.ns.split()
        last = marker.points[-1]
        end = log[f"{signal}/{frame}/position"][-1]
        assert np.linalg.norm([last.x, last.y, last.z] - end) < 8e-3  # a thirtieth of a second at 0.2 m/s
    assert {marker.ns for marker in paths.markers} == {"reference path of foot", "truth path of foot"}


def test_switched_off_nothing_is_added_and_the_numbers_are_the_same(path: Path, tmp_path: Path) -> None:
    off = recorded(tmp_path, log_scene=False)
    assert read(off) == {}
    with_scene, without = Log.open(path), Log.open(off)
    assert set(with_scene.channels) == set(without.channels)
    for name in without.channels:
        np.testing.assert_array_equal(with_scene[name], without[name])


def test_a_fine_mesh_is_drawn_coarser_and_stays_in_its_place() -> None:
    n = 200
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0.0, 0.3, n), np.linspace(0.0, 0.2, n)))
    vertices = np.column_stack([x, y, 0.02 * np.sin(20.0 * x)]).astype(np.float32)
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel()
    faces = np.vstack([np.column_stack([a, b, c]), np.column_stack([b, d, c])]).astype(np.int32)
    look = Look("0", 0, False, "mesh", (0, 0, 0), (0, 0, 0), (1, 0, 0, 0), (1, 1, 1, 1), vertices, faces)
    (marker,) = markers_of([look], lambda body: "world")
    assert marker.points is not None
    assert 1000 < len(marker.points) // 3 <= 20_000 < len(faces)
    nearest = [np.linalg.norm(vertices - point, axis=1).min() for point in marker.points[::501]]
    assert max(nearest) < 0.3 / 64
    for side in (np.min, np.max):
        np.testing.assert_allclose(side(marker.points, axis=0), side(vertices, axis=0), atol=0.3 / 64)
