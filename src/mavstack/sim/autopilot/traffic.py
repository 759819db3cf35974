"""The aircraft that a simulated vehicle hears of (ADSB_VEHICLE, UTM_GLOBAL_POSITION), in its local frame."""

from __future__ import annotations

from math import cos, hypot, radians, sin
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

#: Maximum number of aircraft in the table, and seconds after which an aircraft is discarded.
MAX_AIRCRAFT: Final = 25
MAX_AGE: Final = 60.0
#: In seconds: the interval of an aircraft's reports to ground stations, and the age after which it is not
#: reported.
REPORT_INTERVAL: Final = 1.0
MAX_REPORT_AGE: Final = 10.0
_FLAGS = common.AdsbFlags


class Contact(NamedTuple):
    """An aircraft: metres from the frame's origin, m/s, and the time of its report."""

    address: int
    north: float
    east: float
    down: float
    velocity_north: float
    velocity_east: float
    velocity_down: float
    at: float
    callsign: str = ""

    def moved(self, now: float) -> Contact:
        """Return the aircraft where it is now if it kept its velocity."""
        age = now - self.at
        return self._replace(
            north=self.north + self.velocity_north * age,
            east=self.east + self.velocity_east * age,
            down=self.down + self.velocity_down * age,
        )


class TrafficReceiver(Service):
    """Keeps the newest report of each aircraft."""

    handles = message_ids(common.AdsbVehicle, common.UtmGlobalPosition)

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._frame = vehicle.body.frame
        self._contacts: dict[int, Contact] = {}
        self._reports: dict[int, common.AdsbVehicle] = {}
        vehicle.messages.provide(common.AdsbVehicle, self.reports, interval=REPORT_INTERVAL, now=vehicle.now)

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.AdsbVehicle() as report:
                found = self._read_report(report, now)
                if found is not None:
                    self._reports[found.address] = report
            case common.UtmGlobalPosition() as position if packet.system != self.local.system:
                found = self._read_position(position, packet.system, now)
            case _:
                found = None
        if found is not None:
            self._contacts.pop(found.address, None)
            self._contacts[found.address] = found
            if len(self._contacts) > MAX_AIRCRAFT:
                del self._contacts[next(iter(self._contacts))]
        return False

    def reports(self, now: float) -> list[common.AdsbVehicle]:
        """Return the reports of the last seconds for ground stations, as both firmwares pass them on."""
        recent = {each.address for each in self.contacts(now) if now - each.at <= MAX_REPORT_AGE}
        self._reports = {address: report for address, report in self._reports.items() if address in recent}
        return list(self._reports.values())

    def contacts(self, now: float) -> list[Contact]:
        """Return the aircraft of the last minute."""
        return [each for each in self._contacts.values() if now - each.at <= MAX_AGE]

    def _read_report(self, report: common.AdsbVehicle, now: float) -> Contact | None:
        needed = _FLAGS.VALID_COORDS | _FLAGS.VALID_ALTITUDE
        if report.flags & needed != needed:
            return None
        place = self._frame.to_local(report.lat / 1e7, report.lon / 1e7, report.altitude / 1e3)
        speed = report.hor_velocity / 100 if report.flags & _FLAGS.VALID_VELOCITY else 0.0
        course = radians(report.heading / 100)
        climb = report.ver_velocity / 100 if report.flags & _FLAGS.VERTICAL_VELOCITY_VALID else 0.0
        velocity = speed * cos(course), speed * sin(course), -climb
        return Contact(report.ICAO_address, *place, *velocity, now - report.tslc, report.callsign)

    def _read_position(self, report: common.UtmGlobalPosition, system: int, now: float) -> Contact:
        place = self._frame.to_local(report.lat / 1e7, report.lon / 1e7, report.alt / 1e3)
        return Contact(system, *place, report.vx / 100, report.vy / 100, report.vz / 100, now)


def gap(contact: Contact, place: tuple[float, float, float]) -> float:
    """Return the metres over the ground between an aircraft and a place."""
    return hypot(contact.north - place[0], contact.east - place[1])
