"""A simulated PX4 and a ground station, in virtual time.

harness = Px4Harness("copter")
harness.command(CMD.NAV_TAKEOFF, nan, ...)
harness.run_until(lambda: harness.height > 9)
"""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.modes.names import px4_modes_of
from tests.sim.harness import CMD, GROUND, RESULT, SimulationHarness, VehicleHarness
from tests.sim.running import reduce_telemetry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.dialects import Message
    from mavstack.services import Address
    from mavstack.services.mission import MissionItem

#: Altitude of the default home above mean sea level, in metres.
FIELD_ALTITUDE = 488.0


class Px4Harness(VehicleHarness):
    """One vehicle and a ground station, which keeps all messages in `received`."""

    answer_time = 0.0

    def __init__(self, vehicle_type: str = "copter", *, seed: int = 1, ready: bool = True) -> None:
        harness = SimulationHarness(seed=seed)
        super().__init__(harness, harness.simulation.add(vehicle_type, "px4"))
        harness.attach(self)
        reduce_telemetry(self.vehicle)
        self.receiving = True
        assert self.port  # opened now, not with the first message
        if ready:
            self.send_heartbeat()
            self.run(4.0)

    def set_mode(self, main: int, sub: int = 0, *, source: Address = GROUND) -> common.MavResult | None:
        """Set a mode by DO_SET_MODE; return the answer."""
        return self.command(CMD.DO_SET_MODE, 1, main, sub, source=source)

    def arm(self) -> None:
        assert self.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.ACCEPTED, self.texts

    def request(self, message_type: type[Message], *params: float) -> list[Any]:
        """Request a message once; return the messages received."""
        before = len(self.received)
        self.command(CMD.REQUEST_MESSAGE, message_type.__mavlink_row__[0], *params)
        self.run(0.5)
        return [message for message in self.received[before:] if isinstance(message, message_type)]

    def upload(self, items: Sequence[MissionItem]) -> int:
        """Upload a mission as a client does; return the MAV_MISSION_RESULT."""
        target = self.vehicle.address
        before = len(self.received)
        self.send(
            common.MissionCount(
                target_system=target.system, target_component=target.component, count=len(items)
            )
        )
        for _ in range(200):
            new, before = self.received[before:], len(self.received)
            for message in new:
                if isinstance(message, common.MissionAck):
                    return int(message.type)
                if isinstance(message, common.MissionRequestInt | common.MissionRequest):
                    self.send(items[message.seq].to_int(target, message.seq, 0))
            self.run(0.1)
        raise AssertionError("the upload did not end")

    @property
    def heartbeat(self) -> tuple[int, tuple[int, int], int]:
        """Flags without the armed bit, main and sub mode, and state of the latest HEARTBEAT."""
        latest = self.received_of(common.Heartbeat)[-1]
        return int(latest.base_mode) & ~128, px4_modes_of(latest.custom_mode), int(latest.system_status)

    def take_off(self, height: float = 15.0) -> Px4Harness:
        """Take off to a height in metres, and hold."""
        altitude = FIELD_ALTITUDE + height
        assert self.command(CMD.NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, altitude) == RESULT.ACCEPTED
        self.arm()
        self.run_until(lambda: self.mode == "Hold", timeout=90.0)
        return self
