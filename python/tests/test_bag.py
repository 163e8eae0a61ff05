"""Recordings of ROS as logs: they read as their tables do, bit for bit."""

from pathlib import Path

import numpy as np
import pytest

import finger_opt as fo
from finger_opt import _bag
from finger_opt.robot import bag_to_csv

pytest.importorskip("rosbags")
from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: E402
from rosbags.typesys import Stores, get_typestore  # noqa: E402

STORE = get_typestore(Stores.ROS2_HUMBLE)
T = {name.rpartition("/")[2]: kind for name, kind in STORE.types.items()}
RNG = np.random.default_rng(4)
STAMPS = [1_700_000_000_123_456_789 + 8_000_000 * i for i in range(50)]
PLACES = RNG.uniform(-0.5, 0.5, (50, 3))
FORCES = RNG.uniform(-20.0, 20.0, (50, 3))
#: About an axis of its own, by up to 0.2 rad.
QUATERNIONS = np.array([[*(np.sin(a / 2) * np.array([0.6, 0.0, 0.8])), np.cos(a / 2)] for a in np.linspace(0.0, 0.2, 50)])


def header(stamp: int, frame: str):
    return T["Header"](stamp=T["Time"](sec=stamp // 10**9, nanosec=stamp % 10**9), frame_id=frame)


def vector(row, kind: str = "Vector3"):
    return T[kind](*(float(x) for x in row))


def wrench(stamp: int, row, frame: str = "base"):
    return T["WrenchStamped"](header(stamp, frame), T["Wrench"](force=vector(row), torque=vector([0.0] * 3)))


def pose(stamp: int, place, quaternion, frame: str = "base"):
    return T["PoseStamped"](header(stamp, frame), T["Pose"](vector(place, "Point"), T["Quaternion"](*map(float, quaternion))))


def transform(stamp: int, parent: str, child: str, place, quaternion):
    return T["TransformStamped"](header(stamp, parent), child,
                                 T["Transform"](vector(place), T["Quaternion"](*map(float, quaternion))))


def record(path: Path, messages, storage=StoragePlugin.SQLITE3) -> Path:
    """``messages``: topic, type, stamp, message."""
    with Writer(path, version=9, storage_plugin=storage) as writer:
        connections = {}
        for topic, kind, stamp, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], stamp, STORE.serialize_cdr(message, kind))
    return path


W, P, TF = "geometry_msgs/msg/WrenchStamped", "geometry_msgs/msg/PoseStamped", "tf2_msgs/msg/TFMessage"


def usual(force_frame: str = "base", shift_ns: int = 0):
    for stamp, place, force, turned in zip(STAMPS, PLACES, FORCES, QUATERNIONS):
        yield "/ft/wrench", W, stamp, wrench(stamp + shift_ns, force, force_frame)
        yield "/tcp_pose", P, stamp, pose(stamp, place, turned)
        yield "/target_pose", P, stamp, pose(stamp, place + 0.001, turned)


def numbers(text: str) -> np.ndarray:
    return np.array([[float(cell) for cell in line.split(",")] for line in text.splitlines()[1:]])


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_a_recording_has_the_numbers_that_went_in_bit_for_bit(tmp_path: Path, storage) -> None:
    found = numbers(_bag.text(record(tmp_path / "bag", usual(), storage)))
    assert (found[:, 0] == (np.array(STAMPS) - STAMPS[0]) / 1e9).all()
    assert (found[:, 1:4] == PLACES).all() and (found[:, 7:10] == FORCES).all()
    assert (found[:, 10:13] == PLACES + 0.001).all()
    assert np.linalg.norm(found[:, 4:7], axis=1) == pytest.approx(np.linspace(0.0, 0.2, 50), abs=1e-12)


def test_a_single_file_reads_as_its_folder(tmp_path: Path) -> None:
    folder = record(tmp_path / "bag", usual(), StoragePlugin.MCAP)
    [file] = folder.glob("*.mcap")
    assert _bag.text(file) == _bag.text(folder)


