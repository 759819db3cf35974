"""ULogs whose definitions give known names to unexpected types, and records of impossible times."""

from __future__ import annotations

import random
from struct import calcsize

import numpy as np
import pytest

from mavstack import open_log
from mavstack.logs.ulog import ulog
from tests.logs.exercise import exercise
from tests.logs.ulog.ulog_files import UlogBuilder

KNOWN = {
    "vehicle_gps_position": (
        "time_utc_usec", "timestamp_time_relative", "fix_type", "latitude_deg", "longitude_deg",
        "altitude_msl_m", "lat", "lon", "alt", "hdop", "satellites_used",
    ),
    "vehicle_global_position": ("lat", "lon", "alt"),
    "vehicle_status": ("arming_state", "nav_state"),
    "vehicle_attitude": ("q",),
    "vehicle_local_position": ("z", "vz", "xy_reset_counter"),
    "battery_status": ("voltage_v", "current_a", "remaining"),
    "sensor_accel": ("x", "y", "z"),
    "actuator_outputs": ("output",),
}  # fmt: skip
TYPES = {"uint64_t": "Q", "int32_t": "i", "float": "f", "double": "d", "char": "c", "bool": "?"}


@pytest.mark.filterwarnings("ignore:.*encountered in:RuntimeWarning")
@pytest.mark.parametrize("seed", range(6))
def test_known_names_with_any_types(tmp_path, seed):
    rng = random.Random(seed)
    builder, sizes = UlogBuilder().flags(), []
    for name, fields in KNOWN.items():
        parts, size = ["uint64_t timestamp;" if rng.random() < 0.7 else "float timestamp;"], 0
        size += 8 if parts[0].startswith("u") else 4
        for field in fields:
            kind, count = rng.choice(list(TYPES)), rng.choice([0, 0, 4])
            parts.append(f"{kind}{f'[{count}]' if count else ''} {field};")
            size += calcsize(TYPES[kind]) * (count or 1)
        builder.formats(f"{name}:{''.join(parts)}")
        sizes.append(size)
    builder.parameter("MAV_SYS_ID", float("nan")).parameter("MAV_COMP_ID", float("inf"))
    for number, name in enumerate(KNOWN):
        builder.subscribe(number, name)
    for number, size in enumerate(sizes):
        for _ in range(12):
            builder.add("D", number.to_bytes(2, "little") + rng.randbytes(size))
    path = tmp_path / "log.ulg"
    path.write_bytes(builder.data)
    with np.errstate(all="ignore"):
        exercise(open_log(path), tmp_path)


@pytest.mark.parametrize("target", ["csv", "arrow", "parquet"])
@pytest.mark.parametrize("name", ["../../outside", "/tmp/mavstack-outside", "a/b"])
def test_the_name_of_a_table_leads_nowhere(tmp_path, name, target):
    from mavstack.logs.export import export_log

    builder = UlogBuilder().formats(f"{name}:uint64_t timestamp;").subscribe(0, name)
    for time in range(5):
        builder.record(0, "Q", 1_000_000 + time)
    path = tmp_path / "log.ulg"
    path.write_bytes(builder.data)
    folder = tmp_path / "deep" / "out"
    log = open_log(path)
    assert list(log) == [name]
    (written,) = export_log(log, target, folder).files
    assert written.resolve().is_relative_to(folder.resolve())
    assert [item.resolve() for item in tmp_path.rglob("*.*") if item.is_file()] == [
        path.resolve(),
        written.resolve(),
    ]


def test_values_from_before_the_start_do_not_lengthen_the_log(tmp_path):
    builder = UlogBuilder(start_us=20_000_000).flags()
    builder.formats("t:uint64_t timestamp;").subscribe(0, "t")
    for time in (0, 1_400_000, 20_000_000, 25_000_000):
        builder.record(0, "Q", time)
    path = tmp_path / "log.ulg"
    path.write_bytes(builder.data)
    log = open_log(path)
    assert (log.time_span, log.duration) == ((20.0, 25.0), 5.0)
    assert len(log["t"]) == 4
    early = UlogBuilder(start_us=99_000_000).flags().formats("t:uint64_t timestamp;").subscribe(0, "t")
    path.write_bytes(early.record(0, "Q", 7).data)
    assert open_log(path).duration == 0.0


@pytest.mark.parametrize("stored", [True, False])
def test_a_value_of_an_earlier_boot_is_no_end(tmp_path, monkeypatch, stored):
    if not stored:
        monkeypatch.setattr(ulog, "_MAX_STORED", 0)
    builder = UlogBuilder(start_us=20_000_000).flags()
    builder.formats("t:uint64_t timestamp;", "mission:uint64_t timestamp;")
    builder.subscribe(0, "t").subscribe(1, "mission").record(1, "Q", 1_194_000_000)
    for number in range(60):
        builder.record(0, "Q", 20_000_000 + number * 100_000)
    path = tmp_path / "log.ulg"
    path.write_bytes(builder.data)
    assert open_log(path).time_span == (20.0, 25.9)
    builder.record(1, "Q", 27_000_000)
    path.write_bytes(
        builder.data.replace((1_194_000_000).to_bytes(8, "little"), (21_000_000).to_bytes(8, "little"))
    )
    assert open_log(path).time_span == (20.0, 27.0), "a rare topic may end later"
