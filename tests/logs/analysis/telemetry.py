"""The telemetry of a flight of a quadcopter for a minute, sound or with a fault."""

from __future__ import annotations

import dataclasses

from mavstack.dialects import common
from mavstack.wire import Encoder
from tests.logs.files import stamped

SECONDS, RATE = 60, 10
ARMED, DISARMED = 5, 55


@dataclasses.dataclass
class Telemetry:
    """The values of a quadcopter's telemetry at one time; a fault changes them."""

    time: float
    armed: bool
    altitude: float = 0.0
    north: float = 0.0
    vibration: float = 8.0
    clipping: int = 0
    fix: int = 3
    satellites: int = 14
    hdop: float = 0.8
    ratio: float = 0.2
    voltage: float = 12.4
    remaining: int = 80
    board: float = 5.0
    outputs: tuple[int, int, int, int] = (1500, 1510, 1495, 1505)
    roll: float = 0.02
    rssi: int = 200
    noise: int = 50
    heard: bool = True
    texts: tuple[tuple[int, str], ...] = ()
    parameters: tuple[tuple[str, float], ...] = ()


def sound(step: int) -> Telemetry:
    time = step / RATE
    armed = ARMED <= time < DISARMED
    climb = min(time - ARMED, DISARMED - 1 - time, 10.0)
    telemetry = Telemetry(time, armed, altitude=max(climb, 0.0), north=max(time - 10, 0.0))
    if not armed:
        telemetry.outputs = (1000, 1000, 1000, 1000)
    return telemetry


def messages_of(telemetry: Telemetry, step: int):
    boot = round(telemetry.time * 1000)
    if step % RATE == 0:
        yield common.Heartbeat(
            type=common.MavType.QUADROTOR,
            autopilot=common.MavAutopilot.ARDUPILOTMEGA,
            base_mode=129 if telemetry.armed else 1,
            custom_mode=5,
        )
    yield common.Attitude(time_boot_ms=boot, roll=telemetry.roll)
    yield common.GlobalPositionInt(
        time_boot_ms=boot,
        lat=round((47 + telemetry.north / 111_195) * 1e7),
        lon=round(8.5 * 1e7),
        alt=500_000,
        relative_alt=round(telemetry.altitude * 1000),
    )
    yield common.Vibration(
        vibration_x=telemetry.vibration, vibration_y=5, vibration_z=6, clipping_0=telemetry.clipping
    )
    yield common.GpsRawInt(
        fix_type=telemetry.fix,
        satellites_visible=telemetry.satellites,
        eph=round(telemetry.hdop * 100),
        lat=1,
        lon=1,
    )
    ratios = {f"{name}_variance": telemetry.ratio for name in ("compass", "velocity", "pos_horiz")}
    yield (
        common.EkfStatusReport(**ratios)
        if hasattr(common, "EkfStatusReport")
        else common.EstimatorStatus(mag_ratio=telemetry.ratio, vel_ratio=0.1, pos_horiz_ratio=0.1)
    )
    yield common.SysStatus(
        voltage_battery=round(telemetry.voltage * 1000),
        current_battery=1000,
        battery_remaining=telemetry.remaining,
    )
    yield common.PowerStatus(Vcc=round(telemetry.board * 1000))
    one, two, three, four = telemetry.outputs
    yield common.ServoOutputRaw(servo1_raw=one, servo2_raw=two, servo3_raw=three, servo4_raw=four)
    yield common.RadioStatus(
        rssi=telemetry.rssi, remrssi=telemetry.rssi, noise=telemetry.noise, remnoise=telemetry.noise
    )
    yield from (common.Statustext(severity=severity, text=text) for severity, text in telemetry.texts)
    for name, value in telemetry.parameters:
        yield common.ParamValue(param_id=name, param_value=value, param_type=9, param_count=1, param_index=0)


def flight_tlog(change=lambda telemetry: None) -> bytes:
    """Return the tlog of a flight with a fault."""
    encoder, records = Encoder(1, 1), []
    for step in range(SECONDS * RATE):
        telemetry = sound(step)
        change(telemetry)
        if telemetry.heard:
            start = 1_700_000_000_000_000 + step * 100_000
            packets = [encoder.encode(message) for message in messages_of(telemetry, step)]
            records.append(stamped(packets, start, 1))
    return b"".join(records)


def during(start, end, **values):
    """Return a fault: these values from one time to another."""

    def change(telemetry):
        if start <= telemetry.time < end:
            for name, value in values.items():
                setattr(telemetry, name, value)

    return change
