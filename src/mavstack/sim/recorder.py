"""The flight recorder of a simulated vehicle: the content of its log, and when a log begins and ends.

A log begins at arming and ends shortly after disarming, so that it has the last status texts. Parameters
(LOG_DISARMED, SDLOG_MODE) can make it begin at boot, or continue until the next one. The vehicle is sampled
ten times a second; events are written as they happen.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.storage import FlightSample
from mavstack.sim.storage.dataflash import EVENT_LANDED, EVENT_NOT_LANDED
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from mavstack.services.parameters import Value
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.sim.vehicle_types import Home

#: Seconds from disarming until the log ends.
LOG_TAIL = 1.0

#: Values of SDLOG_MODE: logs begin at boot, and logs continue after disarming.
_FROM_BOOT, _AFTER_DISARMING = (1, 2), (2, 4)
#: ArduPilot's ModeReason by a word of the reason's text, and LogErrorSubsystem by a word of the failsafe's
#: name.
_REASONS = {
    "command": 2,
    "radio": 3,
    "battery": 4,
    "ground": 5,
    "gcs": 5,
    "position": 6,
    "end": 8,
    "fence": 10,
    "initialised": 26,
}
_SUBSYSTEMS = {"radio": 5, "battery": 6, "ground": 8, "gcs": 8, "fence": 9, "position": 17}
_WITH_AIRSPEED = (VehicleType.PLANE, VehicleType.VTOL)


class Recorder:
    """Writes the log of one vehicle."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._logs = vehicle.storage.logs
        self._boots = 0
        self._ends_at: float | None = None
        self._landed = True
        self._sequence = 0
        self._reached = -1
        self._failsafes: frozenset[str] = frozenset()

    # Events

    def tick(self, now: float) -> None:
        """Sample the vehicle."""
        if self._boots != self._vehicle.boots:
            self._booted()
        if self._ends_at is not None and now >= self._ends_at:
            self._ends_at = None
            self._logs.end()
        if self._logs.recording:
            self._notice()
            self._logs.write(self._sample())

    def text(self, text: str, severity: int) -> None:
        """Write a status text."""
        self._logs.text(self._time_us, severity, text)

    def mode(self, number: int, reason: str) -> None:
        """Write a mode change."""
        self._logs.mode(self._time_us, number, _number_of(reason, _REASONS))

    def armed(self, armed: bool) -> None:
        """Write arming or disarming."""
        if armed:
            self._ends_at = None
            if not self._logs.writing and self._wanted:
                self._begin()
        self._logs.armed(self._time_us, armed)
        if not armed and not self._continues_after_disarming:
            self._ends_at = self._vehicle.now + LOG_TAIL

    def home(self, home: Home | None) -> None:
        """Write a new home."""
        if home is not None:
            self._logs.home(self._time_us, home.latitude, home.longitude, home.altitude)

    # Begin and end of a log

    @property
    def _time_us(self) -> int:
        return round(self._vehicle.uptime * 1e6)

    @property
    def _mode(self) -> int:
        """PX4's SDLOG_MODE, or the closest value for ArduPilot's parameters."""
        parameters = self._vehicle.parameters
        if self._vehicle.firmware is Firmware.PX4:
            return int(parameters.get("SDLOG_MODE", 0))
        if not int(parameters.get("LOG_BACKEND_TYPE", 1)) & 1:
            return -1
        return 2 if parameters.get("LOG_DISARMED", 0) == 1 else 0

    @property
    def _wanted(self) -> bool:
        return self._mode >= 0

    @property
    def _continues_after_disarming(self) -> bool:
        return self._mode in _AFTER_DISARMING

    def _booted(self) -> None:
        self._boots = self._vehicle.boots
        self._ends_at = None
        self._logs.end()
        self._vehicle.parameters.on_any_change(self._parameter_changed)
        if self._mode in _FROM_BOOT:
            self._begin()

    def _begin(self) -> None:
        self._logs.begin(self._time_us)
        self._landed = self._vehicle.autopilot.landed
        self._sequence, self._reached = self._vehicle.mission.current, -1
        self._failsafes = frozenset()

    # Content of a log

    def _parameter_changed(self, name: str, value: Value) -> None:
        self._logs.parameter(self._time_us, name, value, self._vehicle.parameters.table[name].default)

    def _notice(self) -> None:
        """Write the changes since the last sample."""
        vehicle, time_us = self._vehicle, self._time_us
        sequence, landed = vehicle.mission.current, vehicle.autopilot.landed
        if sequence != self._sequence:
            self._begin_item(sequence, time_us)
        if vehicle.firmware is Firmware.ARDUPILOT:
            if landed != self._landed:
                self._logs.event(time_us, EVENT_LANDED if landed else EVENT_NOT_LANDED)
            self._notice_failsafes(time_us)
        self._landed = landed

    def _begin_item(self, sequence: int, time_us: int) -> None:
        items = self._vehicle.mission.plan(common.MavMissionType.MISSION).items
        self._reached = sequence - 1 if sequence > self._sequence else -1
        self._sequence = sequence
        if (
            sequence < len(items) and self._vehicle.autopilot.armed
        ):  # a disarmed vehicle does not fly the item
            self._logs.command(time_us, items[sequence], sequence, len(items))

    def _notice_failsafes(self, time_us: int) -> None:
        now = frozenset(self._vehicle.autopilot.failsafes)
        for name in sorted(now ^ self._failsafes):
            self._logs.error(time_us, _number_of(name, _SUBSYSTEMS), int(name in now))
        self._failsafes = now

    def _sample(self) -> FlightSample:
        vehicle, body, autopilot = self._vehicle, self._vehicle.body, self._vehicle.autopilot
        motion, home = body.estimate, autopilot.home
        latitude, longitude, altitude = body.frame.to_global(motion.north, motion.east, motion.down)
        return FlightSample(
            self._time_us,
            motion,
            body.sensors,
            body.battery,
            latitude,
            longitude,
            altitude,
            mode=autopilot.mode.number,
            armed=autopilot.armed,
            landed=autopilot.landed,
            failsafe=bool(autopilot.failsafes),
            rc=autopilot.radio.channels if autopilot.radio.present else (),
            servos=body.servos,
            mission_sequence=self._sequence,
            mission_total=len(vehicle.plans.get(common.MavMissionType.MISSION)),
            mission_reached=self._reached,
            airspeed=body.airspeed if vehicle.vehicle_type in _WITH_AIRSPEED else 0.0,
            home_altitude=body.frame.altitude if home is None else home.altitude,
            health=body.health,
        )


def _number_of(text: str, numbers: dict[str, int]) -> int:
    """Return the number of the first word that is in a text; 0 if there is none."""
    text = text.lower()
    return next((number for word, number in numbers.items() if word in text), 0)
