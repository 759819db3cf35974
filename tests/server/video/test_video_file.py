"""Files of recorded video, without a camera."""

from __future__ import annotations

from fractions import Fraction

import pytest

av = pytest.importorskip("av")
pytest.importorskip("aiortc")

from mavstack.server.video.video_file import VideoFile  # noqa: E402

#: The time of the first picture of a camera that was opened ten minutes ago, in 1/90000 s.
LONG_AGO = 600 * 90_000
STEP = 3000


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


def test_packets_have_times_since_the_beginning_of_the_file(tmp_path):
    source, path = tmp_path / "a.mp4", tmp_path / "b.mp4"
    record(source, frames())
    with av.open(str(source)) as container:
        packets = [each for each in container.demux(video=0) if each.size]
        for number, packet in enumerate(packets):
            packet.pts, packet.time_base = LONG_AGO + number * STEP, Fraction(1, 90_000)
        assert record(path, packets) == pytest.approx(1.0)
    assert times(path)[0] == 0
    assert times(path)[-1] == pytest.approx(1.0, abs=0.01)


def test_a_file_without_a_picture_is_removed(tmp_path):
    assert record(tmp_path / "a.mp4", ()) == 0
    assert list(tmp_path.iterdir()) == []
