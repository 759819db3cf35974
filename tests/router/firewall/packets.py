"""Packets for the tests of the firewall."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.wire import Encoder, Packet

GROUND, VEHICLE = (255, 190), (1, 1)


class Sender:
    """A sender whose packets have increasing sequence numbers."""

    def __init__(self, system: int = 255, component: int = 190, *, signing=None) -> None:
        self._encoder = Encoder(system, component, signing=signing)

    def packet(self, message, now: float = 1_790_000_000.0) -> Packet:
        return Packet(self._encoder.encode(message, now), common)


def heartbeat(*, armed: bool = False, kind=common.MavType.QUADROTOR) -> common.Heartbeat:
    """The heartbeat of a vehicle."""
    mode = common.MavModeFlag.SAFETY_ARMED if armed else common.MavModeFlag(0)
    return common.Heartbeat(type=kind, autopilot=common.MavAutopilot.PX4, base_mode=mode)


def ground_heartbeat() -> common.Heartbeat:
    return common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID)


def command(number, *params: float, target: int = 1) -> common.CommandLong:
    values = {f"param{index}": value for index, value in enumerate(params, 1)}
    return common.CommandLong(target_system=target, target_component=1, command=number, **values)


def texts(alerts) -> list[str]:
    return [alert.text for alert in alerts]
