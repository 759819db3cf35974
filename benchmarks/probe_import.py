"""Time and memory from a bare interpreter to the first packet of a dialect.

    python benchmarks/probe_import.py mavstack|pymavlink|mavutil

The script imports only built-in modules, so that all imports of a library are counted as its own. It prints
the seconds, the growth of the peak resident set in bytes, and the packet.
"""

from __future__ import annotations

import sys
from time import perf_counter


def resident(name: str) -> int:
    """Return one value of /proc/self/status in bytes."""
    with open("/proc/self/status", encoding="ascii") as lines:  # noqa: PTH123 (pathlib would be an import)
        for line in lines:
            if line.startswith(name):
                return int(line.split()[1]) * 1024
    raise LookupError(name)


def with_mavstack() -> bytes:
    import mavstack
    from mavstack.dialects import ardupilotmega

    message = ardupilotmega.Attitude(roll=0.1, pitch=0.2, yaw=0.3)
    return mavstack.encode(message, system=1, component=1, sequence=0)


def with_pymavlink() -> bytes:
    from pymavlink.dialects.v20 import ardupilotmega

    mav = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    packet: bytes = mav.attitude_encode(0, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0).pack(mav)
    return packet


def with_mavutil() -> bytes:
    import os

    os.environ["MAVLINK20"] = "1"
    from pymavlink import mavutil

    mavutil.set_dialect("ardupilotmega")
    mav = mavutil.mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    packet: bytes = mav.attitude_encode(0, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0).pack(mav)
    return packet


def main(library: str) -> None:
    """Encode the first packet with one library, and print its time and memory."""
    work = {"mavstack": with_mavstack, "pymavlink": with_pymavlink, "mavutil": with_mavutil}[library]
    before = resident("VmRSS")
    start = perf_counter()
    packet = work()
    seconds = perf_counter() - start
    print(seconds, resident("VmHWM") - before, packet.hex())


if __name__ == "__main__":
    main(sys.argv[1])
