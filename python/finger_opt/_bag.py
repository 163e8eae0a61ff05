"""Reads logs of attempts from ROS 2 bags, MCAP files and ROS 1 bags, through ``rosbags``."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import InputError
from ._words import StrPath

Table = NDArray[np.float64]
#: Parent of each frame, and its pose there: m, quaternion x, y, z, w.
Tree = dict[str, tuple[str, Table]]

#: Words in the name of a pose topic that mark it as the commanded pose.
COMMANDED = ("target", "command", "desired", "setpoint", "reference", "goal")
#: Frame names of a tool in /tf, in order of preference.
TOOLS = ("tcp", "tool0_controller", "tool0", "flange", "ee_link", "tool")
#: Columns of the table, and further columns with a commanded pose.
HEADER = ["timestamp", *(f"actual_TCP_pose_{i}" for i in range(6)), *(f"actual_TCP_force_{i}" for i in range(3))]
TARGET = [f"target_TCP_pose_{i}" for i in range(6)]


class Track:
    """Time series of a topic: stamps, ns, rows of numbers, and their frame."""

    def __init__(self, topic: str) -> None:
        self.topic, self.frame = topic, ""
        self.stamps: list[int] = []
        self.rows: list[list[float]] = []

    def add(self, header: Any, row: list[float]) -> None:
        """Appends a message; raises ValueError if its frame changes or its stamp does not increase."""
        frame = str(header.frame_id).lstrip("/")
        if self.frame not in ("", frame):
            raise ValueError(f"{self.topic} changes its frame from {self.frame} to {frame}; record it in one frame")
        stamp = header.stamp.sec * 10**9 + header.stamp.nanosec
        if self.stamps and stamp <= self.stamps[-1]:
            raise ValueError(f"{self.topic}: the stamp {stamp} ns does not increase; cut the bag to one attempt")
        self.frame = frame
        self.stamps.append(stamp)
        self.rows.append(row)

    def at(self, stamps: list[int]) -> Table:
        """Returns the rows at these stamps, ns: that of a message with this stamp, else linearly interpolated."""
        rows = np.array(self.rows)
        known = np.array(self.stamps) - self.stamps[0]
        times = np.array(stamps) - self.stamps[0]
        after = np.clip(np.searchsorted(known, times), 1, max(len(known) - 1, 1))
        if len(known) == 1:
            return np.repeat(rows, len(stamps), axis=0)
        before = after - 1
        share = ((times - known[before]) / (known[after] - known[before]))[:, None]
        found = rows[before] + share * (rows[after] - rows[before])
        # Rows of equal stamps without rounding errors.
        for exact in (before, after):
            found = np.where((known[exact] == times)[:, None], rows[exact], found)
        return np.asarray(found, dtype=np.float64)


def text(bag: StrPath, topics: Mapping[str, str] | None = None) -> str:
    """Returns the log of a bag as CSV in the base frame, with the columns of an RTDE recorder: s, m, rad, N.

    The force is the only WrenchStamped; the pose is the only PoseStamped that is not named like a command, or else a
    tool in /tf; ``topics`` selects other topics by ``force``, ``pose`` and ``target``. A force in another frame than
    the pose is rotated by /tf or, if it is in a tool frame, by the pose; that assumption is a warning. Raises
    InputError, which begins with the bag, if a log cannot be made.
    """
    try:
        return table(Path(bag), dict(topics or {}))
    except ValueError as error:
        raise InputError(f"{bag}: {error}") from error
    except Exception as error:
        raise InputError(f"{bag}: is not a ROS recording that rosbags can read: {error}") from error


def table(bag: Path, topics: dict[str, str]) -> str:
    """Returns the log of a bag as CSV; raises ValueError if a log cannot be made."""
    force, pose, target, transforms = tracks(bag, topics)
    span = [stamp for stamp in force.stamps if pose.stamps[0] <= stamp <= pose.stamps[-1]]
    if not span:
        raise ValueError(f"{force.topic} and {pose.topic} have no time in common")
    poses, forces = vectors(pose.at(span)), force.at(span)
    if force.frame != pose.frame:
        turns, assumed = rotations(force, pose, transforms, poses, span)
        forces = np.array([turn(vector) @ row for vector, row in zip(turns, forces)])
        if assumed:
            warnings.warn(f"{bag}: {assumed}", stacklevel=3)
    columns = [(np.array(span) - span[0])[:, None] / 1e9, poses, forces]
    header = list(HEADER)
    if target is not None:
        if target.frame != pose.frame:
            frames = f"{target.topic} is in {target.frame}, {pose.topic} in {pose.frame}"
            raise ValueError(f"{frames}; record both in the same frame")
        columns.append(vectors(target.at(span)))
        header += TARGET
    lines = (",".join(map(repr, map(float, row))) for row in np.hstack(columns))
    return "\n".join([",".join(header), *lines]) + "\n"


def rotations(force: Track, pose: Track, transforms: list[Any], poses: Table, span: list[int]) -> tuple[Table, str]:
    """Returns rotation vectors from the force's frame to the pose's at these stamps, rad, and what they assume.

    Raises ValueError if the frames are not related.
    """
    def related(tree: Tree) -> tuple[str, Table] | None:
        (root, inner), (other, outer) = placed(force.frame, tree), placed(pose.frame, tree)
        back = outer[3:] * np.array([-1.0, -1.0, -1.0, 1.0])
        return (pose.frame, np.concatenate([np.zeros(3), product(back, inner[3:])])) if root == other else None

    found = Track("/tf")
    follow(found, transforms, related)
    if found.stamps:
        return vectors(found.at([min(max(stamp, found.stamps[0]), found.stamps[-1]) for stamp in span]))[:, 3:], ""
    if not force.frame or not pose.frame:
        unnamed, other = (force, pose) if not force.frame else (pose, force)
        return np.zeros((len(span), 3)), f"{unnamed.topic} names no frame; assumed: that of {other.topic}, {other.frame}"
    if force.frame.endswith(TOOLS):
        return poses[:, 3:], f"{force.topic} is in {force.frame}; assumed: this is the frame whose pose is {pose.topic}"
    raise ValueError(f"{force.topic} is in {force.frame}, {pose.topic} in {pose.frame}, and no /tf relates them; record "
                     "/tf and /tf_static, too, or both topics in one frame")


def tracks(bag: Path, topics: dict[str, str]) -> tuple[Track, Track, Track | None, list[Any]]:
    """Reads force, pose and, if recorded, commanded pose; and the messages of /tf and /tf_static."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise ValueError("needs rosbags: pip install rosbags") from error
    with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        kinds: dict[str, list[str]] = {}
        for connection in reader.connections:
            kinds.setdefault(connection.msgtype.rpartition("/")[2], []).append(connection.topic)
        posed = sorted(set(kinds.get("PoseStamped", [])))
        ordered = [topic for topic in posed if any(word in topic.lower() for word in COMMANDED)]
        force = chosen("force", "WrenchStamped", kinds.get("WrenchStamped", []), topics)
        target = topics.get("target") or chosen("target", "PoseStamped", ordered, topics, needed=False)
        actual = [topic for topic in posed if topic not in ordered]
        tree = not actual and "pose" not in topics and "TFMessage" in kinds
        pose = "/tf" if tree else chosen("pose", "PoseStamped", actual, topics)
        found = {topic: Track(str(topic)) for topic in (force, pose, target) if topic}
        transforms: list[Any] = []
        for connection, _, raw in reader.messages():
            topic = connection.topic
            if topic not in (*found, "/tf", "/tf_static"):
                continue
            message: Any = reader.deserialize(raw, connection.msgtype)
            if topic in ("/tf", "/tf_static"):
                transforms.append(message)
            elif topic == force:
                vector = message.wrench.force
                found[topic].add(message.header, [vector.x, vector.y, vector.z])
            else:
                at, turned = message.pose.position, message.pose.orientation
                found[topic].add(message.header, [at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w])
    if pose == "/tf":
        follow(found[pose], transforms, tool)
    for track in found.values():
        if not track.stamps:
            raise ValueError(f"{track.topic} has no messages")
    return found[force], found[pose], found[target] if target else None, transforms


