"""Logs of packets: the mapping, the tables, and the damage of real files."""

from __future__ import annotations

import os
import random

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import mavstack
from mavstack.dialects import Dialect, ardupilotmega, common
from mavstack.errors import DialectError, LogError, UnknownMessageError
from mavstack.logs import HEADER_COLUMNS, Log, PacketLog, open_log, table_dtype
from mavstack.wire.other_formats import other_format
from tests.logs.files import START, assert_same, encoded, parsed, stamped
from tests.wire import raw_packets
from tests.wire.values import random_message

ATTITUDES = [common.Attitude(number, number / 8) for number in range(10)]
UNKNOWN = raw_packets.version_2(0x4A0000, b"opaque", 7)


@pytest.fixture
def write(tmp_path):
    def write(data, name="log.tlog"):
        path = tmp_path / name
        path.write_bytes(data)
        return path

    return write


# the mapping


def test_a_log_is_a_mapping_from_names_to_tables(write):
    packets = encoded([common.Heartbeat(), *ATTITUDES, common.SysStatus()])
    log = open_log(write(stamped(packets) + UNKNOWN))
    assert isinstance(log, Log)
    assert isinstance(log, PacketLog)
    assert set(log) == set(log.keys()) == {"HEARTBEAT", "ATTITUDE", "SYS_STATUS"}
    assert (len(log), "ATTITUDE" in log, "VFR_HUD" in log, 30 in log) == (3, True, False, False)
    assert log.counts == {"HEARTBEAT": 1, "ATTITUDE": 10, "SYS_STATUS": 1}
    assert {name: len(table) for name, table in log.items()} == log.counts
    assert log.unknown == {0x4A0000: 1}
    assert log.get("VFR_HUD") is None
    with pytest.raises(UnknownMessageError, match=r"contains no VFR_HUD; it contains .*ATTITUDE"):
        log["VFR_HUD"]
    with pytest.raises(KeyError):
        log["attitude"]
    assert "13 packets" in repr(log)


def test_columns_are_the_header_and_the_fields_in_the_order_of_the_definition(write):
    log = open_log(write(stamped(encoded(ATTITUDES))))
    table = log["ATTITUDE"]
    fields = ("time_boot_ms", "roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")
    assert table.dtype.names == ("_time", "_system", "_component", "_sequence", "_version", *fields)
    assert [name for name, _, _ in HEADER_COLUMNS] == list(table.dtype.names[:5])
    assert table.dtype["_time"] == np.dtype("M8[us]")
    assert table.dtype["time_boot_ms"] == np.dtype("<u4")
    assert table.dtype["roll"] == np.dtype("<f4")
    assert table.dtype == table_dtype(common.Attitude.definition, table.dtype.itemsize)
    assert table["roll"].tolist() == [number / 8 for number in range(10)]
    assert table["_time"][3] == np.datetime64("2023-11-14T22:13:20.003000")
    assert log["ATTITUDE"] is table


def test_arrays_texts_and_bytes_have_columns_of_their_shape(write):
    messages = [
        common.AttitudeTarget(q=(1, 2, 3, 4)),
        common.ParamValue(param_id="SIXTEEN_LETTERS_"),
        common.GpsRtcmData(data=b"abc"),
        common.BatteryStatus(voltages=range(10)),
    ]
    log = open_log(write(stamped(encoded(messages))))
    assert log["ATTITUDE_TARGET"]["q"].tolist() == [[1, 2, 3, 4]]
    assert log["PARAM_VALUE"]["param_id"].tolist() == [b"SIXTEEN_LETTERS_"]
    assert log["GPS_RTCM_DATA"]["data"].shape == (1, 180)
    assert log["BATTERY_STATUS"]["voltages"].dtype == np.dtype("<u2")


def test_every_message_of_ardupilotmega_with_random_values(write):
    data, rng = [], random.Random(5)
    for case in ("random", "random again", "lowest", "highest", "zero", "base only"):
        messages = [random_message(message, case) for message in Dialect.load("ardupilotmega")]
        rng.shuffle(messages)
        data += encoded(messages)
        data += encoded(
            [message for message in messages if message.definition.id < 256], component=2, version=1
        )
    file = stamped(data)
    log = open_log(write(file), "ardupilotmega")
    expected, parser = parsed(file, ardupilotmega, timestamped=True)
    assert set(log) == set(expected) == set(ardupilotmega.dialect.names)
    for name, packets in expected.items():
        assert_same(log[name], packets)
    assert log.statistics == parser.statistics
    assert log.sources == parser.sources


