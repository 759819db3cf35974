"""The entry point of a receiver's program, which connects on a command and reports its messages at the end.

    python -m benchmarks.telemetry.MODULE METHOD PORT COUNTER

`COUNTER` is a file of eight bytes with the number of received messages: the sender of the flood reads it, so
that it never exceeds the receive buffer. A thread that waits for the command to end uses no time; it writes
the report and ends the process at any state of the receiver.
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
#: Message id of a receiver that does not decode messages.
UNKNOWN = -1
#: In a flood only the number of further messages is recorded.
MAX_RECORDED = 100_000
#: Three fields of each frequent message; of the others no field is read.
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


class MessageRecorder:
    """The recorder that the receiver's function calls last for each message."""

    def __init__(self, port: int, counter: Path) -> None:
        self.port = port
        self.ids = array("h")
        self.times = array("q")
        self.began = 0
        self._received = 0
        with counter.open("r+b") as file:
            self._counter = memoryview(mmap.mmap(file.fileno(), 8)).cast("q")

    def record(self, message_id: int = UNKNOWN) -> None:
        """Record that a message of this id has reached the program."""
        now = perf_counter_ns()
        self._received = received = self._received + 1
        self._counter[0] = received
        if received <= MAX_RECORDED:
            self.times.append(now)
            self.ids.append(message_id)

    def report(self) -> str:
        """Return all records as JSON; times are of the monotonic clock, which all processes share."""
        return json.dumps({"began": self.began, "ids": self.ids.tolist(), "times": self.times.tolist()})


def serve(methods: Mapping[str, Callable[[MessageRecorder], None]]) -> None:
    """Receive by the method that the command line names; never returns."""
    recorder = MessageRecorder(int(sys.argv[2]), Path(sys.argv[3]))
    output = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # output of the peer itself must not mix with the report
    print(READY, file=output, flush=True)
    sys.stdin.readline()

    def end() -> None:
        sys.stdin.readline()
        output.write(recorder.report())
        output.flush()
        os._exit(0)  # threads of a peer may never end

    Thread(target=end, daemon=True).start()
    recorder.began = perf_counter_ns()
    methods[sys.argv[1]](recorder)
