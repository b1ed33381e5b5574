"""Reads the files of `kinstep plan --out FOLDER --format all` with programs that know nothing of kinstep, and asserts that
every value is the one of the table, to the last bit: times of messages in nanoseconds, all others as doubles.

The readers: Python's csv, numpy.load, pyarrow, PyYAML, mcap with mcap-ros2-support, and rosbags. Usage: read_back.py FOLDER
"""

import csv
import json
import pathlib
import sys

import numpy
import pyarrow.parquet
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader


def bits(values):
    """The doubles as bytes: equal bits, signs of zeros included."""
    return numpy.ascontiguousarray(values, dtype="<f8").tobytes()


def assert_same(what, read, expected):
    assert numpy.shape(read) == numpy.shape(expected), (what, numpy.shape(read), numpy.shape(expected))
    assert bits(read) == bits(expected), what


class Table:
    """The table, by the header in its first line."""

    def __init__(self, folder):
        with open(folder / "trajectory.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.names = rows[0]
        values = numpy.array([[float(text) for text in row] for row in rows[1:]])
        self.columns = dict(zip(self.names, values.T))
        self.times = self.columns["t"]
        self.nanoseconds = [round(float(t) * 1e9) for t in self.times]
        self.arms = list(dict.fromkeys(name.split(".", 1)[0] for name in self.names[1:]))

    def joints(self, arm):
        own = [name[len(arm) + 1 :] for name in self.names if name.startswith(f"{arm}.")]
        return [name for name in own if f"{name}.velocity" in own]

    def positions(self, arm):
        return numpy.array([self.columns[f"{arm}.{joint}"] for joint in self.joints(arm)]).T

    def velocities(self, arm):
        return numpy.array([self.columns[f"{arm}.{joint}.velocity"] for joint in self.joints(arm)]).T

    def errors(self, arm):
        return self.columns[f"{arm}.error"]


def check_metadata(folder, table):
    """CSV on the Web: the columns are those of the table, in their order, all of them doubles."""
    document = json.loads((folder / "trajectory.csv-metadata.json").read_text(encoding="utf-8"))
    assert document["@context"] == "http://www.w3.org/ns/csvw"
    columns = document["tableSchema"]["columns"]
    assert [column["titles"] for column in columns] == table.names
    assert {column["datatype"] for column in columns} == {"double"}
    about = dict(document["notes"][0]["kinstep"])
    assert len(about["kinstep.scenario_sha256"]) == 64
    return about


def check_arrays(folder, table, about):
    arrays = numpy.load(folder / "trajectory.npz", allow_pickle=False)
    assert_same("npz t", arrays["t"], table.times)
    assert list(arrays["arms"]) == table.arms
    for arm in table.arms:
        assert list(arrays[f"{arm}.joints"]) == table.joints(arm)
        assert_same(f"npz {arm} positions", arrays[f"{arm}.positions"], table.positions(arm))
        assert_same(f"npz {arm} velocities", arrays[f"{arm}.velocities"], table.velocities(arm))
        assert_same(f"npz {arm} errors", arrays[f"{arm}.errors"], table.errors(arm))
    assert {key: value for key, value in arrays["about"].tolist()} == about


def check_parquet(folder, table, about):
    file = pyarrow.parquet.ParquetFile(folder / "trajectory.parquet")
    read = file.read()
    assert read.column_names == table.names
    for name in table.names:
        assert str(read.schema.field(name).type) == "double" and read[name].null_count == 0, name
        assert_same(f"parquet {name}", read[name].to_numpy(), table.columns[name])
    metadata = file.metadata.metadata
    assert {key.decode(): value.decode() for key, value in metadata.items()} == about
    arm = table.arms[0]
    name = f"{arm}.{table.joints(arm)[0]}"
    assert name in pyarrow.parquet.read_table(folder / "trajectory.parquet", columns=["t", name]).column_names


def check_points(what, message, table, arm):
    """A joint trajectory as PyYAML has it, or as an object with the same fields."""

    def get(node, key):
        return node[key] if isinstance(node, dict) else getattr(node, key)

    assert list(get(message, "joint_names")) == table.joints(arm), what
    points = get(message, "points")
    assert_same(f"{what} positions", [list(get(point, "positions")) for point in points], table.positions(arm))
    assert_same(f"{what} velocities", [list(get(point, "velocities")) for point in points], table.velocities(arm))
    spans = [get(point, "time_from_start") for point in points]
    assert [get(span, "sec") * 10**9 + get(span, "nanosec") for span in spans] == table.nanoseconds, what


def check_messages(folder, table):
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    for arm in table.arms:
        with open(folder / f"trajectory.{arm}.yaml", encoding="utf-8") as file:
            check_points(f"yaml {arm}", yaml.load(file, loader), table, arm)
        with open(folder / f"trajectory.{arm}.moveit.yaml", encoding="utf-8") as file:
            display = yaml.load(file, loader)
        check_points(f"moveit {arm}", display["trajectory"][0]["joint_trajectory"], table, arm)
        check_start(display["trajectory_start"]["joint_state"]["name"],
                    display["trajectory_start"]["joint_state"]["position"], table, arm)


def check_start(names, positions, table, arm):
    start = dict(zip(names, positions, strict=True))
    assert_same("start", [start[joint] for joint in table.joints(arm)], table.positions(arm)[0])


def frames_shown(times):
    """Samples with transforms: the first, each that comes 10 ms or more after the one before it, and the last."""
    count, next_time = 0, 0
    for index, time in enumerate(times):
        if time >= next_time or index == len(times) - 1:
            count, next_time = count + 1, time + 10_000_000
    return count


class Recording:
    """What a recording has to hold, whichever program decodes it."""

    def __init__(self, table):
        self.table = table
        self.counts = {}
        self.child_frames = set()
        self.static_frames = set()

    def see(self, topic, kind, time, message):
        count = self.counts.get(topic, 0)
        self.counts[topic] = count + 1
        table, arm = self.table, topic.split("/")[1]
        last = topic.rsplit("/", 1)[1]
        if last == "joint_trajectory":
            assert kind == "trajectory_msgs/msg/JointTrajectory"
            check_points(topic, message, table, arm)
        elif last == "display_planned_path":
            assert kind == "moveit_msgs/msg/DisplayTrajectory"
            check_points(topic, message.trajectory[0].joint_trajectory, table, arm)
            state = message.trajectory_start
            check_start(state.joint_state.name, list(state.joint_state.position), table, arm)
            assert not state.is_diff and len(state.attached_collision_objects) == 0
        elif last == "joint_states":
            stamp = message.header.stamp
            assert stamp.sec * 10**9 + stamp.nanosec == table.nanoseconds[count] == time, topic
            joints = len(table.joints(arm))
            assert list(message.name)[:joints] == table.joints(arm)
            assert len(message.name) == len(message.position) == len(message.velocity)
            assert_same(topic, list(message.position)[:joints], table.positions(arm)[count])
            assert_same(topic, list(message.velocity)[:joints], table.velocities(arm)[count])
        elif last == "robot_description":
            assert "<robot" in message.data
        elif last == "path":
            assert len(message.poses) == len(table.times)
            assert {pose.header.frame_id for pose in message.poses} == {"world"}
        elif last in ("tf", "tf_static"):
            frames = self.child_frames if last == "tf" else self.static_frames
            for transform in message.transforms:
                turn = transform.transform.rotation
                norm = sum(part * part for part in (turn.x, turn.y, turn.z, turn.w))
                assert abs(norm - 1.0) < 1e-12
                frames.add(transform.child_frame_id)
        else:
            raise AssertionError(f"nobody expected {topic}")

    def finish(self, what):
        samples = len(self.table.times)
        for arm in self.table.arms:
            for topic, count in {
                "joint_states": samples,
                "joint_trajectory": 1,
                "display_planned_path": 1,
                "robot_description": 1,
                "path": 1,
            }.items():
                assert self.counts.pop(f"/{arm}/{topic}") == count, (what, arm, topic)
            moving = {name for name in self.child_frames if name.startswith(f"{arm}/")}
            assert len(moving) == len(self.table.joints(arm)), (what, moving)
        assert self.counts.pop("/tf") == frames_shown(self.table.nanoseconds)
        assert self.counts.pop("/tf_static") == 1
        assert not self.counts and not self.child_frames & self.static_frames, what


def check_by_mcap(folder, table, about):
    recording = Recording(table)
    with open(folder / "trajectory.mcap", "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            recording.see(channel.topic, schema.name, message.log_time, decoded)
        entries = [metadata.metadata for metadata in reader.iter_metadata() if metadata.name == "kinstep"]
        assert entries == [about]
    recording.finish("mcap")


def check_by_rosbags(folder, table):
    recording = Recording(table)
    with AnyReader([folder / "trajectory.mcap"]) as reader:
        for connection, time, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            recording.see(connection.topic, connection.msgtype, time, message)
    recording.finish("rosbags")


def main():
    folder = pathlib.Path(sys.argv[1])
    table = Table(folder)
    about = check_metadata(folder, table)
    check_arrays(folder, table, about)
    check_parquet(folder, table, about)
    check_messages(folder, table)
    check_by_mcap(folder, table, about)
    check_by_rosbags(folder, table)
    print(f"{len(table.times)} samples of {len(table.arms)} arms read back to the last bit in every format")


if __name__ == "__main__":
    main()