def test_bytes_after_the_nul_of_a_text_are_cleared(write):
    raw = raw_packets.version_1(253, b"\x01" + b"text\0JUNK".ljust(50, b"!"), 83)
    cut = raw_packets.version_2(253, b"\x02" + ("x" * 49 + "é").encode()[:50], 83)
    log = open_log(write(stamped([raw, cut])))
    assert log["STATUSTEXT"]["text"].tolist() == [b"text", b"x" * 49 + b"\xc3"]
    assert log["STATUSTEXT"]["text"][0].tobytes() == b"text"
    assert log["STATUSTEXT"]["id"].tolist() == [0, 0]


def test_long_and_empty_payloads(write):
    longer = raw_packets.version_2(0, bytes([5, 0, 0, 0, 2, 3, 81, 4, 3]) + b"newer", 50)
    empty = raw_packets.version_2(0, b"", 50)
    table = open_log(write(stamped([longer, empty])))["HEARTBEAT"]
    assert table["custom_mode"].tolist() == [5, 0]
    assert table["mavlink_version"].tolist() == [3, 0]


def test_clear_cache_drops_tables(write):
    log = open_log(write(stamped(encoded([*ATTITUDES, common.Heartbeat()]))))
    first, other = log["ATTITUDE"], log["HEARTBEAT"]
    log.clear_cache("ATTITUDE")
    assert log["ATTITUDE"] is not first
    assert (log["ATTITUDE"] == first).all()
    assert log["HEARTBEAT"] is other
    log.clear_cache("VFR_HUD")
    log.clear_cache()
    assert log["HEARTBEAT"] is not other
    with log as same:
        assert same is log
        kept = log["HEARTBEAT"]
    assert log["HEARTBEAT"] is not kept


def test_tables_outlive_their_log(write):
    table = open_log(write(stamped(encoded(ATTITUDES))))["ATTITUDE"]
    assert table["roll"][9] == 9 / 8
    table["roll"] = 0
    assert table.flags.writeable


def test_duration_and_sources(write):
    packets = encoded(ATTITUDES) + encoded([common.Heartbeat()] * 2, system=255, component=190)
    log = open_log(write(stamped(packets, step=250_000)))
    assert log.duration == 0.25 * 11
    assert {source: item.received for source, item in log.sources.items()} == {(1, 1): 10, (255, 190): 2}
    assert open_log(write(b"".join(packets))).duration == 0


# file formats


def test_a_raw_stream_has_no_timestamps(write):
    log = open_log(write(b"".join(encoded(ATTITUDES)), "link.raw"))
    assert not log.timestamped
    assert np.isnat(log["ATTITUDE"]["_time"]).all()
    assert log["ATTITUDE"]["time_boot_ms"].tolist() == list(range(10))


def test_the_format_is_detected_or_given(write):
    packets = encoded(ATTITUDES)
    for data, timestamped in ((stamped(packets), True), (b"".join(packets), False)):
        path = write(data)
        assert open_log(path).timestamped is timestamped
        assert open_log(path, timestamped=timestamped).statistics.bad_bytes == 0
        other = open_log(path, timestamped=not timestamped)
        assert (other.timestamped, other.counts) == (not timestamped, {"ATTITUDE": 10})
    assert open_log(write(b"".join(packets)), timestamped=False).statistics.bad_bytes == 0
    assert open_log(write(stamped(packets)), timestamped=False).statistics.bad_bytes == 80


def test_the_format_is_detected_after_junk(write):
    for junk in (b"\xfd", b"\xfe\xff", bytes(3), b"log started\r\n", bytes(8), encoded(ATTITUDES)[1][9:]):
        for make, timestamped in ((stamped, True), (b"".join, False)):
            log = open_log(write(junk + make(encoded(ATTITUDES))))
            assert log.timestamped is timestamped
            assert log.counts == {"ATTITUDE": 10}
            assert log.statistics.bad_bytes == len(junk)


