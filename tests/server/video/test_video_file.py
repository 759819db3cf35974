"""Files of recorded video, without a camera."""

from __future__ import annotations

from fractions import Fraction

import pytest

av = pytest.importorskip("av")
pytest.importorskip("aiortc")

from mavstack.server.video import video_file  # noqa: E402
from mavstack.server.video.nal_units import unit_types  # noqa: E402
from mavstack.server.video.video_file import VideoFile  # noqa: E402

#: The time of the first picture of a camera that was opened ten minutes ago, in 1/90000 s.
LONG_AGO = 600 * 90_000
STEP = 3000
CAMERA = {"tune": "zerolatency", "x264-params": "scenecut=0"}


def frames(count=31):
    for number in range(count):
        frame = av.VideoFrame(64, 48, "yuv420p")
        frame.pts, frame.time_base = LONG_AGO + number * STEP, Fraction(1, 90_000)
        yield frame


def times(path):
    """Return the times of the pictures of a file in seconds."""
    with av.open(str(path)) as container:
        return [frame.time for frame in container.decode(video=0)]


def record(path, data):
    path.touch()
    file = VideoFile(path)
    for each in data:
        before = each.pts
        file.write(each)
        assert each.pts == before, "viewers have the same object"
    file.close()
    return file.seconds


def test_pictures_have_times_since_the_beginning_of_the_file(tmp_path):
    path = tmp_path / "a.mp4"
    given = list(frames())
    assert record(path, [*given, given[3]]) == pytest.approx(1.0), "a late picture is dropped"
    shown = times(path)
    assert len(shown) == 31
    assert (shown[0], shown[-1]) == (0, pytest.approx(1.0, abs=0.01))


@pytest.fixture
def packets(tmp_path):
    """One second of a camera: packets of H.264 with start codes, of which every tenth needs no other."""
    path = tmp_path / "camera.ts"
    with av.open(str(path), "w", format="mpegts") as container:
        stream = container.add_stream("libx264", rate=30, options=CAMERA)
        stream.width, stream.height, stream.pix_fmt, stream.gop_size = 64, 48, "yuv420p", 10
        for frame in frames():
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    with av.open(str(path)) as container:
        found = [each for each in container.demux(video=0) if each.size]
        for number, packet in enumerate(found):
            packet.pts, packet.time_base = LONG_AGO + number * STEP, Fraction(1, 90_000)
        assert [number for number, each in enumerate(found) if each.is_keyframe] == [0, 10, 20, 30]
        yield found


def changed(packet, data, **values):
    """Return a packet with other bytes in the place of another."""
    other = av.Packet(data)
    other.stream, other.time_base = packet.stream, packet.time_base
    other.pts, other.is_keyframe = packet.pts, packet.is_keyframe
    for name, value in values.items():
        setattr(other, name, value)
    return other


def write(path, data):
    """Write packets into a file; return the number of the ones that were left out."""
    path.touch()
    file = VideoFile(path)
    for each in data:
        file.write(each)
    file.close()
    return file.damaged


def test_packets_have_times_since_the_beginning_of_the_file(tmp_path, packets):
    path = tmp_path / "b.mp4"
    assert record(path, packets) == pytest.approx(1.0)
    assert times(path) == pytest.approx([number / 30 for number in range(31)], abs=0.001)


def test_a_file_without_a_picture_is_removed(tmp_path):
    assert record(tmp_path / "a.mp4", ()) == 0
    assert list(tmp_path.iterdir()) == []


def junk(packet):
    """Return bytes without a start code in the place of a packet."""
    return changed(packet, b"\xff" * 40)


@pytest.mark.parametrize("damaged_at", [1, 4, 9])
def test_damaged_packets_are_left_out_with_the_ones_that_need_them(tmp_path, packets, damaged_at):
    path = tmp_path / "b.mp4"
    packets[damaged_at] = junk(packets[damaged_at])
    assert write(path, packets) == 10 - damaged_at
    written = [number for number in range(31) if not damaged_at <= number < 10]
    assert times(path) == pytest.approx([number / 30 for number in written], abs=0.001)


@pytest.mark.parametrize("flag", [True, False])
def test_a_file_begins_after_damaged_packets(tmp_path, packets, flag):
    path = tmp_path / "b.mp4"
    packets[0] = changed(packets[0], b"\xff" * 40, is_keyframe=flag)
    assert write(path, packets) == 1, "the ones that follow were never going to be in the file"
    assert times(path) == pytest.approx([number / 30 for number in range(21)], abs=0.001)


def test_packets_without_a_time_are_left_out(tmp_path, packets):
    path = tmp_path / "b.mp4"
    packets[5] = changed(packets[5], bytes(packets[5]), pts=None)
    assert write(path, packets) == 5
    assert len(times(path)) == 26


def without_parameter_sets(packet):
    """Return a packet with its slices alone."""
    units = bytes(packet).replace(b"\0\0\0\1", b"\0\0\1").split(b"\0\0\1")[1:]
    return changed(packet, b"".join(b"\0\0\1" + each for each in units if each[0] & 0x1F in (1, 5)))


def test_parameter_sets_of_the_stream_suffice(tmp_path, packets):
    """Cameras may say them in the description of the stream alone."""
    path = tmp_path / "b.mp4"
    assert write(path, [without_parameter_sets(each) for each in packets]) == 0
    assert len(times(path)) == 31


def test_a_file_waits_for_parameter_sets(tmp_path, packets, monkeypatch):
    path = tmp_path / "b.mp4"
    of_the_stream = packets[0].stream.codec_context.extradata
    monkeypatch.setattr(
        video_file, "unit_types", lambda data: unit_types(b"" if data == of_the_stream else data)
    )
    assert write(path, [without_parameter_sets(packets[0]), *packets[1:]]) == 0
    assert len(times(path)) == 21
