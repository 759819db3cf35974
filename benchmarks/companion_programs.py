"""The programs that `companion.py` measures: `python -m benchmarks.companion_programs NAME TARGET SECONDS`.

TARGET is the port on which the program listens, or the URL of a vehicle. Each prints one JSON object.
"""

from __future__ import annotations

import asyncio
import json
import sys
import time
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_HERTZ: Final = 50
#: Estimates that are sent before the share counts: the first ones import modules and make message classes.
_FIRST: Final = 2 * _HERTZ
_COMMANDS_A_SECOND: Final = 3
_LISTENING: Final = "udpin://127.0.0.1:"


class Share:
    """The share of a core of this process since now."""

    def __init__(self) -> None:
        self._used, self._begun = time.process_time(), time.monotonic()

    @property
    def value(self) -> float:
        """Processor time by elapsed time."""
        return (time.process_time() - self._used) / (time.monotonic() - self._begun)


def corrections_of(second: int) -> list[bytes]:
    """Return the RTCM frames of a second: the station, and two constellations, 800 bytes together."""
    from mavstack.gnss.rtcm import RtcmFrame

    frames = [RtcmFrame.of((1005 << 4).to_bytes(2, "big") + bytes(17)).data]
    for number, size in ((1074, 420), (1084, 350)):
        head = (number << 42 | 7 << 30 | second) << 2
        frames.append(RtcmFrame.of(head.to_bytes(7, "big") + bytes(size - 7)).data)
    return frames


async def odometry(target: str, seconds: float) -> dict[str, Any]:
    """Send odometry at 50 Hz with `vehicle.external`, from callbacks, as a sensor calls them."""
    from mavstack import connect

    async with connect(_LISTENING + target) as connection:
        vehicle = await connection.wait_for_vehicle(timeout=20)
        loop, ended = asyncio.get_running_loop(), asyncio.Event()
        share, begun = Share(), loop.time()

        def measure(number: int) -> None:
            nonlocal share
            if number == _FIRST:
                share = Share()
            vehicle.external.odometry((1.0, 2.0, 3.0), (1.0, 0.0, 0.0, 0.0), velocity=(0.1, 0.2, 0.3))
            if number < _FIRST + seconds * _HERTZ:
                loop.call_at(begun + number / _HERTZ, measure, number + 1)
            else:
                ended.set()

        measure(1)
        await ended.wait()
        return {"share": share.value}


def odometry_pymavlink(target: str, seconds: float) -> dict[str, Any]:
    """Send odometry at 50 Hz with pymavlink, as its examples do."""
    from pymavlink import mavutil

    link = mavutil.mavlink_connection(_LISTENING.replace("://", ":") + target, dialect="common")
    link.wait_heartbeat(timeout=20)
    share, due, nan = Share(), time.monotonic(), float("nan")
    for number in range(_FIRST + round(seconds * _HERTZ)):
        if number == _FIRST:
            share = Share()
        while link.recv_match(blocking=False) is not None:
            pass
        link.mav.odometry_send(
            round(time.time() * 1e6), 20, 12, 1.0, 2.0, 3.0, [1.0, 0.0, 0.0, 0.0], 0.1, 0.2, 0.3,
            nan, nan, nan, [nan] * 21, [nan] * 21, 0, 3, 0,
        )  # fmt: skip
        due += 1 / _HERTZ
        time.sleep(max(due - time.monotonic(), 0))
    return {"share": share.value}


def odometry_mavsdk(target: str, seconds: float) -> dict[str, Any]:
    """Send odometry at 50 Hz with MAVSDK's Mocap plugin."""
    import mavsdk
    from mavsdk.plugins import mocap

    kind = mavsdk.ComponentType.COMPANION_COMPUTER
    station = mavsdk.Mavsdk(mavsdk.Configuration.create_with_component_type(kind))
    station.add_any_connection(_LISTENING + target)
    plugin = mocap.Mocap(station.first_autopilot(20.0))
    unknown = mocap.Covariance(covariance_matrix=[float("nan")])
    share, due = Share(), time.monotonic()
    for number in range(_FIRST + round(seconds * _HERTZ)):
        if number == _FIRST:
            share = Share()
        plugin.set_odometry(
            mocap.Odometry(
                time_usec=round(time.time() * 1e6),
                frame_id=mocap.Odometry.MavFrame.MOCAP_NED,
                position_body=mocap.PositionBody(x_m=1.0, y_m=2.0, z_m=3.0),
                q=mocap.Quaternion(w=1.0, x=0.0, y=0.0, z=0.0),
                speed_body=mocap.SpeedBody(x_m_s=0.1, y_m_s=0.2, z_m_s=0.3),
                angular_velocity_body=mocap.AngularVelocityBody(
                    roll_rad_s=0.0, pitch_rad_s=0.0, yaw_rad_s=0.0
                ),
                pose_covariance=unknown,
                velocity_covariance=unknown,
            )
        )
        due += 1 / _HERTZ
        time.sleep(max(due - time.monotonic(), 0))
    return {"share": share.value}


async def traffic(target: str, seconds: float) -> dict[str, Any]:
    """Show a vehicle the aircraft of a receiver."""
    from mavstack import connect
    from mavstack.vehicle.traffic import TrafficFeed

    async with connect(target) as connection:
        await connection.wait_for_vehicle(timeout=20)
        async with TrafficFeed(connection, sys.argv[4]) as feed:
            await asyncio.sleep(2)
            share, before = Share(), feed.reports
            await asyncio.sleep(seconds)
            reports = feed.reports - before
            return {"share": share.value, "reports": reports, "aircraft": len(feed.aircraft.all())}