def test_a_force_between_two_poses_has_the_pose_between_them(tmp_path: Path) -> None:
    found = numbers(_bag.text(record(tmp_path / "bag", usual(shift_ns=4_000_000))))
    # The last force is after the last pose.
    assert len(found) == 49
    assert found[:, 1:4] == pytest.approx((PLACES[1:] + PLACES[:-1]) / 2.0, abs=1e-12)


@pytest.mark.parametrize("recorded", [False, True])
def test_a_force_in_the_tool_s_frame_is_turned_into_the_base_s(tmp_path: Path, recorded: bool) -> None:
    def messages():
        for stamp, place, turned in zip(STAMPS, PLACES, QUATERNIONS):
            yield "/tf", TF, stamp, T["TFMessage"]([transform(stamp, "base", "tool0", place, turned)])

    bag = record(tmp_path / "bag", [*(messages() if recorded else ()), *usual("tool0")])
    if recorded:
        found = numbers(_bag.text(bag))
    else:
        with pytest.warns(UserWarning, match="bag: /ft/wrench is in tool0; assumed: .* pose is /tcp_pose"):
            found = numbers(_bag.text(bag))
    angle, axis = 0.2, np.array([0.6, 0.0, 0.8])
    force = FORCES[-1]
    turned = (np.cos(angle) * force + np.sin(angle) * np.cross(axis, force)
              + (1.0 - np.cos(angle)) * axis * (axis @ force))
    assert found[-1, 7:10] == pytest.approx(turned, abs=1e-12)
    assert np.linalg.norm(found[:, 7:10], axis=1) == pytest.approx(np.linalg.norm(FORCES, axis=1))


def test_transforms_are_the_pose_of_the_tool_in_the_root_of_their_tree(tmp_path: Path) -> None:
    half = [0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)]

    def messages():
        static = transform(STAMPS[0], "world", "base", [1.0, 0.0, 0.0], half)
        yield "/tf_static", TF, STAMPS[0] - 1, T["TFMessage"]([static])
        for stamp, place, force in zip(STAMPS, PLACES, FORCES):
            yield "/tf", TF, stamp, T["TFMessage"]([transform(stamp, "base", "wrist", place, [0.0, 0.0, 0.0, 1.0]),
                                                    transform(stamp, "wrist", "tool0", [0.0, 0.0, 0.1], [0.0, 0.0, 0.0, 1.0])])
            yield "/wrench", W, stamp, wrench(stamp, force, "world")

    found = numbers(_bag.text(record(tmp_path / "bag", messages())))
    # A quarter turn about z, then a metre along x.
    expected = np.column_stack([1.0 - PLACES[:, 1], PLACES[:, 0], PLACES[:, 2] + 0.1])
    assert found[:, 1:4] == pytest.approx(expected, abs=1e-12)
    assert found[:, 6] == pytest.approx(np.full(50, np.pi / 2.0))


def test_a_force_in_a_frame_of_its_own_is_turned_by_the_transforms(tmp_path: Path) -> None:
    half = [0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)]
    # The sensor's x is the world's y, and that is the base's -x.
    links = [transform(STAMPS[0], "world", "sensor", [1.0, 0.0, 0.0], half),
             transform(STAMPS[0], "world", "base", [0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 0.0])]
    static = ("/tf_static", TF, STAMPS[0] - 1, T["TFMessage"](links))
    found = numbers(_bag.text(record(tmp_path / "bag", [static, *usual("sensor")])))
    expected = np.column_stack([FORCES[:, 1], -FORCES[:, 0], FORCES[:, 2]])
    assert found[:, 7:10] == pytest.approx(expected, abs=1e-12)
    assert (found[:, 1:4] == PLACES).all()


def test_a_force_without_a_frame_is_assumed_in_that_of_the_pose(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="bag: /ft/wrench names no frame; assumed: that of /tcp_pose, base"):
        found = numbers(_bag.text(record(tmp_path / "bag", usual(""))))
    assert (found[:, 7:10] == FORCES).all()


