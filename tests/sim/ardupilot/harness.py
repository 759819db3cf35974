"""A simulated ArduPilot and a ground station, in virtual time."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.services.mission import MissionItem
from tests.sim.harness import RESULT, SimulationHarness, VehicleHarness

if TYPE_CHECKING:
    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.vehicle_types import VehicleType

CMD = ardupilotmega.MavCmd
RELATIVE = common.MavFrame.GLOBAL_RELATIVE_ALT


class ArdupilotHarness(VehicleHarness):
    """One vehicle with a silent ground station, which keeps all messages in `received`."""

    answer_time = 0.3
    default_timeout = 120.0

    def __init__(
        self,
        vehicle_type: VehicleType | str = "copter",
        *,
        settle: float = 2.3,
        version: FirmwareVersion | None = None,
    ) -> None:
        harness = SimulationHarness()
        super().__init__(harness, harness.simulation.add(vehicle_type, "ardupilot", version=version))
        harness.attach(self)
        self.sends_heartbeats, self.receiving = False, True
        assert self.port
        self.run(settle)

    @property
    def received_texts(self) -> list[str]:
        """Status texts received so far, including those sent to this ground station only."""
        return [message.text for message in self.received_of(common.Statustext)]

    def accepted(
        self, command: int, *params: float, frame: int | None = None, wait: float | None = None
    ) -> None:
        """Send a command that must be accepted."""
        assert self.command(command, *params, frame=frame, wait=wait) == RESULT.ACCEPTED, self.texts[-3:]

    def set_mode(self, name: str) -> int:
        """Set a mode by DO_SET_MODE; return the answer."""
        return self.command(CMD.DO_SET_MODE, 1, self.mode_number(name))

    def at(self, north: float, east: float) -> tuple[float, float]:
        """Return latitude and longitude of a point in local metres."""
        return self.vehicle.body.frame.to_global(north, east, 0.0)[:2]

    def reposition(self, north: float, east: float, altitude: float, *, frame: int = RELATIVE) -> int:
        """Send DO_REPOSITION; return the answer."""
        return self.command(CMD.DO_REPOSITION, -1, 1, 0, nan, *self.at(north, east), altitude, frame=frame)

    def take_off(self, height: float = 10.0) -> None:
        """Bring the vehicle into the air in GUIDED; a vehicle that cannot fly is armed in it."""
        if self.vehicle.vehicle_type in ("copter", "vtol"):
            self.autopilot.enter(self.autopilot.profile.guided, "test")
            self.autopilot.arm(force=True)
            self.vehicle.body.place(0.0, 0.0, -height, 0.0)
            self.autopilot.guided.go_to((0.0, 0.0, -height))
        else:
            self.vehicle.profile.take_off(self.autopilot, height)
        if self.vehicle.vehicle_type.flies:
            self.run_until(lambda: self.autopilot.altitude > 0.9 * height and not self.autopilot.landed)
        self.run(0.5)
        assert self.set_mode("GUIDED") == RESULT.ACCEPTED

    def waypoint(self, north: float, east: float, altitude: float) -> MissionItem:
        """Return a waypoint from local metres."""
        latitude, longitude = self.at(north, east)
        return MissionItem(
            common.MavCmd.NAV_WAYPOINT, param5=latitude, param6=longitude, param7=altitude, frame=RELATIVE
        )
