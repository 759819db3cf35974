"""Repair of damaged logs of packets."""

from __future__ import annotations

import pytest

from mavstack import open_log
from mavstack.dialects import Dialect
from mavstack.errors import InvalidArgumentError, LogError
from mavstack.logs.repair import repair_log
from tests.logs.flights import flight_tlog, packets
from tests.logs.packets.pcap.captures import pcap, udp

COMMON = Dialect.load("common")


def test_packets_between_damage_are_kept(tmp_path):
    sound = flight_tlog()
    damaged = tmp_path / "damaged.tlog"
    damaged.write_bytes(b"noise" * 7 + sound[:900] + b"\xfd" * 50 + sound[900:-5])
    calls = []
    repair = repair_log(damaged, tmp_path / "new.tlog", COMMON, lambda *done: calls.append(done))
    log = open_log(tmp_path / "new.tlog", "common")
    assert repair.records == log.statistics.packets == 99
    assert not log.skipped
    assert repair.kept_bytes == log.size
    assert repair.dropped_bytes == damaged.stat().st_size - log.size
    assert calls[-1] == (damaged.stat().st_size,) * 2
    whole = tmp_path / "whole.tlog"
    whole.write_bytes(sound)
    kept = {int(time.astype("i8")) for time in log["ATTITUDE"]["_time"]}
    assert kept <= {int(time.astype("i8")) for time in open_log(whole, "common")["ATTITUDE"]["_time"]}


def test_a_sound_log_stays_as_it_is(tmp_path):
    for name, data in (("a.tlog", flight_tlog()), ("a.raw", b"".join(packets()))):
        (tmp_path / name).write_bytes(data)
        repair = repair_log(tmp_path / name, tmp_path / f"new-{name}", COMMON)
        assert (tmp_path / f"new-{name}").read_bytes() == data
        assert repair.dropped_bytes == 0


def test_the_last_packet_behind_a_false_start_is_kept(tmp_path):
    sound = b"".join(packets()[:3])
    # The beginning of a packet of 255 bytes, which the parser waits for.
    (tmp_path / "a.raw").write_bytes(sound + b"\xfd\xff\0\0\0" + packets()[3])
    repair = repair_log(tmp_path / "a.raw", tmp_path / "new.raw", COMMON)
    assert (repair.records, repair.dropped_bytes) == (4, 5)


@pytest.mark.parametrize("content", [b"", b"no packet at all", b"\x89PNG\r\n\x1a\n" + bytes(100)])
def test_a_file_without_packets_is_refused(tmp_path, content):
    path = tmp_path / "x"
    path.write_bytes(content)
    with pytest.raises(LogError, match=f"cannot repair {path}"):
        repair_log(path, tmp_path / "new", COMMON)
    assert list(tmp_path.iterdir()) == [path]


def test_files_are_never_overwritten(tmp_path):
    path = tmp_path / "x.tlog"
    path.write_bytes(flight_tlog())
    with pytest.raises(LogError, match="never overwrites"):
        repair_log(path, path, COMMON)
    with pytest.raises(LogError, match="No such file"):
        repair_log(tmp_path / "none", tmp_path / "new", COMMON)


def test_other_formats_are_refused(tmp_path):
    path = tmp_path / "x"
    path.write_bytes(pcap([udp(packet) for packet in packets()]))
    with pytest.raises(LogError, match="this is a capture; convert it to a tlog"):
        repair_log(path, tmp_path / "new", COMMON)
    path.write_text("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n")
    with pytest.raises(LogError, match="this is a log as text"):
        repair_log(path, tmp_path / "new", COMMON)
    with pytest.raises(InvalidArgumentError, match="format must be one of"):
        repair_log(path, tmp_path / "new", COMMON, format="xyz")
    assert list(tmp_path.iterdir()) == [path]
