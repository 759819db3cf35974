"""Recorded video of a simulated camera."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from threading import Event
from time import time

import pytest

from mavstack.errors import InvalidArgumentError, LinkError, LogError
from mavstack.http.bodies import RefusedError
from mavstack.server.video.addresses import read_address, redacted
from mavstack.server.video.recordings import VideoRecordings, label_of
from mavstack.sim.payloads.picture import read_time

aiortc = pytest.importorskip("aiortc")
av = pytest.importorskip("av")

from mavstack.server.video import recorder as module  # noqa: E402
from mavstack.server.video.gateway import VideoGateway  # noqa: E402
from mavstack.sim.video_camera import VideoCamera, attitude_picture  # noqa: E402
from tests.server.video.test_gateway import browser, picture_of  # noqa: E402
from tests.waiting import wait_until  # noqa: E402


@asynccontextmanager
async def studio(folder):
    """Recordings of a camera: recordings, gateway, camera."""
    gateway = VideoGateway()
    recordings = VideoRecordings(lambda: gateway, folder)
    try:
        async with VideoCamera(attitude_picture(lambda: (0.0, 0.0))) as camera:
            yield recordings, gateway, camera
            await recordings.close()
            await gateway.close()
    finally:
        await recordings.close()
        await gateway.close()


def pictures(path):
    """Return the pictures of a file."""
    with av.open(str(path)) as container:
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]


async def grown(recordings, seconds=1.0):
    await wait_until(
        lambda: any(each["seconds"] and each["seconds"] >= seconds for each in recordings.list())
    )


async def test_a_camera_is_recorded_beside_its_viewer_and_the_file_plays(tmp_path):
    async with studio(tmp_path) as (recordings, gateway, camera):
        async with browser(gateway, camera.url) as (track, name):
            await picture_of(track)
            begun = await recordings.start(read_address(camera.url), camera.url, "copter-1-front")
            assert begun["name"].startswith("copter-1-front-20")
            assert begun["running"]
            await grown(recordings)
            assert (gateway.cameras, camera.players) == (1, 1), "viewer and recording share the camera"
            await gateway.leave(name)
        await grown(recordings, 2.0)
        assert gateway.cameras == 1, "the recording continues without a viewer"
        path = recordings.path(begun["name"])
        assert recordings.is_growing(begun["name"])
        before = pictures(path)  # of a program that was killed now
        assert len(before) > 10
        ended = await recordings.stop(begun["name"])
        assert not ended["running"]
        assert ended["size"] == path.stat().st_size > 0
        assert gateway.cameras == 0
        shown = pictures(path)
        assert len(shown) > len(before)
        times = [read_time(each) for each in shown]
        assert times == sorted(times)
        assert abs(times[-1] - time()) < 20
        with pytest.raises(RefusedError, match="no recording"):
            await recordings.stop(begun["name"])


async def test_a_camera_that_is_decoded_is_encoded(tmp_path, monkeypatch):
    """As for H.265, of which the viewers get H.264."""
    sources = pytest.importorskip("mavstack.server.video.sources")
    opening = sources._player
    monkeypatch.setattr(
        sources,
        "_player",
        lambda address, *, decode: opening(address, decode=True) if decode else _without_video(),
    )
    async with studio(tmp_path) as (recordings, _, camera):
        begun = await recordings.start(read_address(camera.url), camera.url, "x")
        await grown(recordings)
        await recordings.stop(begun["name"])
        assert abs(read_time(pictures(tmp_path / begun["name"])[-1]) - time()) < 20


def _without_video():
    class Player:
        video = None

    return Player()


async def test_an_interrupted_recording_continues_in_a_new_file(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "RETRY_INTERVAL", 0.05)
    async with studio(tmp_path) as (recordings, gateway, camera):
        begun = await recordings.start(read_address(camera.url), camera.url, "x")
        await grown(recordings)
        (source,) = gateway._sources.values()
        source._track.stop()
        source._player._stop(source._track)
        await wait_until(lambda: len(recordings.list()) == 2)
        assert len(pictures(tmp_path / begun["name"])) > 5
        await grown(recordings, 2.0)
        running = [each for each in recordings.list() if each["running"]]
        assert len(running) == 1
        assert running[0]["name"] != begun["name"]
        await recordings.stop(begun["name"])
        assert not any(each["running"] for each in recordings.list())
        assert len(pictures(tmp_path / running[0]["name"])) > 5


async def test_files_have_a_maximum_size(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "MAX_FILE", 10_000)
    monkeypatch.setattr(module, "_CHECK_INTERVAL", 10)
    async with studio(tmp_path) as (recordings, _, camera):
        await recordings.start(read_address(camera.url), camera.url, "x")
        await wait_until(lambda: len(recordings.list()) >= 3, timeout=60)
        await recordings.close()
        for each in recordings.list()[:-1]:
            assert pictures(tmp_path / each["name"])


async def test_a_full_disk_ends_the_recording_and_permits_no_new_one(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "_CHECK_INTERVAL", 10)
    async with studio(tmp_path) as (recordings, gateway, camera):
        address = read_address(camera.url)
        begun = await recordings.start(address, camera.url, "x")
        await grown(recordings, 0.2)
        monkeypatch.setattr(module, "MIN_FREE", 1 << 60)
        await wait_until(lambda: not any(each["running"] for each in recordings.list()))
        (shown,) = recordings.list()
        assert "free on the disk" in shown["problem"]
        assert pictures(tmp_path / begun["name"])
        await wait_until(lambda: gateway.cameras == 0)
        with pytest.raises(LogError, match="free on the disk"):
            await recordings.start(address, camera.url, "x")


async def test_refusals_leave_no_file(tmp_path, monkeypatch):
    async with studio(tmp_path) as (recordings, gateway, _):
        with pytest.raises(LinkError, match="opening the camera failed"):
            await recordings.start(read_address("rtsp://127.0.0.1:9/none"), "x", "x")
        monkeypatch.setattr("mavstack.server.video.recordings.MAX_RUNNING", 0)
        with pytest.raises(RefusedError, match="0 cameras are recorded already"):
            await recordings.start(read_address("rtsp://127.0.0.1:9/none"), "x", "x")
        assert gateway.cameras == 0
        assert recordings.list() == []
        for name in ("../x.mp4", ".x.mp4", "x.tlog", "none.mp4"):
            with pytest.raises(RefusedError, match="there is no video"):
                recordings.path(name)
    with pytest.raises(RefusedError, match="without a folder"):
        await VideoRecordings(lambda: gateway, None).start(read_address("rtsp://127.0.0.1:9/none"), "x", "x")


class Scripted:
    """A gateway whose camera gives nothing, or has ended already."""

    def __init__(self, *, is_live=True):
        self.is_live, self.codec, self.opened, self.released = is_live, "h264", 0, asyncio.Event()

    @asynccontextmanager
    async def camera(self, _address):
        self.opened += 1
        await self.released.wait()
        yield self

    def subscribe(self):
        return self

    def stop(self):
        """Do nothing."""

    async def recv(self):
        await asyncio.Event().wait()


async def test_a_recording_that_begins_is_ended_by_the_close_of_the_station(tmp_path):
    gateway = Scripted()
    recordings = VideoRecordings(lambda: gateway, tmp_path)
    starting = asyncio.create_task(recordings.start(read_address("5600"), "5600", "x"))
    await wait_until(lambda: gateway.opened)
    await recordings.close()
    with pytest.raises(LogError, match="stopped before the camera was open"):
        await starting
    assert recordings.list() == []


class Short(Scripted):
    """A camera that ends its stream after one picture."""

    def __init__(self):
        super().__init__()
        self.released.set()
        self.has_sent = True

    async def recv(self):
        self.has_sent = not self.has_sent
        if self.has_sent:
            raise aiortc.mediastreams.MediaStreamError
        return av.Packet(bytes(10))


async def test_a_camera_that_comes_and_goes_is_opened_less_often(tmp_path, monkeypatch):
    pauses, enough = [], asyncio.Event()

    async def pause(seconds):
        pauses.append(seconds)
        if len(pauses) == 10:
            enough.set()
            await asyncio.Event().wait()

    def write(file, _):
        file.seconds = module.STABLE_TIME if len(pauses) == 7 else 1.0

    monkeypatch.setattr(module.VideoFile, "write", write)
    monkeypatch.setattr(module.asyncio, "sleep", pause)
    recordings = VideoRecordings(Short, tmp_path)
    await recordings.start(read_address("5600"), "5600", "x")
    await asyncio.wait_for(enough.wait(), 20)
    assert pauses == [2, 4, 8, 16, 32, 60, 60, 2, 4, 8], "the eighth stream was a long one"
    assert recordings.list() == [], "files without a picture are removed"
    await recordings.close()


async def test_pictures_that_wait_for_the_disk_are_bounded_and_counted(tmp_path, monkeypatch):
    """A camera that sends for a while to a disk that takes nothing."""
    given = asyncio.Queue()

    class Camera(Scripted):
        async def recv(self):
            return await given.get()

    gateway, begun, released, written = Camera(), Event(), Event(), []
    gateway.released.set()

    def write(file, data):
        begun.set()
        assert released.wait(20)
        written.append(data.pts)
        file.damaged = 1

    monkeypatch.setattr(module.VideoFile, "write", write)
    monkeypatch.setattr("mavstack.server.video.late_pictures.MAX_WAITING", 5000)
    recordings = VideoRecordings(lambda: gateway, tmp_path)
    await recordings.start(read_address("5600"), "5600", "x")
    for number in range(22):
        packet = av.Packet(bytes(1000))
        packet.pts, packet.is_keyframe = number, number % 10 == 0
        await given.put(packet)
        if number == 0:
            await wait_until(begun.is_set)
    await wait_until(given.empty)
    released.set()
    await wait_until(lambda: len(written) == 3)
    # While 0 is being written, 1 to 5 wait, and 6 is one too many; likewise 10 to 14, and 15.
    assert written == [0, 20, 21]
    (recorder,) = recordings._recorders
    assert recorder.lost == 19 + 1
    assert recordings.list()[0]["lost"] == 20
    await recordings.close()
    assert recorder.lost == 20, "of all files"


async def test_pictures_that_wait_when_the_camera_ends_are_written(tmp_path, monkeypatch):
    """Also into the file that follows a full one."""
    gateway, released, files = Scripted(), Event(), []
    gateway.released.set()
    sent = iter(range(5))

    async def recv():
        for number in sent:
            packet = av.Packet(bytes(10))
            packet.pts, packet.is_keyframe = number, True
            return packet
        gateway.is_live = False
        released.set()
        raise aiortc.mediastreams.MediaStreamError

    def write(file, data):
        assert released.wait(20)
        files.append((file, data.pts))

    gateway.recv = recv
    monkeypatch.setattr(module.VideoFile, "write", write)
    monkeypatch.setattr(module, "_CHECK_INTERVAL", 2)
    monkeypatch.setattr(module, "_is_complete", lambda _: True)
    recordings = VideoRecordings(lambda: gateway, tmp_path)
    await recordings.start(read_address("5600"), "5600", "x")
    await wait_until(lambda: len(files) == 5)
    assert [number for _, number in files] == [0, 1, 2, 3, 4]
    assert len({id(file) for file, _ in files}) == 3
    (recorder,) = recordings._recorders
    assert recorder.lost == 0
    await recordings.close()


@pytest.mark.parametrize("is_live", [True, False])
async def test_a_beginning_without_a_file_is_an_error(tmp_path, monkeypatch, is_live):
    def fail(*_):
        raise LogError("cannot create x: Permission denied")

    gateway = Scripted(is_live=is_live)
    gateway.released.set()
    monkeypatch.setattr("mavstack.server.video.recordings._new_path", fail)
    recordings = VideoRecordings(lambda: gateway, tmp_path)
    expected = (
        pytest.raises(LogError, match="cannot create") if is_live else pytest.raises(LinkError, match="ended")
    )
    with expected:
        await recordings.start(read_address("5600"), "5600", "x")
    assert recordings.list() == []


async def test_a_file_that_is_removed_is_followed_by_another_one(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "_CHECK_INTERVAL", 10)
    async with studio(tmp_path) as (recordings, _, camera):
        begun = await recordings.start(read_address(camera.url), camera.url, "x")
        await grown(recordings, 0.2)
        recordings.path(begun["name"]).unlink()
        await wait_until(lambda: [each for each in recordings.list() if each["running"] and each["size"]])


def test_a_folder_that_is_gone_is_an_error(tmp_path):
    with pytest.raises(LogError, match="No such file"):
        module.require_space(tmp_path / "gone")


def test_links_to_other_files_are_neither_listed_nor_read(tmp_path):
    (tmp_path / "secret").write_bytes(b"x")
    folder = tmp_path / "videos"
    folder.mkdir()
    (folder / "a.mp4").symlink_to(tmp_path / "secret")
    recordings = VideoRecordings(VideoGateway, folder)
    assert recordings.list() == []
    with pytest.raises(RefusedError, match="there is no video"):
        recordings.path("a.mp4")


def test_names_follow_from_vehicle_and_camera_and_leave_no_folder():
    assert label_of("copter", "1", "Front") == "copter-1-front"
    assert label_of("copter", "1", "../../etc/passwd") == "copter-1-etc-passwd"
    assert label_of("", "..") == "video"


def test_addresses_are_shown_without_their_secrets():
    assert redacted(" rtsp://user:word@10.0.0.5/a ") == "rtsp://***@10.0.0.5/a"
    assert redacted("rtsp://user:w@rd@10.0.0.5/a") == "rtsp://***@10.0.0.5/a"
    assert redacted("rtsp://10.0.0.5/a?user=u&password=w") == "rtsp://10.0.0.5/a?user=u&password=***"
    for text in ("rtsp://user:word/1@10.0.0.5/a", f"rtsp://user:{'word' * 30}@10.0.0.5:x/a"):
        with pytest.raises(InvalidArgumentError) as refusal:
            read_address(text)
        assert "word" not in str(refusal.value)
