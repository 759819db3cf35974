"""A short flight of a quadcopter as a tlog, with a ground station and a second vehicle."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.wire import Encoder
from tests.logs.files import START, stamped

ARMED_AT, LAND_AT, DISARMED_AT, SECONDS = 2, 6, 8, 10
#: Numbers of ArduPilot's copter.
STABILIZE, LAND = 0, 9


def heartbeat(second: int) -> common.Heartbeat:
    armed = ARMED_AT <= second < DISARMED_AT
    return common.Heartbeat(
        type=common.MavType.QUADROTOR,
        autopilot=common.MavAutopilot.ARDUPILOTMEGA,
        base_mode=129 if armed else 1,
        custom_mode=LAND if second >= LAND_AT else STABILIZE,
        system_status=common.MavState.ACTIVE,
        mavlink_version=3,
    )


def position(second: int, *, north: float = 0.0) -> common.GlobalPositionInt:
    return common.GlobalPositionInt(
        time_boot_ms=1000 * second,
        lat=round((47.0 + 1e-4 * second + north) * 1e7),
        lon=round(8.5 * 1e7),
        alt=488_000 + 1000 * second,
        relative_alt=1000 * second,
    )


def packets() -> list[bytes]:
    """Return ten seconds of packets, one in a tenth of a second."""
    copter, second_vehicle, ground = Encoder(1, 1), Encoder(2, 1), Encoder(255, 190)
    found = []
    for second in range(SECONDS):
        attitude = common.Attitude(time_boot_ms=1000 * second, roll=0.1 * second, pitch=float("nan"))
        voltages = [4000 - second, 4001] + [65535] * 8
        messages = [
            (copter, heartbeat(second)),
            (copter, attitude),
            (copter, position(second)),
            (copter, common.BatteryStatus(voltages=voltages, battery_remaining=-1, type=1)),
            (copter, common.Statustext(severity=6, text=f"second {second}")),
            (copter, common.SystemTime(time_unix_usec=START + second * 10**6, time_boot_ms=1000 * second)),
            (ground, common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID)),
            (second_vehicle, heartbeat(0)),
            (second_vehicle, position(second, north=1.0)),
            (copter, common.VfrHud(alt=488.0 + second, climb=1.0)),
        ]
        found += [encoder.encode(message) for encoder, message in messages]
    return found


def flight_tlog() -> bytes:
    """Return the flight as a tlog."""
    return stamped(packets(), step=100_000)