def changed(bag):
    for i, (topic, kind, stamp, message) in enumerate(usual()):
        if topic == "/tcp_pose" and i > 60:
            message = pose(stamp, [0.0] * 3, QUATERNIONS[0], "tool0")
        yield topic, kind, stamp, message


@pytest.mark.parametrize(("messages", "words"), [
    (lambda: (m for m in usual() if m[0] != "/ft/wrench"), "no topic of type WrenchStamped for the force"),
    (lambda: (m for m in usual() if m[0] != "/tcp_pose"), "no topic of type PoseStamped for the pose"),
    (lambda: ((f"/{i % 2}", *m[1:]) if m[1] == W else m for i, m in enumerate(usual())), "several topics for the force: /0, /1"),
    (lambda: usual("sensor"), "/ft/wrench is in sensor, /tcp_pose in base, and no /tf relates them"),
    (lambda: changed(None), "/tcp_pose changes its frame from base to tool0"),
    (lambda: (m if m[1] != W else (m[0], W, m[2], wrench(STAMPS[0], FORCES[0])) for m in usual()), "does not increase"),
])
def test_what_cannot_be_a_log_is_refused_with_its_topic(tmp_path: Path, messages, words: str) -> None:
    bag = record(tmp_path / "bag", messages())
    with pytest.raises(fo.InputError, match=words):
        bag_to_csv(bag, tmp_path / "log.csv")
    assert not (tmp_path / "log.csv").exists()


def test_identify_names_what_is_wrong_with_a_recording(tmp_path: Path) -> None:
    (tmp_path / "text.mcap").write_text("no recording")
    record(tmp_path / "forceless", (m for m in usual() if m[0] != "/ft/wrench"))
    record(tmp_path / "both", ((f"/{i % 2}", *m[1:]) if m[1] == W else m for i, m in enumerate(usual())))
    words = {"text.mcap": "is not a ROS recording that rosbags can read", "forceless": "has no topic of type WrenchStamped",
             "both": "has several topics for the force: /0, /1"}
    for log, problem in words.items():
        runs = tmp_path / "runs.csv"
        runs.write_text(f"log,infill_density_percent,infill_direction_deg,offset_mm,outcome\n{log},20,10,0,inserted\n")
        with pytest.raises(fo.InputError, match=f"{log}: {problem}") as refused:
            fo.identify("usb", runs)
        assert "pip install" not in str(refused.value)


def test_topics_can_be_named(tmp_path: Path) -> None:
    bag = record(tmp_path / "bag", ((f"/{i % 2}", *m[1:]) if m[1] == W else m for i, m in enumerate(usual())))
    bag_to_csv(bag, tmp_path / "log.csv", force="/1")
    assert len(numbers((tmp_path / "log.csv").read_text())) == 25
    with pytest.raises(TypeError, match="no keyword 'wrench'"):
        bag_to_csv(bag, tmp_path / "log.csv", wrench="/1")


def test_identify_says_the_same_of_a_recording_and_of_its_table(tmp_path: Path) -> None:
    said = []
    (tmp_path / "frame.toml").write_text("origin_mm = [400.0, 0.0, 100.0]\naxis_angle_rad = [0.0, 0.0, 0.0]\n")
    bag = record(tmp_path / "bag", usual())
    bag_to_csv(bag, tmp_path / "log.csv")
    for log in ("bag", "log.csv"):
        runs = tmp_path / "runs.csv"
        runs.write_text("log,infill_density_percent,infill_direction_deg,offset_mm,outcome\n"
                        f"{log},20,10,0,inserted\n")
        # Nonsense as an attempt: what is compared is how it is read.
        with pytest.raises(ValueError) as refused:
            fo.identify("usb", runs, frame=tmp_path / "frame.toml")
        said.append(str(refused.value).replace(str(tmp_path / log), "LOG"))
    assert said[0] == said[1]
