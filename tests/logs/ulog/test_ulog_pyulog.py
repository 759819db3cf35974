"""The reader against pyulog: every topic, instance, field and value, and all other messages."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from mavstack.logs.ulog import ULog
from tests.logs.ulog.comparison import PyUlog, assert_same
from tests.logs.ulog.ulog_files import FORMATS, START_US, UlogBuilder, add_samples, definitions, flight

FOLDER = Path(os.environ.get("MAVSTACK_REALDATA", "/nonexistent"))
REAL_LOGS = sorted(FOLDER.glob("*.ulg"))


@pytest.mark.parametrize("count", [0, 1, 300])
def test_a_flight(written, count):
    ours, _ = assert_same(written(flight(count)))
    assert not ours.skipped


def test_version_0_without_flags(written):
    data = add_samples(definitions(UlogBuilder(version=0)), 50).data
    assert_same(written(data))


@pytest.mark.parametrize("cut", [1, 2, 3, 4, 5, 30, 31, 32, 33])
def test_a_truncated_log(written, cut):
    data = flight(40)[:-cut]
    ours, _ = assert_same(written(data))
    assert ours.skipped.truncated_bytes > 0
    assert ours.skipped.total == ours.skipped.truncated_bytes


def test_unusable_records(written, capfd):
    builder = add_samples(definitions(), 20).record(77, "Q", 1).record(0, "Q", 1).add("Z", b"a later kind")
    ours, peer = assert_same(written(add_samples(builder, 20, first=20).data))
    assert (ours.skipped.unknown, ours.skipped.bad_records) == ({77: 1}, 1)
    assert ours.skipped.other == {"messages of unknown kind 'Z'": 1}
    assert peer.file_corruption
    assert "77" in capfd.readouterr().out


def test_padding_at_the_end_of_a_record(written):
    """A writer may include it: pyulog 1.2 takes such a record for damage."""
    builder = definitions().record(5, "QQiB3x", START_US, 0, 0, 3)
    path = written(builder.data)
    assert ULog(path).counts == {"vehicle_gps_position": 1}
    assert not PyUlog(str(path)).data_list


def test_appended_data(written):
    """Pyulog forgets the subscriptions at the beginning of appended data, and therefore loses records."""
    cut = add_samples(definitions(), 30).data[:-7]
    length = len(cut)
    whole = UlogBuilder().flags(incompatible=1, offsets=(length, 0, 0)).data + cut[16 + 43 :]
    appended = (
        UlogBuilder().text(START_US, 3, "hard fault").value("M", "char[4] crash", b"dump", b"\0").data[16:]
    )
    ours, peer = assert_same(written(whole + appended))
    assert [text.text for text in ours.logged_texts][-1] == "hard fault"
    assert ours.skipped.truncated_bytes == ours.skipped.total > 0
    records = add_samples(UlogBuilder(), 30, first=30).data[16:]
    path = written(whole + records)
    assert ULog(path).counts["attitude"] == 30 + 30
    assert len(PyUlog(str(path)).get_dataset("attitude").data["timestamp"]) == 30
    assert peer.has_data_appended


def test_offsets_of_appended_data_outside_the_file(written):
    data = add_samples(definitions(UlogBuilder().flags(incompatible=1, offsets=(10, 1 << 60, 0))), 10).data
    ours = ULog(written(data))
    assert ours.counts["attitude"] == 10
    assert ours.skipped.other == {"unusable offsets of appended data": 2}


def test_damage_that_pyulog_does_not_survive(written):
    """A damaged size: pyulog goes on at the next synchronisation mark, this reader at the next message."""
    data = bytearray(flight(300))
    place = data.index(b"D\x00\x00", len(data) // 2) - 2
    data[place : place + 2] = b"\x05\x01"
    path = written(data)
    ours, peer = ULog(path), PyUlog(str(path))
    found = {f"{data.name}[{data.multi_id}]": len(data.data["timestamp"]) for data in peer.data_list}
    assert ours.counts["attitude"] == 299 > found["attitude[0]"]
    assert all(len(ours[name]) >= count for name, count in found.items())
    assert ours.skipped.bad_bytes > 0


def test_a_definition_without_fields(written):
    builder = UlogBuilder().formats("empty:", *FORMATS).subscribe(0, "empty").subscribe(1, "numbers")
    ours = ULog(written(builder.record(0, "").record(1, "QqiIhHbB", *range(8)).data))
    assert ours.counts == {"numbers": 1}
    assert (ours.skipped.unknown, ours.skipped.other) == ({0: 1}, {"unusable definitions": 2})


@pytest.mark.skipif(not REAL_LOGS, reason="MAVSTACK_REALDATA names no folder with .ulg files")
@pytest.mark.parametrize("path", REAL_LOGS, ids=lambda path: path.name)
def test_logs_of_real_vehicles(path):
    ours, _ = assert_same(path)
    assert ours.counts
    assert not ours.skipped
