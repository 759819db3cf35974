"""The links of a replay: one for all packets, or one for each vehicle."""

from __future__ import annotations

import socket
from contextlib import contextmanager

import pytest

from mavstack.cli.watch.vehicle_relays import VehicleRelays
from mavstack.dialects import common
from mavstack.errors import LinkClosedError, LinkError
from mavstack.wire import Packet
from tests.logs.flights import flight_tlog


@contextmanager
def receivers():
    """Yield two sockets on ports that differ in their last digit, 1 and 2, and their URL."""
    for base in range(2200, 6500):
        with socket.socket(type=socket.SOCK_DGRAM) as one, socket.socket(type=socket.SOCK_DGRAM) as two:
            try:
                for number, sock in enumerate((one, two), 1):
                    sock.bind(("127.0.0.1", base * 10 + number))
            except OSError:
                continue
            yield (one, two), f"udpout://127.0.0.1:{base}{{system}}"
            return


def received(sock):
    """Return the packets that wait in a socket."""
    sock.setblocking(False)
    packets = []
    while True:
        try:
            packets.append(Packet(sock.recv(65535), common))
        except BlockingIOError:
            return packets


def test_each_vehicle_has_a_link_of_its_own(mav, tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    with receivers() as (sockets, url):
        result = mav("data", "replay", path, "--to", url, "--speed", "max")
        found = [received(sock) for sock in sockets]
        assert [{packet.system for packet in packets} for packets in found] == [{1}, {2}]
        assert [len(packets) for packets in found] == [70, 20]
        assert result.code == 0
        one, two = (url.replace("{system}", str(system)) for system in (1, 2))
        text = f"replayed 70 packets to {one} and 20 packets to {two} (10 of other systems left out)"
        assert text in result.err
        only = mav("watch", path, "--to", url, "--speed", "max", "--once", "--system", "2")
        assert f"replayed 20 packets to {two}" in only.err
        assert received(sockets[0]) == []


def test_a_recording_without_a_vehicle_is_refused(mav, tmp_path):
    path = tmp_path / "ground.tlog"
    path.write_bytes(flight_tlog())
    result = mav("data", "replay", path, "--to", "udpout://127.0.0.1:1455{system}", "--system", "255")
    assert (result.code, "{system}, but the recording has no vehicle" in result.err) == (2, True)


async def test_links_that_are_open_are_closed_if_another_one_fails():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        relays = VehicleRelays("tcpin://127.0.0.1:{system}", lambda: (0, taken.getsockname()[1]))
        with pytest.raises(LinkError):
            async with relays:
                pass
    with pytest.raises(LinkClosedError):
        await relays.links[0].open()