def chosen(role: str, kind: str, available: Iterable[str], topics: Mapping[str, str], needed: bool = True) -> str:
    """Returns the selected topic, or the only one of its type; raises ValueError if it is ambiguous or missing."""
    names = sorted(set(available))
    if role in topics:
        return topics[role]
    if len(names) > 1:
        raise ValueError(f"has several topics for the {role}: {', '.join(names)}; record one of them, or select it: "
                         f"finger_opt.robot.bag_to_csv(bag, 'log.csv', {role}='{names[0]}')")
    if not names and needed:
        raise ValueError(f"has no topic of type {kind} for the {role}; an attempt needs force and pose")
    return names[0] if names else ""


def follow(track: Track, messages: list[Any], pose_in: Callable[[Tree], tuple[str, Table] | None]) -> None:
    """Appends frame and pose that ``pose_in`` finds in the tree of transforms after each message, if any."""
    tree: Tree = {}
    for message in messages:
        for link in message.transforms:
            shift, turned = link.transform.translation, link.transform.rotation
            pose = np.array([shift.x, shift.y, shift.z, turned.x, turned.y, turned.z, turned.w])
            tree[link.child_frame_id.lstrip("/")] = link.header.frame_id.lstrip("/"), pose
        found = pose_in(tree)
        if found is None or not message.transforms:
            continue
        header = message.transforms[0].header
        stamp = header.stamp.sec * 10**9 + header.stamp.nanosec
        # Messages of static transforms may have older stamps.
        if not track.stamps or stamp > track.stamps[-1]:
            track.frame = found[0]
            track.stamps.append(stamp)
            track.rows.append([float(number) for number in found[1]])


