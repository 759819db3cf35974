"""Logs of real vehicles, which are not in the repository: run with MAVSTACK_REALDATA=/folder.

The table in MANIFEST.md of the folder lists what pymavlink 2.4.50 finds in each file. A reader that recovers
faster after junk finds more packets, never fewer; `EXPLAINED` gives the reason for each difference.
"""

from __future__ import annotations

import ast
import os
import re
from collections import Counter
from pathlib import Path

import pytest

from mavstack.dialects import Dialect
from mavstack.logs import open_log
from mavstack.wire import Parser

FOLDER = Path(os.environ.get("MAVSTACK_REALDATA", "/nonexistent"))
ROW = re.compile(
    r"(?P<messages>\d+) msgs, (?P<types>\d+) types, (?P<versions>\{[^}]*\}), signed (?P<signed>\d+), "
    r"bad (?P<bad_chunks>\d+)/(?P<bad_bytes>\d+) B, sources (?P<sources>\{[^}]*\}), (?P<duration>[\d.]+) s\."
)

#: Our results that differ from the manifest, with the reasons.
EXPLAINED = {
    "node_mavlink_data.mavlink": {
        # Packets without timestamps: pymavlink uses the clock of the autopilot in the messages.
        "duration": 0.0,
        # The file ends inside a packet, which pymavlink does not count.
        "bad_bytes": 11,
    },
    "sitl_px4main.tlog": {
        # Definitions newer than pymavlink 2.4.50, which decodes no header for unknown ids.
        "sources": {"1/1": 6640},
    },
    "dronekit_flight_replay.tlog": {
        # See `bad_bytes_of`; also 19 bytes of a truncated packet at the end.
        "bad_bytes": 17082 + 8 * 1314 + 19,
    },
}
#: Messages that pymavlink 2.4.50 does not define, by its name for them.
NEWER = {
    "UNKNOWN_8": "LINK_NODE_STATUS",
    "UNKNOWN_290": "ESC_INFO",
    "UNKNOWN_291": "ESC_STATUS",
    "UNKNOWN_380": "TIME_ESTIMATE_TO_TARGET",
    "UNKNOWN_410": "EVENT",
    "UNKNOWN_411": "CURRENT_EVENT_SEQUENCE",
    "UNKNOWN_514": "ESTIMATOR_SENSOR_FUSION_STATUS",
}
#: Number of packets of older definitions, which no longer pass their CRC, by message id.
OLDER = {
    # A camera manager of 2023 with older CAMERA_ messages.
    "ardusub_small.tlog": {259: 1, 260: 1, 262: 1, 269: 1},
    # A ground station of 2015 that sends five bytes with id 142 every second.
    "dronekit_flight_replay.tlog": {142: 1314},
}


def manifest():
    """Return the rows of the manifest's table that are logs of packets, by file name."""
    path = FOLDER / "MANIFEST.md"
    rows = {}
    for line in path.read_text().splitlines() if path.exists() else []:
        cells = [cell.strip() for cell in line.split("|")]
        found = ROW.search(line)
        if found and len(cells) > 2:
            rows[cells[1]] = {name: ast.literal_eval(text) for name, text in found.groupdict().items()}
    return rows


LOGS = manifest()
pytestmark = pytest.mark.skipif(not LOGS, reason="MAVSTACK_REALDATA names no folder with a MANIFEST.md")
each_log = pytest.mark.parametrize("name", list(LOGS) or ["none"])


def bad_bytes_of(row):
    """Return the expected bad bytes: pymavlink does not count the timestamp before a damaged packet."""
    return row["bad_bytes"] + 8 * row["bad_chunks"]


@each_log
def test_a_log_matches_the_manifest(name):
    row, explained, log = LOGS[name], EXPLAINED.get(name, {}), open_log(FOLDER / name)
    statistics = log.statistics
    assert sum(log.counts.values()) == statistics.packets == row["messages"]
    assert (len(log), log.unknown) == (row["types"], {})
    versions = {"v1": statistics.version_1, "v2": statistics.version_2}
    assert {version: count for version, count in versions.items() if count} == row["versions"]
    assert statistics.signed == row["signed"]
    sources = {
        f"{system}/{component}": statistics.received
        for (system, component), statistics in log.sources.items()
    }
    assert sources == explained.get("sources", row["sources"])
    assert log.duration == pytest.approx(explained.get("duration", row["duration"]), abs=0.05)
    assert statistics.bad_bytes == explained.get("bad_bytes", bad_bytes_of(row))
    assert log.timestamped is name.endswith(".tlog")


@each_log
def test_pymavlink_finds_as_many_of_each_message(name):
    from pymavlink import mavutil

    log = open_log(FOLDER / name)
    mavutil.set_dialect("all")
    reader = mavutil.mavlogfile(
        str(FOLDER / name), robust_parsing=True, notimestamps=name.endswith(".mavlink")
    )
    found, times = Counter(), []
    while (message := reader.recv_msg()) is not None:
        kind = message.get_type()
        if kind == "BAD_DATA":
            continue
        found[NEWER.get(kind, kind)] += 1
        if kind == "ATTITUDE":
            times.append((message._timestamp, message.roll, message.get_seq()))
    reader.close()
    assert found == log.counts
    if times and log.timestamped:
        table = log["ATTITUDE"]
        ours = zip(table["_time"].astype("i8") / 1e6, table["roll"], table["_sequence"], strict=True)
        assert all(abs(a[0] - b[0]) < 1e-5 and a[1:] == b[1:] for a, b in zip(times, ours, strict=True))


@each_log
@pytest.mark.parametrize("threads", [2, 3])
def test_threads_and_the_parser_find_the_same(name, threads):
    log, other = open_log(FOLDER / name, threads=1), open_log(FOLDER / name, threads=threads)
    parser = Parser(Dialect.load("all"), timestamped=log.timestamped)
    data = (FOLDER / name).read_bytes()
    counts = Counter()
    for start in range(0, len(data), 1000):
        counts.update(packet.name for packet in parser.feed(data[start : start + 1000]))
    counts.update(packet.name for packet in parser.flush())
    assert counts == log.counts == other.counts
    assert parser.statistics == log.statistics == other.statistics
    assert parser.sources == log.sources == other.sources
    for message, table in log.items():
        assert other[message].tobytes() == table.tobytes()


@each_log
def test_bad_bytes_are_of_older_definitions_or_truncated(name):
    data, log = (FOLDER / name).read_bytes(), open_log(FOLDER / name)
    parser = Parser(Dialect.load("all"), timestamped=log.timestamped)
    position, stamp, ids = 0, 8 * log.timestamped, Counter()
    for packet in parser.feed(data) + parser.flush():
        start = data.index(packet.raw, position)
        gap = data[position + stamp : start]
        if len(gap) > stamp:
            ids[int.from_bytes(gap[7:10], "little") if gap[0] == 0xFD else gap[5]] += 1
        position = start + len(packet)
    assert ids == OLDER.get(name, {})


def test_a_log_of_2012_with_other_definitions_is_empty():
    """Its timestamps have the other byte order, and no checksum is valid; nor does pymavlink find packets."""
    log = open_log(FOLDER / "pymavlink_js_capture.mavlink")
    assert (len(log), log.unknown, log.statistics.packets) == (0, {}, 0)
    assert log.statistics.bad_bytes == log.size


def test_other_files_are_empty_logs():
    for path in FOLDER.iterdir():
        if path.name in LOGS or not path.is_file():
            continue
        log = open_log(path)
        for name in log:
            repr(log[name][:1])
