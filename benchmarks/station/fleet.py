"""Vehicles on UDP, for the benchmark: `python -m benchmarks.station.fleet PORT RATE VEHICLES`.

It sends RATE packets per second in all, in turns from each vehicle, until its standard input is closed; then
it prints the number of packets.
"""

from __future__ import annotations

import select
import socket
import sys
from itertools import cycle
from time import monotonic

from mavstack.dialects import Message
from mavstack.dialects import ardupilotmega as dialect
from mavstack.wire import Encoder

HOST = "127.0.0.1"
#: Seconds between two bursts.
INTERVAL = 0.005
#: At least every this many packets of a vehicle, and once per second, one is a heartbeat.
HEARTBEAT_SHARE = 100


def messages() -> tuple[Message, ...]:
    """Return the messages of a vehicle, in turns."""
    return (
        dialect.Attitude(roll=0.1, pitch=0.2, yaw=1.5, rollspeed=0.01, pitchspeed=0.02, yawspeed=0.03),
        dialect.GlobalPositionInt(lat=473977000, lon=85456000, alt=488000, relative_alt=1000, hdg=9000),
        dialect.VfrHud(airspeed=5.0, groundspeed=5.5, heading=90, throttle=50, alt=488.0, climb=0.5),
        dialect.RcChannels(chancount=8, chan1_raw=1500, chan2_raw=1500, chan3_raw=1100, rssi=200),
    )


def main() -> None:
    """Send until standard input is closed."""
    port, rate, count = map(int, sys.argv[1:4])
    heartbeat = dialect.Heartbeat(type=2, autopilot=3, system_status=3, mavlink_version=3)
    encoders = [Encoder(number + 1, 1) for number in range(count)]
    turns = cycle((encoder, message) for message in messages() for encoder in encoders)
    share = max(1, min(HEARTBEAT_SHARE, rate // count))
    sent, started = 0, monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.setblocking(False)
        while not select.select([sys.stdin], [], [], INTERVAL)[0]:
            due = int((monotonic() - started) * rate)
            while sent < due:
                encoder, message = next(turns)
                is_heartbeat = sent // count % share == 0
                sock.sendto(encoder.encode(heartbeat if is_heartbeat else message), (HOST, port))
                sent += 1
    print(sent)


if __name__ == "__main__":
    main()