def test_the_default_dialect_is_all(write, tmp_path):
    path = write(stamped(encoded([ardupilotmega.Ahrs(), common.Heartbeat()])))
    assert set(open_log(path)) == {"AHRS", "HEARTBEAT"}
    for dialect in ("common", Dialect.load("common")):
        log = open_log(path, dialect)
        assert (set(log), log.unknown) == ({"HEARTBEAT"}, {163: 1})
    xml = tmp_path / "custom.xml"
    xml.write_text(
        '<mavlink><messages><message id="9000" name="MINE"><field type="uint8_t" name="class"/></message>'
        "</messages></mavlink>"
    )
    custom = Dialect.from_xml(xml)
    log = open_log(write(stamped(encoded([custom["MINE"](5)]))), custom)
    assert log["MINE"]["class"].tolist() == [5]
    with pytest.raises(DialectError):
        open_log(path, "no_such_dialect")


def test_signed_and_mixed_versions_are_counted(write):
    signing = mavstack.Signing(bytes(32))
    data = encoded(ATTITUDES[:3], version=1) + encoded(ATTITUDES[3:5])
    data += [mavstack.encode(common.Heartbeat(), system=1, component=1, signing=signing)]
    statistics = open_log(write(stamped(data))).statistics
    assert (statistics.version_1, statistics.version_2, statistics.signed, statistics.packets) == (3, 3, 1, 6)


# damage


def test_files_that_cannot_be_read_raise(tmp_path):
    for path in (tmp_path / "missing.tlog", tmp_path):
        with pytest.raises(LogError, match=path.name):
            open_log(path)
    with pytest.raises(LogError):
        open_log(str(tmp_path / "no" / "such" / "folder.tlog"))


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may read anything")
def test_a_file_without_permission_raises(write):
    path = write(b"")
    path.chmod(0)
    with pytest.raises(LogError, match="ermission"):
        open_log(path)


@pytest.mark.parametrize("data", [b"", b"\n", b"\xfd", b"\xfe" * 1000, b"a text file\n" * 500, bytes(5000)])
def test_files_without_packets_are_empty_logs(write, data):
    log = open_log(write(data))
    assert (len(log), dict(log), log.counts, log.unknown, log.sources) == (0, {}, {}, {}, {})
    assert (log.duration, log.statistics.packets) == (0, 0)
    assert log.statistics.bad_bytes == len(data) == log.size
    log.load()


@pytest.mark.skipif(os.name != "posix", reason="no such device")
def test_an_empty_device_is_an_empty_log():
    assert len(open_log("/dev/null")) == 0


def test_a_truncated_file_gives_its_complete_packets(write):
    whole = stamped(encoded(ATTITUDES[:4]))
    ends = [0]
    for raw in encoded(ATTITUDES[:4]):
        ends.append(ends[-1] + 8 + len(raw))
    for cut in range(len(whole) + 1):
        expected = sum(end <= cut for end in ends[1:])
        assert open_log(write(whole[:cut]), timestamped=True).counts.get("ATTITUDE", 0) == expected
        later = open_log(write(whole[cut:]), timestamped=True).counts.get("ATTITUDE", 0)
        # A packet with a truncated timestamp still counts.
        assert later == sum(start + 8 >= cut for start in ends[:-1])


def test_unordered_timestamps_stay_with_their_packets(write):
    times = [START, START + 5, START - 10**9, START + 7, 0, START + 3]
    packets = encoded(ATTITUDES[: len(times)])
    data = b"".join(time.to_bytes(8, "big") + raw for time, raw in zip(times, packets, strict=True))
    table = open_log(write(data))["ATTITUDE"]
    assert table["_time"].astype("i8").tolist() == times
    assert table["time_boot_ms"].tolist() == list(range(len(times)))


def test_a_duration_is_never_negative(write):
    packets = encoded(ATTITUDES[:2])
    log = open_log(write(stamped(packets, step=-5_000_000)), timestamped=True)
    assert log.duration >= 0


def test_junk_before_a_packet_is_not_a_timestamp(write):
    packets = encoded(ATTITUDES[:3])
    data = stamped(packets[:1]) + b"\xff" * 20 + packets[1] + b"some junk here" + packets[2]
    log = open_log(write(data), timestamped=True)
    assert log.duration < 1e6
    assert np.isnat(log["ATTITUDE"]["_time"]).tolist() == [False, True, True]


def test_a_packet_without_timestamp_among_others(write):
    packets = encoded(ATTITUDES)
    data = stamped(packets[:5]) + packets[5] + stamped(packets[6:], START + 6000)
    log = open_log(write(data))
    times = log["ATTITUDE"]["_time"]
    assert np.isnat(times).tolist() == [number == 5 for number in range(10)]
    assert log.statistics.bad_bytes == 0


