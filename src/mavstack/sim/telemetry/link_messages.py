"""What a PX4 says for others than its ground station: to the far end of the link, and to the public."""

from __future__ import annotations

from math import atan2, degrees, hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.telemetry.scaling import degrees_e7, int16, int32, uint16

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.telemetry.view import View

_STATUS = common.MavOdidStatus
_UNKNOWN_HEIGHT = -1000.0
_UNKNOWN_TIME = 65_535.0
_SECONDS_AN_HOUR = 3600.0
_FLIGHT = common.UtmFlightState
_EVERYTHING_VALID = 0x7F
_NO_ID = bytes(20)
#: Nobody knows when it will be there.
_NEVER = -1


class LinkMessages:
    """Producers of messages that have little to do with flying."""

    def __init__(self, view: View) -> None:
        self._view = view
        self._body = view.body
        self._pings = 0

    def ping(self, now: float) -> Message:
        """PING to everybody."""
        self._pings += 1
        return common.Ping(self._view.microseconds(now), self._pings - 1)

    def timesync(self, now: float) -> Message:
        """TIMESYNC: a question to everybody."""
        return common.Timesync(0, self._view.microseconds(now) * 1000)

    def node_status(self, now: float) -> Message:
        """LINK_NODE_STATUS, with what was heard on all ports."""
        states = [port.state for port in self._view.vehicle.ports if port.state is not None]
        heard = sum(state.parser.statistics.packets for state in states)
        return common.LinkNodeStatus(timestamp=self._view.microseconds(now), messages_received=heard)

    def time_estimate(self, now: float) -> Message:
        """TIME_ESTIMATE_TO_TARGET: how long the way home takes, and nothing else, as PX4 does."""
        own, home = self._body.estimate, self._view.home
        flying = self._view.autopilot.armed and not self._view.autopilot.landed
        distance = hypot(own.north - home[0], own.east - home[1])
        speed = max(self._view.autopilot.flight_parameters.cruise_speed, 0.1)
        seconds = int32(distance / speed) if flying else 0
        return common.TimeEstimateToTarget(seconds, _NEVER, _NEVER, _NEVER, _NEVER)

    def drone_id_location(self, now: float) -> Message:
        """OPEN_DRONE_ID_LOCATION."""
        own, place = self._body.estimate, self._view.place
        felt = self._view.sensors
        speed = hypot(own.velocity_north, own.velocity_east)
        course = degrees(atan2(own.velocity_east, own.velocity_north)) % 360.0
        return common.OpenDroneIdLocation(
            id_or_mac=_NO_ID,
            status=_STATUS.GROUND if self._view.autopilot.landed else _STATUS.AIRBORNE,
            direction=uint16(course) * 100,
            speed_horizontal=min(uint16(speed * 100.0), 25_425),
            speed_vertical=min(max(int16(-own.velocity_down * 100.0), -6200), 6200),
            latitude=degrees_e7(place.latitude),
            longitude=degrees_e7(place.longitude),
            altitude_barometric=place.altitude,
            altitude_geodetic=place.altitude,
            height=self._view.altitude,
            horizontal_accuracy=12 if felt.gps_eph < 1.0 else 11 if felt.gps_eph < 3.0 else 10,
            vertical_accuracy=5 if felt.gps_epv < 3.0 else 4,
            speed_accuracy=3,
            timestamp=now % _SECONDS_AN_HOUR if now > 0 else _UNKNOWN_TIME,
        )

    def drone_id_system(self, now: float) -> Message | None:
        """OPEN_DRONE_ID_SYSTEM, once there is a home: the pilot is taken to stand there."""
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
        """UTM_GLOBAL_POSITION."""
        view, own, place = self._view, self._body.estimate, self._view.place
        felt = self._view.sensors
        return common.UtmGlobalPosition(
            time=round(now * 1e6),
            lat=degrees_e7(place.latitude),
            lon=degrees_e7(place.longitude),
            alt=int32(place.altitude * 1e3),
            relative_alt=int32(view.altitude * 1e3),
            vx=int16(own.velocity_north * 100.0),
            vy=int16(own.velocity_east * 100.0),
            vz=int16(own.velocity_down * 100.0),
            h_acc=uint16(felt.gps_eph * 1e3),
            v_acc=uint16(felt.gps_epv * 1e3),
            flight_state=_FLIGHT.GROUND if view.autopilot.landed else _FLIGHT.AIRBORNE,
            flags=_EVERYTHING_VALID,
        )
