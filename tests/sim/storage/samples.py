"""Samples of a flight, logs written from these samples, and readers of logs by pymavlink and pyulog."""

from __future__ import annotations

from collections import defaultdict
from io import BytesIO
from math import nan
from typing import NamedTuple

from hypothesis import strategies as st
from pymavlink.DFReader import DFReader_binary
from pyulog import ULog

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from mavstack.sim.storage import FlightSample, LoggedParameter, LogStart

BOOT = 1_700_000_000.0
#: Microseconds.
SECOND = 1_000_000
HOME = (47.3977418, 8.5455939, 488.0)


class Motion(NamedTuple):
    north: float = 12.5
    east: float = -7.25
    down: float = -20.5
    velocity_north: float = 3.5
    velocity_east: float = -1.5
    velocity_down: float = 0.5
    acceleration_north: float = 0.125
    acceleration_east: float = -0.25
    acceleration_down: float = 0.0625
    roll: float = 0.1
    pitch: float = -0.05
    yaw: float = -1.2
    roll_rate: float = 0.01
    pitch_rate: float = -0.02
    yaw_rate: float = 0.03


class Sensors(NamedTuple):
    gyro_x: float = 0.01
    gyro_y: float = -0.02
    gyro_z: float = 0.03
    acceleration_x: float = 0.5
    acceleration_y: float = -0.25
    acceleration_z: float = -9.75
    magnetic_x: float = 0.215
    magnetic_y: float = 0.011
    magnetic_z: float = 0.424
    pressure: float = 955.5
    differential_pressure: float = 1.5
    temperature: float = 21.25
    gps_latitude: float = 47.3978541
    gps_longitude: float = 8.5454981
    gps_altitude: float = 508.51
    gps_velocity_north: float = 3.0
    gps_velocity_east: float = -4.0
    gps_velocity_down: float = 0.5
    gps_fix: int = 3
    gps_satellites: int = 14
    gps_eph: float = 0.71
    gps_epv: float = 1.12
    distance: float = nan
    heading: float = 5.08


class Battery(NamedTuple):
    voltage: float = 15.5
    current: float = 12.25
    consumed: float = 731.5
    remaining: float = 0.86
    temperature: float = 31.5
    capacity: float = 5200.0
    cells: int = 4


class Health(NamedTuple):
    horizontal: bool = True
    vertical: bool = True
    velocity_variance: float = 0.05
    position_variance: float = 0.07
    height_variance: float = 0.02
    compass_variance: float = 0.11


ITEM = MissionItem(common.MavCmd.NAV_WAYPOINT, 1.5, 2, 3, nan, 47.3980001, 8.5460002, 60.0)
PARAMETERS = (
    LoggedParameter("ARMING_CHECK", 1, 1),
    LoggedParameter("WPNAV_SPEED", 750.0, 1000.0),
    LoggedParameter("A_NAME_OF_16_LET", -3, 0),
)


def log_start(**changes) -> LogStart:
    values = {
        "boot": BOOT,
        "firmware": "ArduCopter V4.6.0 (1f2e3d4c)",
        "version": (4, 6, 0),
        "git_hash": "1f2e3d4c",
        "system": 7,
        "vehicle": common.MavType.QUADROTOR,
        "parameters": PARAMETERS,
        "mission": (MissionItem(common.MavCmd.NAV_TAKEOFF, param7=20.0), ITEM),
        "origin": HOME,
        "home": HOME,
        "mode": 5,
    }
    return LogStart(**(values | changes))


def sample(time_us: int = 10_000_000, **changes) -> FlightSample:
    values = {
        "motion": Motion(),
        "sensors": Sensors(),
        "battery": Battery(),
        "latitude": 47.397855,
        "longitude": 8.545498,
        "altitude": 508.5,
        "mode": 5,
        "armed": True,
        "landed": False,
        "rc": (1500, 1510, 1000, 1490, 1800, 1100, 1200, 1300),
        "servos": tuple(1100.0 + 10 * number for number in range(16)),
        "mission_sequence": 1,
        "mission_total": 2,
        "mission_reached": 0,
        "airspeed": 14.5,
        "home_altitude": 488.0,
        "desired_roll": 0.12,
        "health": Health(),
    }
    return FlightSample(time_us, **(values | changes))


def read_dataflash(data: bytes, tmp_path) -> dict[str, list[dict]]:
    """Return all messages by name, as pymavlink reads them."""
    path = tmp_path / "log.BIN"
    path.write_bytes(data)
    reader = DFReader_binary(str(path))
    found = defaultdict(list)
    while (message := reader.recv_msg()) is not None:
        found[message.get_type()].append(message.to_dict())
    reader.filehandle.close()
    return found


def read_ulog(data: bytes) -> ULog:
    log = ULog(BytesIO(data), disable_str_exceptions=False)
    assert not log.file_corruption
    return log


def values_of(log: ULog, topic: str) -> dict[str, list]:
    return {name: values.tolist() for name, values in log.get_dataset(topic).data.items()}


def any_float() -> st.SearchStrategy[float]:
    return st.floats(allow_nan=True, allow_infinity=True)


def any_sample() -> st.SearchStrategy[FlightSample]:
    """Return a strategy for samples with arbitrary values."""

    def record(record_type: type) -> st.SearchStrategy:
        integers = {
            "gps_fix": st.integers(0, 8),
            "gps_satellites": st.integers(0, 99),
            "cells": st.integers(0, 14),
        }
        flags = {"horizontal": st.booleans(), "vertical": st.booleans()}
        return st.builds(
            record_type,
            **{name: integers.get(name, flags.get(name, any_float())) for name in record_type._fields},
        )

    widths = st.lists(any_float() | st.integers(-9, 70_000), max_size=20)
    return st.builds(
        FlightSample,
        time_us=st.integers(0, 2**63),
        motion=record(Motion),
        sensors=record(Sensors),
        battery=record(Battery),
        latitude=any_float(),
        longitude=any_float(),
        altitude=any_float(),
        mode=st.integers(0, 2**32 - 1),
        armed=st.booleans(),
        landed=st.booleans(),
        failsafe=st.booleans(),
        rc=widths,
        servos=widths,
        mission_sequence=st.integers(0, 2**20),
        mission_total=st.integers(0, 2**20),
        mission_reached=st.integers(-1, 2**20),
        airspeed=any_float(),
        home_altitude=any_float(),
        desired_roll=any_float(),
        desired_pitch=any_float(),
        desired_yaw=any_float(),
        health=st.none() | record(Health),
    )


def fly(logs, begin_us: int, samples: int = 20) -> None:
    """Write one flight of `samples` tenths of a second."""
    logs.begin(begin_us)
    for step in range(samples):
        logs.write(sample(begin_us + step * 100_000))
    logs.end()


def content(logs, number: int) -> bytes:
    size = next(log.size for log in logs.logs() if log.id == number)
    return logs.read(number, 0, size)


def paths(store, path: str = "") -> list[str]:
    found = []
    for entry in store.list_directory(path or "/"):
        inside = f"{path}/{entry.name}"
        found += paths(store, inside) if entry.is_directory else [inside]
    return found
