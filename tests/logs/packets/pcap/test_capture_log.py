"""Captures as logs of packets."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import mavstack
from mavstack.dialects import common
from mavstack.logs.packets.pcap import CaptureLog
from tests.logs.conformance import LogConformance
from tests.logs.files import encoded
from tests.logs.formats.test_packets import MESSAGES
from tests.logs.packets.pcap.captures import (
    CLIENT,
    SERVER,
    START,
    block,
    ethernet,
    interface,
    pcap,
    pcapng,
    section,
    tcp,
    udp,
)

FOLDER = Path(os.environ.get("MAVSTACK_REALDATA", "/nonexistent"))
TCP_CAPTURE = FOLDER / "pymavlink_command_long_over_tcp.pcapng"
UDP_CAPTURE = FOLDER / "pymavlink_gps_raw_int.pcapng"


class TestPcap(LogConformance):
    format = "pcap"

    def write(self, folder):
        path = folder / "flight"
        path.write_bytes(pcap([udp(packet) for packet in encoded(MESSAGES)]))
        return path


class TestPcapng(LogConformance):
    format = "pcap"

    def write(self, folder):
        path = folder / "flight"
        path.write_bytes(pcapng([ethernet(udp(packet)) for packet in encoded(MESSAGES)], 1))
        return path


@pytest.fixture
def opened(tmp_path):
    """Return a function that opens the bytes of a capture."""

    def open_bytes(data):
        path = tmp_path / "capture"
        path.write_bytes(data)
        return mavstack.open_log(path)

    return open_bytes


def test_times_are_those_of_the_frames(opened):
    log = opened(pcap([udp(packet) for packet in encoded([common.Heartbeat()] * 3)]))
    assert isinstance(log, CaptureLog)
    assert log["HEARTBEAT"]["_time"].astype(np.int64).tolist() == [START, START + 1000, START + 2000]
    assert log.time_base.kind == "received"


def test_packets_without_a_time(opened):
    packet = udp(encoded([common.Heartbeat()])[0])
    log = opened(section() + interface() + block(3, len(packet).to_bytes(4, "little") + packet))
    assert np.isnat(log["HEARTBEAT"]["_time"]).all()


def test_other_protocols_are_counted_apart(opened):
    heartbeat = encoded([common.Heartbeat()])[0]
    frames = [udp(heartbeat), udp(b"GET / HTTP", CLIENT, (SERVER[0], 80)), b"\x45 no packet"]
    log = opened(pcap(frames))
    assert (log.counts, [str(key) for key in log.flows]) == (
        {"HEARTBEAT": 1},
        ["udp 10.0.0.1:40000 → 10.0.0.2:14550"],
    )
    assert log.skipped.bad_bytes == 0
    assert log.skipped.other == {"frames without UDP or TCP": 1, "bytes of other protocols": 10}


def test_tcp_out_of_order_keeps_the_order_of_the_stream(opened):
    first, second = encoded([common.Attitude(time_boot_ms=number) for number in (1, 2)])
    frames = [tcp(b"", 0, flags=2), tcp(second, 1 + len(first)), tcp(first, 1)]
    assert opened(pcap(frames))["ATTITUDE"]["time_boot_ms"].tolist() == [1, 2]


def test_a_stream_with_many_packets_in_a_segment(opened):
    packets = encoded([common.Heartbeat()] * 60)
    log = opened(pcap([tcp(b"".join(packets), 0)]))
    assert sum(1 for _ in log.records()) == log.counts["HEARTBEAT"] == 60
    assert log.size < log.statistics.packet_bytes + 60 * 8, "the file is shorter than its packets with times"


@pytest.mark.skipif(not TCP_CAPTURE.exists(), reason="MAVSTACK_REALDATA names no folder with captures")
def test_captures_of_real_programs():
    """The packets are those that Wireshark's dissector of MAVLink shows."""
    log = mavstack.open_log(TCP_CAPTURE)
    assert log.counts == {"PARAM_VALUE": 1, "COMMAND_LONG": 2, "COMMAND_ACK": 2, "STATUSTEXT": 2}
    assert log["COMMAND_LONG"]["command"].tolist() == [176, 400]
    assert [text.text for text in log.texts] == [
        "Mode change to LOITER failed: requires position",
        "Disarming motors",
    ]
    # The capture was filtered: segments between the first and the last are missing.
    assert set(log.skipped.other) == {"bytes that the capture misses"}
    log = mavstack.open_log(UDP_CAPTURE)
    assert (log.counts, log.skipped.total) == ({"GPS_RAW_INT": 1}, 0)
