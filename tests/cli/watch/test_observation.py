"""Links that are recorded, and recordings that are replayed onto links."""

from __future__ import annotations

import asyncio
import json
import socket
from contextlib import contextmanager

import pytest

from mavstack import open_log
from mavstack.cli.watch.relay import Relay
from mavstack.dialects import common
from mavstack.errors import LinkURLError
from mavstack.links import BytesReceived, open_link
from mavstack.wire import Packet, encode
from tests.cli.conftest import flight, setup_signing, stamped
from tests.cli.watch.test_command import sender


@contextmanager
def receiver():
    """Yield the URL of a UDP port, and a function that returns the packets that arrived."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(0.2)

        def received() -> list[bytes]:
            packets = []
            while True:
                try:
                    packets.append(sock.recv(65535))
                except TimeoutError:
                    return packets

        yield f"udpout://127.0.0.1:{sock.getsockname()[1]}", received


# --record


def test_all_packets_of_a_link_are_recorded(mav, tmp_path):
    path = tmp_path / "new.tlog"
    with sender(flight(1)[0] + flight(1)[2]) as url:
        result = mav("watch", url, "--json", "--for", "0.4", "--filter", "HEARTBEAT", "--record", path)
    assert result.code == 0
    assert {json.loads(line)["message"] for line in result.out.splitlines()} == {"HEARTBEAT"}
    assert sorted(open_log(path)) == ["ATTITUDE", "HEARTBEAT"]
    assert f"packets to {path}" in result.err


def test_two_links_are_recorded_together(mav, tmp_path):
    path = tmp_path / "new.tlog"
    other = encode(common.SystemTime(), system=2, component=1)
    with sender(flight(0)[0]) as first, sender(other) as second:
        assert mav("watch", first, second, "--once", "--for", "0.4", "--record", path).code == 0
    assert sorted(open_log(path)) == ["HEARTBEAT", "SYSTEM_TIME"]


def test_a_recording_never_overwrites_a_file(mav, tmp_path):
    path = tmp_path / "old.tlog"
    path.write_bytes(b"precious")
    result = mav("watch", "udpin://127.0.0.1:0", "--once", "--for", "0.05", "--record", path)
    assert result.code == 1
    assert "never overwrites" in result.err
    assert path.read_bytes() == b"precious"


def test_a_recording_is_not_recorded_again(mav, tlog, tmp_path):
    result = mav("watch", tlog, "--record", tmp_path / "new.tlog")
    assert result.code == 2
    assert "is a recording" in result.err


# --to


def test_a_recording_is_replayed_byte_for_byte(mav, tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(stamped([*flight(), setup_signing()]))
    with receiver() as (url, received):
        result = mav("watch", path, "--to", url, "--speed", "max", "--once", "--json")
        assert received() == flight()
    assert (result.code, json.loads(result.out)["packets"]) == (0, 23)
    assert f"replayed 22 packets to {url}" in result.err


def test_a_part_of_a_recording_is_replayed(mav, tlog):
    with receiver() as (url, received):
        mav("watch", tlog, "--to", url, "--speed", "max", "--once", "--filter", "ATTITUDE")
        names = {Packet(data, common).name for data in received()}
    assert names == {"ATTITUDE"}


async def test_the_replay_waits_for_a_peer_and_for_room():
    async with Relay("tcpin://127.0.0.1:0?send_queue=4k") as relay:
        waiting = asyncio.create_task(relay.wait_for_peer())
        await asyncio.sleep(0)
        assert not waiting.done()
        async with open_link(f"tcpout://127.0.0.1:{relay.link.address[1]}") as peer:
            await waiting
            packet = Packet(flight(1)[2], common)
            received = 0
            for _ in range(100):
                relay.send([packet] * 20)
                await relay.drain()
            while received < 2000 * len(packet):
                event = await anext(peer)
                received += len(event.data) if isinstance(event, BytesReceived) else 0
    assert (relay.sent, relay.dropped) == (2000, 0)


@pytest.mark.parametrize("words", [["udpin://127.0.0.1:0"], ["-"]])
def test_only_one_recording_is_replayed(mav, tlog, words):
    for sources in (words, [tlog, *words]):
        result = mav("watch", *sources, "--to", "udpout://127.0.0.1:1")
        assert result.code == 2
        assert "--to replays one recording" in result.err


def test_a_replay_does_not_sign(mav, tlog):
    with pytest.raises(LinkURLError, match="replayed unchanged; remove the option signing_key"):
        Relay("udpout://127.0.0.1:1?signing_key=fleet")


def test_trends_need_the_live_display(mav, tlog):
    result = mav("watch", tlog, "--trend", "ATTITUDE")
    assert result.code == 2
    assert "--trend needs the live display" in result.err
