"""Writes the recordings of this folder: `python tests/recordings/make.py`; the same bytes on every run.

Small, and with everything that real recordings have: both versions mixed, several sources, losses, junk, a
signed packet, an unknown id, a packet cut off at each end, a step of the clock.
"""

from __future__ import annotations

import random
from pathlib import Path

import mavstack
from mavstack.dialects import ardupilotmega, common
from mavstack.wire import crc16

FOLDER = Path(__file__).parent
START = 1_700_000_000_000_000
#: A message that no dialect has, of a source of its own.
UNKNOWN = bytes.fromhex("fd060000 00 01bf ffff4a") + b"opaque"
AUTOPILOT, CAMERA, GROUND = (1, 1), (1, 100), (255, 190)


class Recorder:
    """Packets with their times; one encoder a source and version."""

    def __init__(self, *, timestamped: bool) -> None:
        self.data = bytearray()
        self.timestamped = timestamped
        self.now = START
        self.sequences: dict[tuple[int, int], int] = {}
        self.signing = mavstack.Signing(bytes(range(32)), 2, timestamp=27_990_000_000_000)

    def add(self, message, source=AUTOPILOT, *, version=2, lost=0, signed=False) -> None:
        """Records a packet, after `lost` ones that were not heard."""
        sequence = self.sequences.get(source, 0) + lost
        self.sequences[source] = sequence + 1
        system, component = source
        raw = mavstack.encode(
            message,
            system=system,
            component=component,
            sequence=sequence % 256,
            version=version,
            signing=self.signing if signed else None,
        )
        self.raw(raw)

    def raw(self, data: bytes) -> None:
        """Records bytes as one packet."""
        if self.timestamped:
            self.data += self.now.to_bytes(8, "big")
        self.data += data
        self.now += 12_500


def flight(recorder: Recorder, rng: random.Random, steps: int) -> None:
    """A short flight as three sources tell it."""
    recorder.data += b"\x03\x51\x04\x03\x9c\x1d"  # the end of a packet whose start was not recorded
    for step in range(steps):
        roll, height = rng.uniform(-0.5, 0.5), 584_000 + step * 100
        recorder.add(common.Attitude(step * 100, roll, -roll, 1.5, 0.01, 0.02, 0.03), lost=int(step == 7))
        recorder.add(
            common.GlobalPositionInt(step * 100, -353632620, 1491652370, height, step * 100, 1, 2, 3, 9000)
        )
        if step % 4 == 0:
            recorder.add(common.Heartbeat(2, 3, 81, step, 4, 3))
            recorder.add(common.Heartbeat(6, 8, 0, 0, 4, 3), GROUND, version=1)
            recorder.add(common.Heartbeat(30, 8, 0, 0, 4, 3), CAMERA, signed=step == 8)
        if step % 5 == 0:
            recorder.add(ardupilotmega.Ahrs(roll, 0, 0, 0, 0.5, 0.25, 0.125))
            recorder.add(common.ParamValue(f"PARAM_{step}", step / 3, 9, 900, step))
        if step == 6:
            recorder.data += b"\xfd\xffnoise on the line\xfe"
        if step == 9:
            recorder.now -= 60_000_000
    recorder.add(common.Statustext(4, "Landed: café", 0, 0), version=1)
    recorder.raw(UNKNOWN + crc16(UNKNOWN[1:] + b"\x07").to_bytes(2, "little"))
    recorder.add(common.Attitude(99_999))
    recorder.data += mavstack.encode(common.Attitude(1, 2.0), system=1, component=1)[:11]


def recordings() -> dict[str, bytes]:
    """All recordings by their file names."""
    made = {}
    for name, timestamped, steps in (("flight.tlog", True, 24), ("link.raw", False, 12)):
        recorder = Recorder(timestamped=timestamped)
        flight(recorder, random.Random(2), steps)
        made[name] = bytes(recorder.data)
    return made


if __name__ == "__main__":
    for file_name, content in recordings().items():
        (FOLDER / file_name).write_bytes(content)
