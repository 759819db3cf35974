"""The frame of a receiver's program: it says when it is ready, connects when told, and tells what it heard.

    python -m benchmarks.telemetry.MODULE WAY PORT COUNTER

`COUNTER` is a file of eight bytes in which the number of messages heard stands: the flood's sender looks at
it, so that it never sends more than a receiver can hold. A thread that waits for the word to end takes no
time meanwhile; it writes down what was heard and ends the process, whatever the receiver is doing.
"""

from __future__ import annotations

import json
import mmap
import os
import sys
from array import array
from pathlib import Path
from threading import Thread
from time import perf_counter_ns
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

READY, GO = "ready", "go"
#: Of a receiver that does not know what it hears.
UNKNOWN = -1
#: When more is heard in one process, only the number is kept: it is a flood.
MOST_KEPT = 100_000
#: Three fields of each of the messages that come often; of all others the name is enough.
FIELDS: Mapping[str, tuple[str, str, str]] = {
    "ATTITUDE": ("roll", "pitch", "yaw"),
    "ATTITUDE_QUATERNION": ("q1", "q2", "q3"),
    "GLOBAL_POSITION_INT": ("lat", "lon", "alt"),
    "LOCAL_POSITION_NED": ("x", "y", "z"),
    "ATTITUDE_TARGET": ("q", "thrust", "type_mask"),
    "POSITION_TARGET_LOCAL_NED": ("x", "y", "z"),
    "SERVO_OUTPUT_RAW": ("servo1_raw", "servo2_raw", "servo3_raw"),
    "GPS_RAW_INT": ("lat", "lon", "alt"),
    "VFR_HUD": ("alt", "heading", "throttle"),
    "HEARTBEAT": ("type", "base_mode", "custom_mode"),
}


class Ear:
    """What the receiver's function calls for each message, as the last thing that it does."""

    def __init__(self, port: int, counter: Path) -> None:
        self.port = port
        self.ids = array("h")
        self.times = array("q")
        self.began = 0
        self._heard = 0
        with counter.open("r+b") as file:
            self._counter = memoryview(mmap.mmap(file.fileno(), 8)).cast("q")

    def hear(self, message_id: int = UNKNOWN) -> None:
        """A message of this id is with the program now."""
        now = perf_counter_ns()
        self._heard = heard = self._heard + 1
        self._counter[0] = heard
        if heard <= MOST_KEPT:
            self.times.append(now)
            self.ids.append(message_id)

    def report(self) -> str:
        """Everything, as JSON; times are those of the monotonic clock, the same in all processes."""
        return json.dumps({"began": self.began, "ids": self.ids.tolist(), "times": self.times.tolist()})


def serve(ways: Mapping[str, Callable[[Ear], None]]) -> None:
    """Receive in the way that the command line names, which never returns."""
    ear = Ear(int(sys.argv[2]), Path(sys.argv[3]))
    told = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what a peer itself prints must not get between
    print(READY, file=told, flush=True)
    sys.stdin.readline()

    def end() -> None:
        sys.stdin.readline()
        told.write(ear.report())
        told.flush()
        os._exit(0)  # a peer's threads may never end

    Thread(target=end, daemon=True).start()
    ear.began = perf_counter_ns()
    ways[sys.argv[1]](ear)