def can_frames(target: str, seconds: float) -> dict[str, Any]:
    """Read and send frames with python-can."""
    import can

    with can.Bus(interface="mavlink", channel=_LISTENING + target, bus=1) as bus:
        return _exchange(
            seconds,
            lambda: bus.recv(0.001) is not None,
            lambda: bus.send(can.Message(arbitration_id=1, data=bytes(8), is_extended_id=True)),
        )


def _exchange(seconds: float, receive: Callable[[], bool], send: Callable[[], object]) -> dict[str, Any]:
    begun, received, sent = time.monotonic(), 0, 0
    last = begun
    # On a busy machine the vehicle sends later than it should: the last frame has come if none follows it.
    while (now := time.monotonic()) < max(begun + seconds + 4, last + 2):
        if receive():
            received, last = received + 1, now
        if sent < min((time.monotonic() - begun - 1) * 1000, seconds * 1000):
            send()
            sent += 1
    time.sleep(0.5)
    return {"received": received, "sent": sent}


async def corrections(target: str, seconds: float) -> dict[str, Any]:
    """Measure commands over a radio, then with corrections of `vehicle.rtk`."""
    from mavstack import connect
    from mavstack.dialects import common

    async with connect(target) as connection:
        vehicle = await connection.wait_for_vehicle(timeout=20)
        await asyncio.sleep(5)  # until the pace of the radio is known
        found: dict[str, Any] = {}
        for name in ("without", "with"):
            delays, begun = [], time.monotonic()
            for number in range(round(seconds * _COMMANDS_A_SECOND)):
                if name == "with" and number % _COMMANDS_A_SECOND == 0:
                    vehicle.rtk.send(b"".join(corrections_of(number)))
                sent = time.monotonic()
                await vehicle.component.command(common.MavCmd.DO_SET_HOME, 1)
                delays.append(time.monotonic() - sent)
                # Commands come at all moments of the epoch of the corrections.
                due = begun + (number + 0.1 + number * 0.37 % 0.8) / _COMMANDS_A_SECOND
                await asyncio.sleep(max(due - time.monotonic(), 0))
            found[name] = delays
        return found


def corrections_pymavlink(target: str, seconds: float) -> dict[str, Any]:
    """Measure commands with pymavlink, whose programs send all fragments at once."""
    from pymavlink import mavutil

    link = mavutil.mavlink_connection(target.replace("udpout://", "udpout:"), dialect="common")
    found: dict[str, Any] = {}
    beat = 0.0
    for name in ("without", "with"):
        delays, begun = [], time.monotonic()
        for number in range(round(seconds * _COMMANDS_A_SECOND)):
            if time.monotonic() - beat > 1:
                beat = time.monotonic()
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
            if name == "with" and number % _COMMANDS_A_SECOND == 0:
                _inject(link, number)
            sent = time.monotonic()
            link.mav.command_long_send(1, 1, 179, 0, 1, 0, 0, 0, 0, 0, 0)
            if link.recv_match(type="COMMAND_ACK", blocking=True, timeout=5) is not None:
                delays.append(time.monotonic() - sent)
            due = begun + (number + 0.1 + number * 0.37 % 0.8) / _COMMANDS_A_SECOND
            while (left := due - time.monotonic()) > 0:
                link.recv_match(blocking=True, timeout=left)
        found[name] = delays
    return found


def corrections_mavsdk(target: str, seconds: float) -> dict[str, Any]:
    """Measure commands with MAVSDK, then with corrections of its Rtk plugin."""
    from base64 import b64encode

    import mavsdk
    from mavsdk.plugins import action, rtk

    station = mavsdk.Mavsdk(mavsdk.Configuration.create_manual(245, 190, True))
    station.add_any_connection(target.replace("udpout:", "udpout://"))
    vehicle = station.first_autopilot(20.0)
    actions, source = action.Action(vehicle), rtk.Rtk(vehicle)
    time.sleep(5)
    found: dict[str, Any] = {}
    for name in ("without", "with"):
        delays, begun = [], time.monotonic()
        for number in range(round(seconds * _COMMANDS_A_SECOND)):
            if name == "with" and number % _COMMANDS_A_SECOND == 0:
                for frame in corrections_of(number):
                    source.send_rtcm_data(rtk.RtcmData(b64encode(frame).decode()))
            sent = time.monotonic()
            actions.set_home(True, 0.0, 0.0, 0.0)
            delays.append(time.monotonic() - sent)
            due = begun + (number + 0.1 + number * 0.37 % 0.8) / _COMMANDS_A_SECOND
            time.sleep(max(due - time.monotonic(), 0))
        found[name] = delays
    return found


def _inject(link: Any, second: int) -> None:  # noqa: ANN401 (pymavlink has no types)
    for sequence, frame in enumerate(corrections_of(second)):
        parts = [frame[start : start + 180] for start in range(0, len(frame), 180)]
        for number, part in enumerate(parts):
            flags = (len(parts) > 1) | number << 1 | (sequence & 31) << 3
            link.mav.gps_rtcm_data_send(flags, len(part), bytearray(part.ljust(180, b"\0")))


_PROGRAMS: Final[Mapping[str, Callable[[str, float], Any]]] = MappingProxyType(
    {
        "odometry": odometry,
        "odometry-pymavlink": odometry_pymavlink,
        "odometry-mavsdk": odometry_mavsdk,
        "traffic": traffic,
        "can": can_frames,
        "corrections": corrections,
        "corrections-mavsdk": corrections_mavsdk,
        "corrections-pymavlink": corrections_pymavlink,
    }
)

if __name__ == "__main__":
    made = _PROGRAMS[sys.argv[1]](sys.argv[2], float(sys.argv[3]))
    print(json.dumps(asyncio.run(made) if asyncio.iscoroutine(made) else made), flush=True)
