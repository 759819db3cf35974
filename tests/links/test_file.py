from __future__ import annotations

import asyncio
import os
import sys

import pytest

from mavstack.errors import LinkError, LinkURLError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, open_link
from mavstack.sim.virtual import run_virtually

from .tlogs import packet, tlog

START = 1_700_000_000.0


@pytest.fixture
def flight(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(tlog([START, START + 0.001, START + 1, START + 1.5, START + 3]))
    return path


def replay(url: str) -> list[tuple[float, object]]:
    """Return all events, each with the time of the event loop."""

    async def follow():
        loop = asyncio.get_running_loop()
        begin = loop.time()
        async with open_link(url) as link:
            return [(loop.time() - begin, event) async for event in link]

    return run_virtually(follow())


@pytest.mark.parametrize("speed", [1, 2, 10, 0.5])
def test_a_replay_keeps_the_recorded_intervals(flight, speed):
    events = replay(f"file://{flight}?speed={speed}")
    assert isinstance(events[0][1], ChannelOpened)
    assert events[-1][1] == ChannelClosed(events[0][1].channel, "end of file")
    moments = [(at, event.time) for at, event in events if isinstance(event, BytesReceived)]
    for at, recorded in moments:
        assert at * speed == pytest.approx(recorded - START, abs=1e-3)
    assert [recorded - START for _, recorded in moments][-1] == pytest.approx(3)


def test_simultaneous_packets_are_one_chunk_without_timestamps(flight):
    chunks = [event for _, event in replay(str(flight)) if isinstance(event, BytesReceived)]
    one = packet(b"x" * 20)
    assert [chunk.data for chunk in chunks] == [one * 2, one, one, one]


@pytest.mark.parametrize("speed", ["max", "0"])
def test_full_speed_replays_large_chunks_without_delay(tmp_path, speed):
    path = tmp_path / "long.tlog"
    path.write_bytes(tlog(START + n for n in range(20_000)))
    events = replay(f"file://{path}?speed={speed}")
    assert events[-1][0] == 0
    chunks = [event.data for _, event in events if isinstance(event, BytesReceived)]
    assert b"".join(chunks) == packet(b"x" * 20) * 20_000
    assert len(chunks) <= 10
    times = [event.time for _, event in events if isinstance(event, BytesReceived)]
    assert times == sorted(times)
    assert times[0] == START


def test_a_clock_jump_does_not_stop_the_replay(tmp_path):
    path = tmp_path / "set.tlog"
    path.write_bytes(tlog([5.0, 6.0, START, START + 1, START - 100, START - 99]))
    events = replay(str(path))
    at = [at for at, event in events if isinstance(event, BytesReceived)]
    assert at == pytest.approx([0, 1, 61, 62, 62, 63])


def test_other_files_are_replayed_unchanged(tmp_path):
    path = tmp_path / "stream.raw"
    path.write_bytes(packet(b"abc") * 50_000)
    events = replay(f"{path}?speed=1")
    assert (
        b"".join(event.data for _, event in events if isinstance(event, BytesReceived)) == path.read_bytes()
    )
    assert events[-1][0] == 0


def test_an_empty_file_ends_immediately(tmp_path):
    path = tmp_path / "empty.tlog"
    path.touch()
    assert [type(event) for _, event in replay(str(path))] == [ChannelOpened, ChannelClosed]


async def test_bytes_written_to_a_recorded_peer_are_dropped(flight):
    async with open_link(flight.as_posix()) as link:
        channel = (await anext(link)).channel
        assert not channel.write(b"command")
        assert channel.counters.dropped_out == 1
        await channel.drain()


async def test_a_slow_reader_slows_the_replay(tmp_path):
    path = tmp_path / "big.raw"
    path.write_bytes(bytes(4 << 20))
    async with open_link(f"{path}?receive_queue=64k") as link:
        await asyncio.sleep(0.02)
        assert link.counters.bytes_in <= 1 << 18
        total = 0
        async for event in link:
            total += len(event.data) if isinstance(event, BytesReceived) else 0
        assert total == 4 << 20
        assert link.counters.dropped_in == 0


async def test_closing_during_the_replay_ends_the_iteration(flight):
    async with open_link(f"{flight}?speed=0.001") as link:
        opened = await anext(link)
        await anext(link)
        await link.close()
        assert [event async for event in link] == [ChannelClosed(opened.channel, "link closed")]


async def test_closing_the_channel_ends_the_link(flight):
    async with open_link(f"{flight}?speed=1000") as link:
        (await anext(link)).channel.close()
        kinds = [type(event) async for event in link]
        assert kinds[-1] is ChannelClosed


async def test_a_missing_file_raises(tmp_path):
    with pytest.raises(LinkError, match=r"no such file or device: .*none\.tlog"):
        await open_link(f"{tmp_path.as_posix()}/none.tlog")


async def test_a_directory_raises(tmp_path):
    with pytest.raises(LinkError, match=r"is a directory|permission denied"):
        await open_link(f"file://{tmp_path.as_posix()}")


@pytest.mark.skipif(sys.platform == "win32", reason="needs devices")
async def test_a_device_raises():
    with pytest.raises(LinkError, match="it is a device: use serial:///dev/null"):
        await open_link("file:///dev/null")


@pytest.mark.skipif(sys.platform == "win32", reason="needs FIFOs")
@pytest.mark.timeout(10)
async def test_a_fifo_raises(tmp_path):
    os.mkfifo(tmp_path / "fifo.tlog")
    with pytest.raises(LinkError, match="it is not a regular file"):
        await open_link(f"file://{tmp_path.as_posix()}/fifo.tlog")


async def test_a_file_of_another_format_raises(tmp_path):
    path = tmp_path / "x.ulg"
    path.write_bytes(b"ULog\x01\x12\x35" + bytes(100))
    with pytest.raises(LinkError, match="this is a PX4 ULog"):
        await open_link(f"file://{path.as_posix()}")


@pytest.mark.parametrize("speed", ["-1", "fast", "nan", "inf"])
def test_an_invalid_speed_raises(speed):
    with pytest.raises(LinkURLError, match="must be a number such as 1 or 10, or max"):
        open_link(f"flight.tlog?speed={speed}")