def tool(tree: Tree) -> tuple[str, Table] | None:
    """Returns the root of the tool's tree and the tool's pose in it; None without a tool."""
    name = next((name for name in TOOLS if name in tree), None)
    return None if name is None else placed(name, tree)


def placed(frame: str, tree: Tree) -> tuple[str, Table]:
    """Returns the root of a frame's tree, and the frame's pose in it."""
    pose = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    while frame in tree:
        frame, outer = tree[frame]
        pose = np.concatenate([outer[:3] + rotation(outer[3:]) @ pose[:3], product(outer[3:], pose[3:])])
    return frame, pose


def vectors(poses: Table) -> Table:
    """Converts poses with quaternions to poses with rotation vectors, each continuous with the one before."""
    found: list[Table] = []
    for pose in poses:
        quaternion = pose[3:] / np.linalg.norm(pose[3:])
        sine = float(np.linalg.norm(quaternion[:3]))
        angle = 2.0 * float(np.arctan2(sine, quaternion[3]))
        axis = quaternion[:3] / sine if sine > 0.0 else np.zeros(3)
        vector = angle * axis
        if found:
            other = vector - 2.0 * np.pi * axis
            last = found[-1][3:]
            vector = min((vector, other), key=lambda one: float(np.linalg.norm(one - last)))
        found.append(np.concatenate([pose[:3], vector]))
    return np.array(found)


def turn(vector: Table) -> Table:
    """Returns the matrix of a rotation vector, rad (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross, dtype=np.float64)


def rotation(quaternion: Table) -> Table:
    """Returns the matrix of a quaternion x, y, z, w."""
    return turn(vectors(np.concatenate([np.zeros(3), quaternion])[None, :])[0][3:])


def product(first: Table, second: Table) -> Table:
    """Returns the product of two quaternions x, y, z, w."""
    v, w, u, s = first[:3], first[3], second[:3], second[3]
    return np.append(w * u + s * v + np.cross(v, u), w * s - v @ u)
