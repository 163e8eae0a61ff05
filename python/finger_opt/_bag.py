"""Reads logs of attempts from ROS 2 bags, MCAP files and ROS 1 bags, through ``rosbags``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import InputError
from ._words import StrPath

Table = NDArray[np.float64]

#: Words in the name of a pose topic that mark it as the commanded pose.
COMMANDED = ("target", "command", "desired", "setpoint", "reference", "goal")
#: Frame names of a tool in /tf, in order of preference.
TOOLS = ("tcp", "tool0_controller", "tool0", "flange", "ee_link")
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
    the pose is assumed to be in the tool frame, and is rotated. Raises ValueError if a log cannot be made.
    """
    force, pose, target = tracks(Path(bag), dict(topics or {}))
    span = [stamp for stamp in force.stamps if pose.stamps[0] <= stamp <= pose.stamps[-1]]
    if not span:
        raise ValueError(f"{force.topic} and {pose.topic} have no time in common")
    poses, forces = vectors(pose.at(span)), force.at(span)
    if force.frame not in ("", pose.frame):
        forces = np.array([turn(at[3:]) @ vector for at, vector in zip(poses, forces)])
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


def tracks(bag: Path, topics: dict[str, str]) -> tuple[Track, Track, Track | None]:
    """Reads force, pose and, if recorded, commanded pose."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise InputError(f"{bag}: needs rosbags: pip install 'finger-opt[ros]'") from error
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
        chain: dict[str, tuple[str, Table]] = {}
        for connection, _, raw in reader.messages():
            topic = connection.topic
            if not (topic in found or (tree and topic in ("/tf", "/tf_static"))):
                continue
            message: Any = reader.deserialize(raw, connection.msgtype)
            if topic in ("/tf", "/tf_static"):
                follow(found[pose], message, chain)
            elif topic == force:
                vector = message.wrench.force
                found[topic].add(message.header, [vector.x, vector.y, vector.z])
            else:
                at, turned = message.pose.position, message.pose.orientation
                found[topic].add(message.header, [at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w])
    for track in found.values():
        if not track.stamps:
            raise ValueError(f"{track.topic} has no messages")
    return found[force], found[pose], found[target] if target else None


def chosen(role: str, kind: str, available: Iterable[str], topics: Mapping[str, str], needed: bool = True) -> str:
    """Returns the selected topic, or the only one of its type; raises ValueError if it is ambiguous or missing."""
    names = sorted(set(available))
    if role in topics:
        return topics[role]
    if len(names) > 1:
        raise ValueError(f"has several topics for the {role}: {', '.join(names)}; record one, or select it with "
                         f"finger_opt.robot.bag_to_csv(.., {role}=..)")
    if not names and needed:
        raise ValueError(f"has no topic of type {kind} for the {role}; an attempt needs force and pose")
    return names[0] if names else ""


def follow(track: Track, message: Any, chain: dict[str, tuple[str, Table]]) -> None:
    """Updates the transforms, and appends the pose of the tool in the root frame to the track."""
    for link in message.transforms:
        shift, turned = link.transform.translation, link.transform.rotation
        pose = np.array([shift.x, shift.y, shift.z, turned.x, turned.y, turned.z, turned.w])
        chain[link.child_frame_id.lstrip("/")] = link.header.frame_id.lstrip("/"), pose
    tool = next((name for name in TOOLS if name in chain), None)
    if tool is None:
        return
    frame, pose = chain[tool]
    while frame in chain:
        frame, outer = chain[frame]
        pose = np.concatenate([outer[:3] + rotation(outer[3:]) @ pose[:3], product(outer[3:], pose[3:])])
    header = message.transforms[0].header
    stamp = header.stamp.sec * 10**9 + header.stamp.nanosec
    # Messages of static transforms may have older stamps.
    if not track.stamps or stamp > track.stamps[-1]:
        track.frame = frame
        track.stamps.append(stamp)
        track.rows.append([float(number) for number in pose])


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