def test_a_file_truncated_while_open_raises(write):
    path = write(stamped(encoded(ATTITUDES * 2000)))
    log = open_log(path)
    heartbeats = open_log(path)
    os.truncate(path, 100)
    for _ in range(2):
        with pytest.raises(LogError, match="truncated"):
            log["ATTITUDE"]
    assert heartbeats.counts == {"ATTITUDE": 20_000}


@pytest.mark.skipif(os.name != "posix", reason="Windows refuses to truncate a mapped file")
def test_a_file_that_is_written_later_is_decoded_unless_it_changed(write):
    path = write(stamped(encoded(ATTITUDES)))
    same, changed = open_log(path), open_log(path)
    with path.open("r+b") as writer:
        assert same["ATTITUDE"]["time_boot_ms"].tolist() == list(range(10))
        writer.write(b"junk" * 10)
        writer.flush()
        with pytest.raises(LogError, match="rewritten since it was opened; open it again"):
            changed["ATTITUDE"]


def test_a_file_that_grows_while_open_is_not_read_further(write):
    path = write(stamped(encoded(ATTITUDES)))
    log = open_log(path)
    with path.open("ab") as file:
        file.write(stamped(encoded(ATTITUDES)))
    assert len(log["ATTITUDE"]) == 10
    assert len(open_log(path)["ATTITUDE"]) == 20


pieces = st.lists(
    st.one_of(
        st.binary(max_size=30),
        st.integers(0, 9).map(lambda number: stamped(encoded(ATTITUDES[number : number + 1]))),
        st.just(UNKNOWN),
        st.just(encoded([common.Heartbeat()], version=1)[0]),
    ),
    max_size=12,
).map(b"".join)


@settings(max_examples=50)
@given(pieces, st.booleans())
def test_a_log_equals_the_packets_of_the_parser(tmp_path_factory, data, timestamped):
    assume(other_format(data) is None)  # Hypothesis tries constants of the source, such as these magics
    path = tmp_path_factory.getbasetemp() / "property.tlog"
    path.write_bytes(data)
    log = open_log(path, "common", timestamped=timestamped)
    expected, parser = parsed(data, common, timestamped=timestamped)
    unknown = expected.pop(None, [])
    assert log.counts == {name: len(packets) for name, packets in expected.items()}
    assert sum(log.unknown.values()) == len(unknown)
    assert log.statistics == parser.statistics
    assert log.sources == parser.sources
    for name, packets in expected.items():
        if all(packet.timestamp is None or packet.timestamp < 2**63 for packet in packets):
            assert_same(log[name], packets)


# threads


def large_log(seed):
    """Return more than 4 MB with packet loss, late packets, junk and clock jumps."""
    rng = random.Random(seed)
    packets = []
    for component in (1, 2, 3):
        messages = [
            random_message(rng.choice(list(Dialect.load("common"))), "half", number) for number in range(400)
        ]
        packets += encoded(messages, component=component) * 3
    out, size = [], 0
    while size < 4_500_000:
        raw = rng.choice(packets)
        junk = rng.randbytes(rng.randrange(300)) if rng.random() < 0.01 else b""
        piece = junk + (START + size * 7).to_bytes(8, "big") + raw
        out.append(piece)
        size += len(piece)
    return b"".join(out)


@pytest.mark.parametrize("timestamped", [True, False])
def test_several_threads_give_the_result_of_one(write, timestamped):
    path = write(large_log(1))
    one, two, many = (open_log(path, timestamped=timestamped, threads=number) for number in (1, 2, 5))
    for other in (two, many):
        assert (other.counts, other.unknown) == (one.counts, one.unknown)
        assert other.statistics == one.statistics
        assert other.duration == one.duration
        received = {source: (item.received, item.bytes) for source, item in one.sources.items()}
        assert {source: (item.received, item.bytes) for source, item in other.sources.items()} == received
        for name, table in one.items():
            assert other[name].tobytes() == table.tobytes()
    assert one.statistics.bad_bytes > 0


def test_several_threads_count_loss_like_one(write):
    """A late packet at the border between the segments of two threads is included."""
    heartbeats = encoded([common.Attitude(number) for number in range(256)])
    swapped = [heartbeats[number ^ 1] for number in range(256)]
    for offset in range(4):
        path = write(b"x" * (offset * 31) + stamped(swapped * 500))
        one, two = (open_log(path, threads=number) for number in (1, 2))
        assert one.sources == two.sources
