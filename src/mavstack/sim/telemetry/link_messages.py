"""PX4's messages about links and for the public: PING, TIMESYNC, remote id, traffic."""

from __future__ import annotations

from math import atan2, degrees, hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.telemetry.scaling import degrees_e7, int16, int32, uint16

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.telemetry.view import VehicleView

_STATUS = common.MavOdidStatus
_UNKNOWN_HEIGHT = -1000.0
_UNKNOWN_TIME = 65_535.0
_SECONDS_AN_HOUR = 3600.0
_FLIGHT = common.UtmFlightState
_ALL_VALID = 0x7F
_NO_ID = bytes(20)
#: The value for an unknown time of arrival.
_NEVER = -1


class LinkMessages:
    """Producers of messages about links, remote identification and traffic."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._body = view.body
        self._pings = 0

    def ping(self, now: float) -> Message:
        """Return PING to all systems."""
        self._pings += 1
        return common.Ping(self._view.microseconds(now), self._pings - 1)

    def timesync(self, now: float) -> Message:
        """Return TIMESYNC: a request to all systems."""
        return common.Timesync(0, self._view.microseconds(now) * 1000)

    def node_status(self, now: float) -> Message:
        """Return LINK_NODE_STATUS with the packets received on all ports."""
        states = [port.state for port in self._view.vehicle.ports if port.state is not None]
        received = sum(state.parser.statistics.packets for state in states)
        return common.LinkNodeStatus(timestamp=self._view.microseconds(now), messages_received=received)

    def time_estimate(self, now: float) -> Message:
        """Return TIME_ESTIMATE_TO_TARGET: only the time to home, as PX4 does."""
        estimate, home = self._body.estimate, self._view.home
        flying = self._view.autopilot.armed and not self._view.autopilot.landed
        distance = hypot(estimate.north - home[0], estimate.east - home[1])
        speed = max(self._view.autopilot.flight_parameters.cruise_speed, 0.1)
        seconds = int32(distance / speed) if flying else 0
        return common.TimeEstimateToTarget(seconds, _NEVER, _NEVER, _NEVER, _NEVER)

    def drone_id_location(self, now: float) -> Message:
        """Return OPEN_DRONE_ID_LOCATION."""
        estimate, position = self._body.estimate, self._view.position
        readings = self._view.sensors
        speed = hypot(estimate.velocity_north, estimate.velocity_east)
        course = degrees(atan2(estimate.velocity_east, estimate.velocity_north)) % 360.0
        return common.OpenDroneIdLocation(
            id_or_mac=_NO_ID,
            status=_STATUS.GROUND if self._view.autopilot.landed else _STATUS.AIRBORNE,
            direction=uint16(course) * 100,
            speed_horizontal=min(uint16(speed * 100.0), 25_425),
            speed_vertical=min(max(int16(-estimate.velocity_down * 100.0), -6200), 6200),
            latitude=degrees_e7(position.latitude),
            longitude=degrees_e7(position.longitude),
            altitude_barometric=position.altitude,
            altitude_geodetic=position.altitude,
            height=self._view.altitude,
            horizontal_accuracy=12 if readings.gps_eph < 1.0 else 11 if readings.gps_eph < 3.0 else 10,
            vertical_accuracy=5 if readings.gps_epv < 3.0 else 4,
            speed_accuracy=3,
            timestamp=now % _SECONDS_AN_HOUR if now > 0 else _UNKNOWN_TIME,
        )

    def drone_id_system(self, now: float) -> Message | None:
        """Return OPEN_DRONE_ID_SYSTEM once home is set; the operator's position is home."""
        home = self._view.autopilot.home
        if home is None:
            return None
        return common.OpenDroneIdSystem(
            id_or_mac=_NO_ID,
            operator_latitude=degrees_e7(home.latitude),
            operator_longitude=degrees_e7(home.longitude),
            area_count=1,
            area_ceiling=_UNKNOWN_HEIGHT,
            area_floor=_UNKNOWN_HEIGHT,
            operator_altitude_geo=home.altitude,
        )

    def traffic(self, now: float) -> Message:
        """Return UTM_GLOBAL_POSITION."""
        view, estimate, position = self._view, self._body.estimate, self._view.position
        readings = self._view.sensors
        return common.UtmGlobalPosition(
            time=round(now * 1e6),
            lat=degrees_e7(position.latitude),
            lon=degrees_e7(position.longitude),
            alt=int32(position.altitude * 1e3),
            relative_alt=int32(view.altitude * 1e3),
            vx=int16(estimate.velocity_north * 100.0),
            vy=int16(estimate.velocity_east * 100.0),
            vz=int16(estimate.velocity_down * 100.0),
            h_acc=uint16(readings.gps_eph * 1e3),
            v_acc=uint16(readings.gps_epv * 1e3),
            flight_state=_FLIGHT.GROUND if view.autopilot.landed else _FLIGHT.AIRBORNE,
            flags=_ALL_VALID,
        )
