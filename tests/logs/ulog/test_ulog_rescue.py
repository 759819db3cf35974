"""Repair of ULog files, read by this package and by pyulog."""

from __future__ import annotations

import contextlib
import io
import random
from struct import pack

from mavstack import open_log
from mavstack.errors import LogError
from mavstack.logs.repair import repair_log
from tests.logs.damage import damaged, survivors
from tests.logs.ulog.ulog_files import UlogBuilder, add_samples, definitions, flight

LOG = flight(300)
DEFINITIONS = len(definitions().data)


def messages_of(data):
    """Return begin and end of each message of a sound log."""
    position, found = 16, []
    while position < len(data):
        end = position + 3 + int.from_bytes(data[position : position + 2], "little")
        found.append((position, end))
        position = end
    assert position == len(data)
    return found


def pyulog_rows(path):
    """Return the number of rows that pyulog reads, and whether it finds damage."""
    from pyulog import ULog

    with contextlib.redirect_stdout(io.StringIO()) as output:
        log = ULog(str(path))
    rows = {(item.name, item.multi_id): len(item.data["timestamp"]) for item in log.data_list}
    return rows, log.file_corruption or bool(output.getvalue())


def rows_of(log):
    return {(name, number): rows for name, counts in log.instances.items() for number, rows in counts.items()}


def repaired(tmp_path, content):
    path, new = tmp_path / "damaged.ulg", tmp_path / "new.ulg"
    path.write_bytes(content)
    new.unlink(missing_ok=True)
    return repair_log(path, new), new


def test_a_sound_log_stays_as_it_is(tmp_path):
    repair, path = repaired(tmp_path, LOG)
    assert path.read_bytes() == LOG
    assert (repair.format, repair.dropped_bytes, repair.damage.bad_bytes) == ("ulog", 0, 0)
    assert repair.records == len(messages_of(LOG))


def test_everything_outside_of_the_damage_survives(tmp_path, seeds):
    def scenario(seed):
        content, sound = damaged(LOG, random.Random(seed), first=DEFINITIONS)
        repair, path = repaired(tmp_path, content)
        new = path.read_bytes()
        kept = [new[start:end] for start, end in messages_of(new)]
        assert repair.records == len(kept)
        assert repair.dropped_bytes == len(content) - len(new)
        left = iter(kept)
        for start, end in survivors(messages_of(LOG), sound, followers=1):
            assert LOG[start:end] in left, f"message at {start}"
        log = open_log(path)
        assert (log.skipped.bad_bytes, log.skipped.bad_records, log.skipped.truncated_bytes) == (0, 0, 0)
        rows, corrupt = pyulog_rows(path)
        assert not corrupt
        assert rows == rows_of(log)

    seeds.check(scenario)


def test_any_damage_gives_a_file_that_pyulog_reads(tmp_path, seeds):
    def scenario(seed):
        content, _ = damaged(LOG, random.Random(seed), first=60, places=8)
        try:
            _, path = repaired(tmp_path, content)
        except LogError:
            return
        rows, corrupt = pyulog_rows(path)
        assert not corrupt
        assert rows == rows_of(open_log(path))

    seeds.check(scenario)


def test_appended_data_follows_directly(tmp_path):
    start = len(add_samples(definitions(), 30).data)
    first = add_samples(definitions(UlogBuilder().flags(incompatible=1, offsets=(start + 5, 0, 0))), 30)
    first.data += b"\xff" * 5
    log = first.value("M", "char[5] hardfault_plain", b"crash", b"\x00").data
    repair, path = repaired(tmp_path, bytes(log))
    new = open_log(path)
    assert repair.damage.bad_bytes + repair.damage.truncated_bytes == 5
    assert new.multi_information["hardfault_plain"] == [["crash"]]
    assert not pyulog_rows(path)[1]
    assert path.read_bytes()[27] == 0
    assert path.read_bytes()[35:59] == bytes(24)


def test_unreadable_texts_are_dropped(tmp_path):
    builder = add_samples(definitions(), 30)
    sound = bytes(builder.data)
    builder.add("L", pack("<BQ", ord("4"), 5) + b"caf\xe9").value("P", "float X", b"\0\0").text(9, 3, "good")
    repair, path = repaired(tmp_path, bytes(builder.data))
    assert [text.text for text in open_log(path).texts][-1] == "good"
    assert repair.records == len(messages_of(sound)) + 1
    assert not pyulog_rows(path)[1]
