"""What the recorder writes, read by the mcap package and by the descriptors in the file."""

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader
from scipy.spatial.transform import Rotation

from planner.grid import LocalFrame
from recordings.errors import RecordingError
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.messages import plan_path_message
from recordings.poses import east_north_up_quaternion
from recordings.protobuf_types import message_type
from recordings.recorder import Outcome
from recordings.schema import ESTIMATE, SAMPLES_PER_CHUNK, TOPICS


@pytest.fixture(scope="module")
def flight(kept):
    return kept.fly(kept.header(kept.corners))


def decoded(path):
    """Every message, in log time order, read with nothing but what is in the file."""
    classes = {}
    with path.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            if schema.name not in classes:
                pool = descriptor_pool.DescriptorPool()
                for file in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
                    pool.Add(file)
                classes[schema.name] = message_factory.GetMessageClass(
                    pool.FindMessageTypeByName(schema.name)
                )
            yield channel.topic, message.log_time, classes[schema.name].FromString(message.data)


def on_topic(path, topic):
    return [message for name, _, message in decoded(path) if name == topic]


def test_a_stranger_reads_the_samples_from_the_embedded_descriptors(workshop, flight):
    states = on_topic(workshop.file(flight), "/state")
    assert len(states) == len(flight.states)
    for message, state in zip(states[::100], flight.states[::100], strict=True):
        for name, value in state._asdict().items():
            assert getattr(message, name) == pytest.approx(value, rel=1e-7, abs=1e-12), name


def test_a_stranger_reads_what_guidance_asked_for(workshop, flight):
    message = on_topic(workshop.file(flight), "/guidance")[42]
    sample = flight.guidance[42]
    assert message.path_m == sample.path_m
    assert (message.time_error_s, message.phase, message.command_airspeed_mps) == (1.5, 1, 28.0)
    assert message.time_s == flight.states[42].time_s


def test_log_times_are_unix_time(workshop, flight):
    path, departure_s = workshop.file(flight), flight.header.plan.departure_s
    times = [log_time for topic, log_time, _ in decoded(path) if topic == "/state"]
    assert times == [round((departure_s + state.time_s) * 1e3) * 1_000_000 for state in flight.states]


def test_every_topic_is_there(workshop, flight):
    assert {topic for topic, _, _ in decoded(workshop.file(flight))} == {topic.name for topic in TOPICS}


def test_where_sensors_are_perfect_there_are_no_estimates(workshop, flight):
    perfect = workshop.file(replace(flight, seen=[]))
    assert ESTIMATE.name not in {topic for topic, _, _ in decoded(perfect)}


def test_a_stranger_reads_each_estimate_at_the_time_of_its_sample(workshop, flight):
    path, departure_s = workshop.file(flight), flight.header.plan.departure_s
    found = [(time, message) for topic, time, message in decoded(path) if topic == ESTIMATE.name]
    assert [time for time, _ in found] == [
        round((departure_s + state.time_s) * 1e3) * 1_000_000 for state in flight.seen
    ]
    for (_, message), state in list(zip(found, flight.seen, strict=True))[::100]:
        for field in message.DESCRIPTOR.fields:
            assert getattr(message, field.name) == pytest.approx(getattr(state, field.name), rel=1e-7)


def test_the_summary_counts_what_is_there(workshop, flight):
    path = workshop.file(flight)
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    found = {}
    for topic, _, _ in decoded(path):
        found[topic] = found.get(topic, 0) + 1
    counted = summary.statistics.channel_message_counts
    assert {summary.channels[channel].topic: count for channel, count in counted.items()} == found
    assert summary.statistics.message_count == sum(found.values())


def test_the_same_flight_gives_the_same_bytes(workshop, flight):
    first, second = workshop.file(flight, "first"), workshop.file(flight, "second")
    assert first.read_bytes() == second.read_bytes()


def test_one_sample_changed_changes_the_bytes(workshop, flight):
    first = workshop.file(flight, "first")
    second = workshop.file(flight.changed(500, lat_rad=0.52), "second")
    assert first.read_bytes() != second.read_bytes()


def test_the_file_has_its_name_only_when_the_flight_has_ended(workshop, flight):
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    flight.record(recorder, finish=False)
    assert [path.name for path in workshop.folder.iterdir()] == ["flight.partial.mcap"]
    recorder.finish(480.0, Outcome.CRASHED, "hit the ground")
    assert [path.name for path in workshop.folder.iterdir()] == ["flight.mcap"]
    assert read(recorder.path).outcome == Outcome.CRASHED


