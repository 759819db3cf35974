"""Repair of binary DataFlash logs, read by this package and by pymavlink."""

from __future__ import annotations

import contextlib
import io
import random

from mavstack import open_log
from mavstack.errors import LogError
from mavstack.logs.repair import repair_log
from tests.logs.damage import damaged, survivors
from tests.logs.dataflash.writer import FMT, LogWriter, flight

LOG = bytes(flight(records=300).data)
#: Bytes of the definitions at the beginning, and of the records that name units.
DEFINITIONS = LOG.index(b"ArduCopter V4") - 11


def records_of(data):
    """Return begin and end of each record of a sound log, by its own definitions."""
    lengths, position, found = {FMT: 89}, 0, []
    while position < len(data):
        assert data[position : position + 2] == b"\xa3\x95", position
        kind = data[position + 2]
        if kind == FMT:
            lengths[data[position + 3]] = data[position + 4]
        found.append((position, position + lengths[kind]))
        position += lengths[kind]
    assert position == len(data)
    return found


def pymavlink_names(path):
    """Return the record types that pymavlink reads in the file, in order, and what it complains about."""
    from pymavlink import DFReader

    complaints = io.StringIO()
    with contextlib.redirect_stderr(complaints), contextlib.redirect_stdout(complaints):
        reader = DFReader.DFReader_binary(str(path))
        names = []
        while (message := reader.recv_msg()) is not None:
            names.append(message.get_type())
    reader.filehandle.close()
    return names, complaints.getvalue()


def repaired(tmp_path, content):
    path, new = tmp_path / "damaged.BIN", tmp_path / "new.BIN"
    path.write_bytes(content)
    new.unlink(missing_ok=True)
    return repair_log(path, new), new


def test_a_sound_log_stays_as_it_is(tmp_path):
    repair, path = repaired(tmp_path, LOG)
    assert path.read_bytes() == LOG
    assert (repair.format, repair.dropped_bytes, repair.damage.total) == ("dataflash", 0, 0)
    assert repair.records == len(records_of(LOG)) == sum(open_log(path).counts.values())


def test_everything_outside_of_the_damage_survives(tmp_path, seeds):
    def scenario(seed):
        content, sound = damaged(LOG, random.Random(seed), first=DEFINITIONS)
        repair, path = repaired(tmp_path, content)
        new = path.read_bytes()
        kept = [new[start:end] for start, end in records_of(new)]
        assert repair.records == len(kept)
        assert repair.kept_bytes == len(new)
        assert repair.dropped_bytes == len(content) - len(new)
        left = iter(kept)
        for start, end in survivors(records_of(LOG), sound):
            assert LOG[start:end] in left, f"record at {start}"
        log = open_log(path)
        assert not log.skipped
        names, complaints = pymavlink_names(path)
        assert complaints == ""
        assert len(names) == repair.records

    seeds.check(scenario)


def test_any_damage_gives_a_file_that_pymavlink_reads(tmp_path, seeds):
    def scenario(seed):
        content, _ = damaged(LOG, random.Random(seed), places=8)
        try:
            repair, path = repaired(tmp_path, content)
        except LogError:
            return
        names, complaints = pymavlink_names(path)
        assert complaints == ""
        assert len(names) == repair.records == len(records_of(path.read_bytes()))
        assert not open_log(path).skipped

    seeds.check(scenario)


def test_reasons_of_what_was_dropped(tmp_path):
    log = LogWriter()
    log.write("MSG", 1000, "one")
    log.data += b"\xa3\x95\x63 a type without a definition"
    log.define(99, "NEW", "Q?", "TimeUS,x", length=12)
    log.data += b"\xa3\x95\x63" + bytes(9)
    log.write("MSG", 2000, "two")
    repair, path = repaired(tmp_path, bytes(log.data))
    assert open_log(path).counts["MSG"] == 2
    assert "NEW" not in open_log(path)
    assert "1 record of unknown id 99" in repair.damage.describe()
    assert "2 records that other readers cannot read" in repair.damage.describe()
    assert repair.to_dict()["damage"]["total"] == repair.damage.total
