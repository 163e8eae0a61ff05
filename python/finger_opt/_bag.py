"""Logs of attempts from ROS 2 bags, MCAP files and ROS 1 bags, through ``rosbags``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import InputError
from ._words import StrPath

Table = NDArray[np.float64]

#: Names by which a topic of poses is that of the command.
COMMANDED = ("target", "command", "desired", "setpoint", "reference", "goal")
#: Names of a tool in a tree of frames, in the order in which they are looked for.
TOOLS = ("tcp", "tool0_controller", "tool0", "flange", "ee_link")
HEADER = ["timestamp", *(f"actual_TCP_pose_{i}" for i in range(6)), *(f"actual_TCP_force_{i}" for i in range(3))]
TARGET = [f"target_TCP_pose_{i}" for i in range(6)]


class Track:
    """What a topic says over time: stamps, ns, rows of numbers, and the frame that they are in."""

    def __init__(self, topic: str) -> None:
        self.topic, self.frame = topic, ""
        self.stamps: list[int] = []
        self.rows: list[list[float]] = []

    def add(self, header: Any, row: list[float]) -> None:
        frame = str(header.frame_id).lstrip("/")
        if self.frame not in ("", frame):
            raise ValueError(f"{self.topic} changes its frame from {self.frame} to {frame}; record one")
        stamp = header.stamp.sec * 10**9 + header.stamp.nanosec
        if self.stamps and stamp <= self.stamps[-1]:
            raise ValueError(f"{self.topic}: the stamp {stamp} ns does not rise; cut the bag to one attempt")
        self.frame = frame
        self.stamps.append(stamp)
        self.rows.append(row)

    def at(self, stamps: list[int]) -> Table:
        """Its numbers at these times; a message of the same stamp as it is, else linear between two."""
        rows = np.array(self.rows)
        known = np.array(self.stamps) - self.stamps[0]
        wanted = np.array(stamps) - self.stamps[0]
        after = np.clip(np.searchsorted(known, wanted), 1, max(len(known) - 1, 1))
        if len(known) == 1:
            return np.repeat(rows, len(stamps), axis=0)
        before = after - 1
        share = ((wanted - known[before]) / (known[after] - known[before]))[:, None]
        found = rows[before] + share * (rows[after] - rows[before])
        # Not by arithmetic.
        for same in (before, after):
            found = np.where((known[same] == wanted)[:, None], rows[same], found)
        return np.asarray(found, dtype=np.float64)


def text(bag: StrPath, topics: Mapping[str, str] | None = None) -> str:
    """The log of a bag as a table in the base's frame, with the columns of an RTDE recorder: s, m, rad, N.

    The force is that of the only WrenchStamped, the pose of the only PoseStamped whose name is not one of a command,
    or of a tool in /tf; ``topics`` names others by ``force``, ``pose`` and ``target``. A force in another frame than
    the pose's is one in the tool's, and is turned.
    """
    force, pose, target = tracks(Path(bag), dict(topics or {}))
    span = [stamp for stamp in force.stamps if pose.stamps[0] <= stamp <= pose.stamps[-1]]
    if not span:
        raise ValueError(f"{force.topic} and {pose.topic} have no time in common")
    poses, forces = vectors(pose.at(span)), force.at(span)
    if force.frame not in ("", pose.frame):
        forces = np.array([turn(one[3:]) @ by for one, by in zip(poses, forces)])
    columns = [(np.array(span) - span[0])[:, None] / 1e9, poses, forces]
    header = list(HEADER)
    if target is not None:
        if target.frame != pose.frame:
            raise ValueError(f"{target.topic} is in {target.frame}, {pose.topic} in {pose.frame}; record both in one")
        columns.append(vectors(target.at(span)))
        header += TARGET
    lines = (",".join(map(repr, map(float, row))) for row in np.hstack(columns))
    return "\n".join([",".join(header), *lines]) + "\n"


def tracks(bag: Path, topics: dict[str, str]) -> tuple[Track, Track, Track | None]:
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
                of = message.wrench.force
                found[topic].add(message.header, [of.x, of.y, of.z])
            else:
                at, turned = message.pose.position, message.pose.orientation
                found[topic].add(message.header, [at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w])
    for track in found.values():
        if not track.stamps:
            raise ValueError(f"{track.topic} is empty")
    return found[force], found[pose], found[target] if target else None


def chosen(what: str, kind: str, there: Iterable[str], topics: Mapping[str, str], needed: bool = True) -> str:
    """The topic that was named, or the only one of its kind."""
    names = sorted(set(there))
    if what in topics:
        return topics[what]
    if len(names) > 1:
        raise ValueError(f"has several topics for the {what}: {', '.join(names)}; record one, or convert it by "
                         f"finger_opt.robot.bag_to_csv(.., {what}=..)")
    if not names and needed:
        raise ValueError(f"has no topic of type {kind} for the {what}; an attempt needs force and pose")
    return names[0] if names else ""


def follow(track: Track, message: Any, chain: dict[str, tuple[str, Table]]) -> None:
    """Takes in transforms, and adds the pose of the tool in the root of its tree."""
    for one in message.transforms:
        by, turned = one.transform.translation, one.transform.rotation
        place = np.array([by.x, by.y, by.z, turned.x, turned.y, turned.z, turned.w])
        chain[one.child_frame_id.lstrip("/")] = one.header.frame_id.lstrip("/"), place
    tool = next((name for name in TOOLS if name in chain), None)
    if tool is None:
        return
    frame, place = chain[tool]
    while frame in chain:
        frame, outer = chain[frame]
        place = np.concatenate([outer[:3] + rotation(outer[3:]) @ place[:3], product(outer[3:], place[3:])])
    header = message.transforms[0].header
    stamp = header.stamp.sec * 10**9 + header.stamp.nanosec
    # Static transforms have stamps of their own.
    if not track.stamps or stamp > track.stamps[-1]:
        track.frame = frame
        track.stamps.append(stamp)
        track.rows.append([float(number) for number in place])


def vectors(poses: Table) -> Table:
    """Places and rotation vectors of places and quaternions; of two vectors the one near the last."""
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
    """The matrix of a rotation vector (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross, dtype=np.float64)


def rotation(quaternion: Table) -> Table:
    return turn(vectors(np.concatenate([np.zeros(3), quaternion])[None, :])[0][3:])


def product(first: Table, second: Table) -> Table:
    """The product of two quaternions x, y, z, w."""
    v, w, u, s = first[:3], first[3], second[:3], second[3]
    return np.append(w * u + s * v + np.cross(v, u), w * s - v @ u)