def test_what_was_abandoned_is_readable_and_incomplete(workshop, flight):
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    flight.record(recorder, finish=False)
    recorder.abandon()
    recorder.abandon()
    assert len(on_topic(recorder.partial_path, "/state")) == len(flight.states)
    recording = read(recorder.partial_path)
    assert (recording.complete, recording.outcome) == (False, Outcome.INCOMPLETE)
    assert "how the flight ended" in recording.missing


def test_a_killed_flight_loses_no_more_than_a_chunk(workshop, flight):
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    flight.record(recorder, finish=False)
    left = read(recorder.partial_path)
    recorder.abandon()
    assert len(left.state) == len(flight.states) // SAMPLES_PER_CHUNK * SAMPLES_PER_CHUNK
    assert not left.complete


def test_events_do_not_hold_chunks_back(workshop, flight):
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    recorder.begin(flight.header)
    for state, guidance in zip(flight.states, flight.guidance, strict=True):
        recorder.sample(state, guidance)
        if state.time_s % 10.0 == 0.0:
            recorder.event(state.time_s, "again")
    left = read(recorder.partial_path)
    recorder.abandon()
    assert len(left.state) == len(flight.states) // SAMPLES_PER_CHUNK * SAMPLES_PER_CHUNK


def test_abandoning_what_never_began_does_nothing(workshop):
    McapRecorder(workshop.folder / "flight.mcap").abandon()
    assert not list(workshop.folder.iterdir())


def test_a_folder_that_is_not_there_is_named(workshop, flight):
    recorder = McapRecorder(workshop.folder / "nowhere" / "flight.mcap")
    with pytest.raises(RecordingError, match=r"nowhere.*another folder"):
        recorder.begin(flight.header)


def test_a_full_disc_is_named(workshop, flight):
    (workshop.folder / "flight.partial.mcap").symlink_to("/dev/full")
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    with pytest.raises(RecordingError, match=r"flight\.partial\.mcap: No space left"):
        flight.record(recorder)
    recorder.abandon()


def test_a_flight_before_1970_is_refused(workshop, flight):
    early = replace(flight.header, plan=replace(flight.header.plan, departure_s=10.0))
    with pytest.raises(RecordingError, match="1970"):
        McapRecorder(workshop.folder / "flight.mcap").begin(early)


def test_a_sample_without_a_time_is_refused(workshop, flight):
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    with pytest.raises(RecordingError, match="no finite time"):
        flight.changed(10, time_s=math.nan).record(recorder)
    recorder.abandon()


def test_a_sheet_of_another_grid_is_refused(workshop, flight):
    sheet = replace(flight.sheets[0], hazard=np.zeros((3, 4), bool))
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    recorder.begin(flight.header)
    with pytest.raises(RecordingError, match=r"\(3, 4\)"):
        recorder.weather(sheet)
    recorder.abandon()


def test_positions_are_written_once_a_second(workshop, flight):
    messages = on_topic(workshop.file(flight), "/position")
    departure_s = flight.header.plan.departure_s
    times_s = [message.timestamp.seconds - departure_s for message in messages]
    assert times_s == list(range(-30, 481))
    assert all(message.timestamp.nanos == 0 for message in messages)
    assert math.radians(messages[30].latitude) == pytest.approx(flight.states[300].lat_rad, abs=1e-15)


def test_the_pose_lies_in_the_plane_of_the_path(workshop, flight):
    path = workshop.file(flight)
    pose, transform = on_topic(path, "/pose")[100], on_topic(path, "/tf")[100]
    point = flight.header.reference.at(flight.header.reference.path_at_time(70.0))
    assert (pose.pose.position.y, pose.pose.position.x) == pytest.approx(
        (point.north_m, point.east_m),
        abs=1e-5,  # positions are recorded in steps of six micrometres
    )
    assert pose.pose.position.z == 1000.0
    assert transform.translation.x == pose.pose.position.x
    assert (transform.parent_frame_id, transform.child_frame_id) == ("map", "base_link")


@pytest.mark.parametrize("roll_deg", [0.0, 30.0, -45.0])
@pytest.mark.parametrize("pitch_deg", [0.0, 10.0, -80.0])
@pytest.mark.parametrize("heading_deg", [0.0, 90.0, 200.0, 359.0])
def test_the_quaternion_is_the_attitude_in_other_axes(roll_deg, pitch_deg, heading_deg):
    aerospace = Rotation.from_euler("ZYX", [heading_deg, pitch_deg, roll_deg], degrees=True).as_matrix()
    east_north_up = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])  # from north-east-down
    forward_left_up = np.diag([1, -1, -1])  # to forward-right-down
    quaternion = east_north_up_quaternion(*np.radians([roll_deg, pitch_deg, heading_deg]))
    matrix = Rotation.from_quat(quaternion).as_matrix()
    assert matrix == pytest.approx(east_north_up @ aerospace @ forward_left_up, abs=1e-12)


