"""Generator of the recordings in this folder: `python tests/recordings/make.py`; each run writes equal bytes.

The recordings are small and contain the properties of real ones: both versions mixed, several sources, packet
loss, junk, a signed packet, an unknown id, a truncated packet at each end, a clock jump.
"""

from __future__ import annotations

import random
from pathlib import Path

import mavstack
from mavstack.dialects import ardupilotmega, common
from mavstack.wire import crc16

FOLDER = Path(__file__).parent
START = 1_700_000_000_000_000
#: A message that is in no dialect, of a separate source.
UNKNOWN = bytes.fromhex("fd060000 00 01bf ffff4a") + b"opaque"
AUTOPILOT, CAMERA, GROUND = (1, 1), (1, 100), (255, 190)


class Recorder:
    """A recorder of packets with their timestamps; each source counts its own sequence numbers."""

    def __init__(self, *, timestamped: bool) -> None:
        self.data = bytearray()
        self.timestamped = timestamped
        self.now = START
        self.sequences: dict[tuple[int, int], int] = {}
        self.signing = mavstack.Signing(bytes(range(32)), 2, timestamp=27_990_000_000_000)

    def add(self, message, source=AUTOPILOT, *, version=2, lost=0, signed=False) -> None:
        """Record a packet, after `lost` packets that were not received."""
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
        """Record bytes as one packet."""
        if self.timestamped:
            self.data += self.now.to_bytes(8, "big")
        self.data += data
        self.now += 12_500


def flight(recorder: Recorder, rng: random.Random, steps: int) -> None:
    """Record a short flight with packets of three sources."""
    recorder.data += b"\x03\x51\x04\x03\x9c\x1d"  # the end of a packet that began before the recording
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
    """Return all recordings by file name."""
    contents = {}
    for name, timestamped, steps in (("flight.tlog", True, 24), ("link.raw", False, 12)):
        recorder = Recorder(timestamped=timestamped)
        flight(recorder, random.Random(2), steps)
        contents[name] = bytes(recorder.data)
    return contents


if __name__ == "__main__":
    for file_name, content in recordings().items():
        (FOLDER / file_name).write_bytes(content)
