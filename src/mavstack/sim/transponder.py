"""A uAvionix transponder beside a simulated vehicle, which speaks MAVLink (component ADSB).

The autopilot sends it its configuration (UAVIONIX_ADSB_OUT_CFG) and its position (UAVIONIX_ADSB_OUT_DYNAMIC)
on a separate link, so that ground stations do not see these messages. Ground stations reach the transponder
through the autopilot: it reports its health each second, takes UAVIONIX_ADSB_OUT_CFG_REGISTRATION and
UAVIONIX_ADSB_OUT_CFG_FLIGHTID, and answers UAVIONIX_ADSB_GET by the requested message. The flight id is the
callsign until one is set. Sources: MAVLink, uAvionix.xml; Mission Planner, ConfigADSB.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common, uavionix
from mavstack.services.addressing import Address, message_ids
from mavstack.services.heartbeat import HeartbeatSender
from mavstack.services.message_request.interval import message_id_of
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

#: Seconds between two reports of its health.
INTERVAL: Final = 1.0

FromAutopilot: TypeAlias = "uavionix.UavionixAdsbOutCfg | uavionix.UavionixAdsbOutDynamic"


class SimulatedTransponder(Service):
    """The transponder of one vehicle."""

    handles = message_ids(
        uavionix.UavionixAdsbGet,
        uavionix.UavionixAdsbOutCfg,
        uavionix.UavionixAdsbOutCfgRegistration,
        uavionix.UavionixAdsbOutCfgFlightid,
    )

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(Address(vehicle.address.system, common.MavComponent.ADSB))
        #: The configuration and the position that it knows; None until the autopilot sent it.
        self.configuration: uavionix.UavionixAdsbOutCfg | None = None
        self.dynamic: uavionix.UavionixAdsbOutDynamic | None = None
        self._registration = uavionix.UavionixAdsbOutCfgRegistration()
        self._flight: uavionix.UavionixAdsbOutCfgFlightid | None = None
        self._due = vehicle.now
        vehicle.engine.add(HeartbeatSender(self.local, common.MavType.ADSB, common.MavAutopilot.INVALID))
        vehicle.engine.add(self)

    def take(self, message: FromAutopilot) -> None:
        """Take a message of the autopilot."""
        match message:
            case uavionix.UavionixAdsbOutCfg():
                self.configuration = message
            case uavionix.UavionixAdsbOutDynamic():
                self.dynamic = message

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case uavionix.UavionixAdsbOutCfg() as configuration:
                self.configuration = configuration
            case uavionix.UavionixAdsbOutCfgRegistration() as registration:
                self._registration = registration
            case uavionix.UavionixAdsbOutCfgFlightid() as flight:
                self._flight = flight
            case uavionix.UavionixAdsbGet(ReqMessageId=number):
                if (answer := self._answer(number)) is not None:
                    self.send(answer, Address(packet.system, packet.component))

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        self._due = now + INTERVAL
        self.send(uavionix.UavionixAdsbTransceiverHealthReport(rfHealth=uavionix.UavionixAdsbRfHealth.OK))

    def _answer(self, number: int) -> Message | None:
        """Return the message with an id; None if it is not one that the transponder has."""
        flight = self._flight
        if flight is None and self.configuration is not None:
            flight = uavionix.UavionixAdsbOutCfgFlightid(flight_id=self.configuration.callsign)
        for known in (self.configuration, self.dynamic, self._registration, flight):
            if known is not None and message_id_of(type(known)) == number:
                return known
        return None
