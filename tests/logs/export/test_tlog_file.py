"""Export to tlog, read back by this package and by pymavlink."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import Dialect, common
from mavstack.errors import LogError
from mavstack.logs import merge_logs
from mavstack.logs.export import export_log
from mavstack.logs.export.tlog_file import StreamClock
from mavstack.wire import Encoder, Packet, Signing, encode
from tests.logs.dataflash.writer import flight as dataflash_flight
from tests.logs.files import START, stamped
from tests.logs.flights import flight_tlog, packets
from tests.logs.packets.pcap.captures import pcap, udp

COMMON = Dialect.load("common")


def converted(path, tmp_path, **options):
    """Convert a log, and return the summary and the new log."""
    target = tmp_path / "converted.tlog"
    summary = export_log(open_log(path, "common"), "tlog", target, **options)
    return summary, open_log(target, "common")


def assert_same_tables(log, other):
    assert dict(log.counts) == dict(other.counts)
    for name in log:
        for column in log[name].dtype.names:
            ours, theirs = log[name][column], other[name][column]
            known = ~np.isnat(ours) if column == "_time" else slice(None)
            np.testing.assert_array_equal(ours[known], theirs[known], err_msg=f"{name}.{column}")


@pytest.mark.parametrize(
    "content",
    [
        flight_tlog(),
        pcap([udp(packet) for packet in packets()]),
        b"junk" + flight_tlog()[:2000] + b"\xfd\x09" + flight_tlog()[2000:],
    ],
    ids=["tlog", "pcap", "damaged"],
)
def test_tables_survive(tmp_path, content):
    path = tmp_path / "flight"
    path.write_bytes(content)
    summary, log = converted(path, tmp_path)
    assert log.format == "tlog"
    assert not log.skipped
    assert_same_tables(open_log(path, "common"), log)
    times = [record.packet.timestamp for record in log.records()]
    assert times == sorted(times)
    assert times[0] >= START, "packets without a time get that of their neighbours"
    assert summary.rows == log.counts
    packets_written = sum(log.counts.values())
    assert summary.description == f"{packets_written} packets of 7 messages"


def test_a_sound_tlog_is_copied_byte_for_byte(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    converted(path, tmp_path)
    assert (tmp_path / "converted.tlog").read_bytes() == flight_tlog()


def test_pymavlink_reads_the_same_packets(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from pymavlink import mavutil
    path = tmp_path / "flight.pcap"
    path.write_bytes(pcap([udp(packet) for packet in packets()]))
    _, log = converted(path, tmp_path)
    reader = mavutil.mavlogfile(str(log.path), notimestamps=False)
    found = []
    while (message := reader.recv_msg()) is not None:
        found.append((message.get_type(), bytes(message.get_msgbuf()), round(message._timestamp * 1e6)))
    reader.close()
    records = [record.packet for record in log.records()]
    assert found == [(packet.name, packet.raw, packet.timestamp) for packet in records]
    assert len(found) == 100


def test_signatures_keys_and_secrets_are_left_out(tmp_path):
    signing = Signing(bytes(range(32)))
    messages = [
        common.Attitude(roll=1.0),
        common.SetupSigning(secret_key=bytes(range(32)), initial_timestamp=5),
        common.WifiConfigAp(ssid="field", password="hunter22"),
    ]
    raw = [encode(message, system=1, component=1, signing=signing) for message in messages]
    path = tmp_path / "signed.tlog"
    path.write_bytes(stamped(raw))
    summary, log = converted(path, tmp_path)
    assert log.counts == {"ATTITUDE": 1, "WIFI_CONFIG_AP": 1}
    assert log.statistics.signed == 0
    assert summary.description == "2 packets of 2 messages (without 1 SETUP_SIGNING)"
    content = log.path.read_bytes()
    assert b"hunter22" not in content
    assert bytes(range(32)) not in content
    assert not log.skipped, "the packets have a new CRC"


def test_a_raw_stream_gets_the_times_of_the_vehicle(tmp_path):
    path = tmp_path / "flight.raw"
    path.write_bytes(b"".join(packets()))
    assert open_log(path, "common").format == "raw"
    _, log = converted(path, tmp_path)
    times = log["ATTITUDE"]["_time"].astype("i8")
    assert times.tolist() == [START + second * 10**6 for second in range(10)]
    every = [record.packet.timestamp for record in log.records()]
    assert every == sorted(every)
    assert [record.packet.raw for record in log.records()] == packets()


def test_the_clock_of_a_stream_continues_after_a_reboot():
    def sent(boot_ms, system=1):
        raw = Encoder(system, 1).encode(common.Attitude(time_boot_ms=boot_ms))
        return Packet(raw, COMMON)

    clock = StreamClock(0)
    beat = Packet(Encoder(1, 1).encode(common.Heartbeat()), COMMON)
    sequence = [beat, sent(5000), sent(900_000, system=2), beat, sent(7000), sent(1000), sent(2500)]
    seconds = [clock.time_of(packet) / 1e6 for packet in sequence]
    assert seconds == [0, 5, 5, 5, 7, 7, 8.5]


def test_selected_packets(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    log = open_log(path, "common")
    export_log(log.select(system=2, end=5.0), "tlog", tmp_path / "two.tlog")
    assert open_log(tmp_path / "two.tlog", "common").counts == {"GLOBAL_POSITION_INT": 5, "HEARTBEAT": 5}
    export_log(log, "tlog", tmp_path / "one.tlog", names=["ATTITUDE"])
    assert open_log(tmp_path / "one.tlog", "common").counts == {"ATTITUDE": 10}
    raw = tmp_path / "flight.raw"
    raw.write_bytes(b"".join(packets()))
    with pytest.raises(LogError, match="HEARTBEAT has no time of its own"):
        export_log(open_log(raw, "common").select(end=5.0), "tlog", tmp_path / "x.tlog")
    assert not (tmp_path / "x.tlog").exists()


def test_other_logs_hold_no_packets(tmp_path):
    path = tmp_path / "00000001.BIN"
    path.write_bytes(bytes(dataflash_flight(records=100).data))
    with pytest.raises(LogError, match=r"is a dataflash log, .* only logs of packets \(tlog, raw, pcap\)"):
        export_log(open_log(path), "tlog", tmp_path / "x.tlog")
    tlog = tmp_path / "flight.tlog"
    tlog.write_bytes(flight_tlog())
    merged = merge_logs(open_log(tlog, "common"), open_log(tlog, "common"))
    with pytest.raises(LogError, match="is a merged log"):
        export_log(merged, "tlog", tmp_path / "x.tlog")
    assert not (tmp_path / "x.tlog").exists()


def test_a_file_without_packets_is_no_tlog(tmp_path):
    path = tmp_path / "letter"
    path.write_bytes(b"no packets here")
    with pytest.raises(LogError, match="there is nothing to write; skipped: 15 bad bytes"):
        converted(path, tmp_path)
    assert list(tmp_path.iterdir()) == [path]
