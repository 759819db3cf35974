"""ULog (`.ulg`) to columns: a generated flight of PX4, read by Mavstack and by pyulog.

The log is a cycle of records, repeated with advancing times: the records of one second at the rates of PX4's
default logging profile, with random values. numpy writes it; neither reader takes part.
"""

from __future__ import annotations

from dataclasses import dataclass
from struct import pack
from typing import TYPE_CHECKING, Final

import numpy as np

import mavstack

from .onboard_logs import OnboardLog, measure

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path
    from typing import Any

    from numpy.typing import NDArray

    from mavstack.logs import MessageTable

    from .measure import Row
    from .rows import Bench

SEED: Final = 20150101
SLICE_SIZE: Final = 8_000_000
PYULOG: Final = "pyulog"
START_US: Final = 1_000_000
SYNC: Final = b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"
SIZES: Final = {
    "uint64_t": 8,
    "float": 4,
    "int32_t": 4,
    "uint32_t": 4,
    "uint16_t": 2,
    "uint8_t": 1,
    "bool": 1,
}


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic.

    Attributes:
        name: Name of the topic.
        hertz: Rate of each instance in hertz.
        fields: Types of the fields after `timestamp`, with the number of elements (`float*3`).
        instances: Number of instances.
    """

    name: str
    hertz: int
    fields: str
    instances: int = 1

    @property
    def columns(self) -> tuple[tuple[str, int], ...]:
        """Type and number of elements of each field; 0 for a single value."""
        pairs = (field.partition("*")[::2] for field in self.fields.split())
        return tuple((kind, int(count or 0)) for kind, count in pairs)

    @property
    def definition(self) -> str:
        """The text of the definition."""
        types = (f"{kind}[{count}]" if count else kind for kind, count in self.columns)
        fields = "".join(f"{kind} field_{number};" for number, kind in enumerate(types))
        return f"{self.name}:uint64_t timestamp;{fields}"

    @property
    def length(self) -> int:
        """Length of a record in bytes."""
        return 8 + sum(SIZES[kind] * (count or 1) for kind, count in self.columns)


TOPICS: Final = (
    Topic("sensor_combined", 250, "float*3 uint32_t int32_t float*3 uint32_t uint8_t*3"),
    Topic("vehicle_attitude", 50, "uint64_t float*4 float*4 uint8_t"),
    Topic("vehicle_angular_velocity", 50, "uint64_t float*3 float*3"),
    Topic("vehicle_rates_setpoint", 50, "float float float float*3 bool"),
    Topic("vehicle_attitude_setpoint", 50, "float float float float float*4 float*3 bool bool"),
    Topic("actuator_motors", 50, "uint64_t uint16_t float*12"),
    Topic("actuator_outputs", 20, "uint32_t float*16", 2),
    Topic("vehicle_local_position", 20, "uint64_t uint64_t uint64_t float*24 bool*8 uint8_t*6"),
    Topic("vehicle_local_position_setpoint", 20, "float float float float float float float*3 float*3"),
    Topic("estimator_states", 5, "uint64_t float*25 float*25 uint8_t", 2),
    Topic("estimator_innovations", 5, "uint64_t float*40", 2),
    Topic("sensor_gps", 5, "uint64_t int32_t int32_t int32_t float*12 uint8_t*6"),
    Topic("battery_status", 5, "float*14 uint16_t*6 uint8_t*4 bool*4", 2),
    Topic("vehicle_imu_status", 2, "uint32_t*12 float*20 uint8_t*2", 3),
    Topic("vehicle_status", 2, "uint64_t uint64_t uint64_t uint32_t uint8_t*20 bool*16"),
    Topic("input_rc", 5, "uint64_t int32_t uint16_t*18 uint8_t*4 bool*2"),
)


def write(path: Path, size: int) -> int:
    """Write a log of about `size` bytes; return its number of records."""
    head = b"ULog\x01\x12\x35" + pack("<BQ", 1, START_US) + _message("B", bytes(40))
    head += b"".join(_message("F", topic.definition.encode()) for topic in TOPICS)
    head += b"".join(
        _message("A", pack("<BH", instance, number) + topic.name.encode())
        for number, (topic, instance) in enumerate(_subscriptions())
    )
    cycle, times = _cycle()
    turns = size // len(cycle)
    data = np.tile(cycle, (turns, 1))
    seconds = np.arange(1, turns + 1, dtype="<u8") * 1_000_000
    for number, start in enumerate(times):
        stamps = seconds + np.uint64(START_US + number * 1_000_000 // len(times))
        data[:, start : start + 8] = stamps.view(np.uint8).reshape(turns, 8)
    with path.open("wb") as file:
        file.write(head)
        data.tofile(file)
    return turns * len(times)


def _message(kind: str, body: bytes) -> bytes:
    return pack("<HB", len(body), ord(kind)) + body


def _subscriptions() -> list[tuple[Topic, int]]:
    return [(topic, instance) for topic in TOPICS for instance in range(topic.instances)]


def _cycle() -> tuple[NDArray[np.uint8], list[int]]:
    """Return the records of one second, and the positions of their times."""
    random = np.random.default_rng(SEED)
    due = sorted(
        (turn / topic.hertz, number)
        for number, (topic, _) in enumerate(_subscriptions())
        for turn in range(topic.hertz)
    )
    topics = [topic for topic, _ in _subscriptions()]
    data, times = bytearray(), []
    for turn, number in due:
        if turn == 0 and number == 0:
            data += _message("S", SYNC)
        times.append(len(data) + 5)
        # Values of 0 and 1 are truth values, and no NaN, which compare unequal.
        body = random.integers(0, 2, topics[number].length, np.uint8)
        data += _message("D", pack("<H", number) + body.tobytes())
    return np.frombuffer(bytes(data), np.uint8), times


def pyulog_columns(path: Path) -> dict[str, Mapping[str, NDArray[Any]]]:
    """Decode a log to columns with pyulog: all topics and all fields."""
    from pyulog import ULog

    return {f"{data.name}[{data.multi_id}]": data.data for data in ULog(str(path)).data_list}


def our_columns(path: Path, threads: int = 0) -> dict[str, MessageTable]:
    """Decode a log to columns: all topics and all fields; by default on all cores."""
    log = mavstack.open_log(path, threads=threads)
    log.load()
    return dict(log)


def _count(tables: Mapping[str, Any]) -> int:
    return sum(len(table["timestamp"]) for table in tables.values())


def _assert_equal(path: Path) -> None:
    """Raise if both readers decode different columns."""
    ours = mavstack.open_log(path)
    for name, table in pyulog_columns(path).items():
        for field, column in table.items():
            if not (ours[name][field].astype(column.dtype) == column).all():
                raise RuntimeError(f"{name}.{field} differs")


LOG: Final = OnboardLog(
    ".ulg",
    SLICE_SIZE,
    write,
    _assert_equal,
    _count,
    our_columns,
    PYULOG,
    pyulog_columns,
    5,
    "vehicle_attitude",
)


def rows(bench: Bench, *, quick: bool) -> Iterator[Row]:
    """Compare speed and memory of decoding a log; the peer reads a part of it."""
    return measure(bench, LOG, quick=quick)