def test_the_plan_is_geojson_in_longitude_and_latitude(workshop, flight):
    (message,) = on_topic(workshop.file(flight), "/plan")
    line, port, isle = json.loads(message.geojson)["features"]
    first = flight.header.plan.waypoints[0]
    assert line["geometry"]["coordinates"][0] == [first.lon_deg, first.lat_deg, 1000.0]
    assert port["properties"] == {"name": "Port", "reachable": True}
    assert isle["geometry"] == {"type": "Point", "coordinates": [-88.1, 30.9]}


def test_the_plan_lies_in_the_plane(workshop, flight):
    (message,) = on_topic(workshop.file(flight), "/plan/path")
    found = [(pose.position.y, pose.position.x) for pose in message.poses]
    assert np.array(found) == pytest.approx(np.array(workshop.corners), abs=1e-6)


def test_waypoints_face_the_next_one(workshop, flight):
    (message,) = on_topic(workshop.file(flight), "/plan/path")
    assert len(message.poses) > 2
    for here, there in itertools.pairwise(message.poses):
        forward = Rotation.from_quat(
            [here.orientation.x, here.orientation.y, here.orientation.z, here.orientation.w]
        ).apply([1.0, 0.0, 0.0])
        leg = np.array([there.position.x - here.position.x, there.position.y - here.position.y, 0.0])
        assert forward == pytest.approx(leg / np.linalg.norm(leg), abs=1e-9)
    assert message.poses[-1].orientation == message.poses[-2].orientation


def test_a_waypoint_of_a_wait_faces_as_the_one_before(workshop):
    first, second, *rest = workshop.header(workshop.corners).plan.waypoints
    plan = replace(workshop.header(workshop.corners).plan, waypoints=(first, second, second, *rest))
    path = message_type("foxglove.PosesInFrame").FromString(plan_path_message(plan, workshop.grid.frame, 0))
    assert path.poses[1].orientation == path.poses[0].orientation
    assert path.poses[2].orientation != path.poses[1].orientation


def test_the_weather_lies_right_under_the_path(workshop, flight):
    """Any point of the picture against the flight's own cell there, by way of the map projection."""
    sheet, grid = flight.sheets[1], workshop.grid
    message = on_topic(workshop.file(flight), "/weather/truth/grid")[0]
    cell_m, columns = message.cell_size.x, message.column_count
    cells = np.frombuffer(message.data, np.uint8).reshape(-1, columns, 2)
    frame = LocalFrame(grid.frame.origin_lat_rad, grid.frame.origin_lon_rad)
    generator = np.random.default_rng(3)
    for row, column in zip(
        generator.integers(0, len(cells), 200), generator.integers(0, columns, 200), strict=True
    ):
        lat_rad, lon_rad = frame.to_geodetic(
            message.pose.position.y + (row + 0.5) * cell_m, message.pose.position.x + (column + 0.5) * cell_m
        )
        nearest = grid.nearest_cell(lat_rad, lon_rad)
        speed_mps = math.hypot(sheet.wind_north_mps[nearest], sheet.wind_east_mps[nearest])
        assert cells[row, column, 0] == sheet.hazard[nearest]
        assert abs(cells[row, column, 1] - speed_mps) <= 0.501
    assert len(cells) * cell_m == pytest.approx(
        frame.to_plane(grid.lat_rad[-1], 0.0)[0] - frame.to_plane(grid.lat_rad[0], 0.0)[0], abs=cell_m
    )


def test_events_are_a_log(workshop, flight):
    (message,) = on_topic(workshop.file(flight), "/events")
    assert message.message == "a minute has passed"
    assert message.timestamp.seconds == flight.header.plan.departure_s + 60
    assert message.level == 2  # INFO


def test_the_scenario_and_the_plan_are_attached_and_come_first(workshop, flight):
    path = workshop.file(flight)
    with path.open("rb") as stream:
        reader = make_reader(stream)
        attachments = {attachment.name: attachment.data for attachment in reader.iter_attachments()}
        summary = reader.get_summary()
    assert attachments == {
        "scenario.toml": flight.header.scenario_toml.encode(),
        "plan.json": flight.header.plan.to_json(),
    }
    first_chunk = min(chunk.chunk_start_offset for chunk in summary.chunk_indexes)
    assert all(index.offset < first_chunk for index in summary.attachment_indexes)
    assert {index.name for index in summary.metadata_indexes} == {"galeway", "versions"}
