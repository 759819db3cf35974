"""ArduPilot and a uAvionix transponder: one at a serial port (ADSB_TYPE 3), or one that speaks MAVLink (1).

With 3 the autopilot passes UAVIONIX_ADSB_OUT_CONTROL on, and gives UAVIONIX_ADSB_OUT_STATUS to those who
request it. With 1 it sends UAVIONIX_ADSB_OUT_CFG each 5 s and UAVIONIX_ADSB_OUT_DYNAMIC each 0.2 s to the
component whose UAVIONIX_ADSB_TRANSCEIVER_HEALTH_REPORT it heard within 10 s, once it knows its position; then
UAVIONIX_ADSB_OUT_CFG of a ground station sets what it sends. The other parameters ADSB_… keep their defaults
and are not shown. Source: ArduPilot 4.6, libraries/AP_ADSB.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common, uavionix
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.sim.transponder import FromAutopilot
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

CONFIGURATION_INTERVAL: Final = 5.0
DYNAMIC_INTERVAL: Final = 0.2
HEALTH_TIMEOUT: Final = 10.0
#: Values of ADSB_TYPE.
_MAVLINK, _SERIAL = 1, 3
_STATE = uavionix.UavionixAdsbOutStatusState
_CONTROL = uavionix.UavionixAdsbOutControlState
_DYNAMIC = uavionix.UavionixAdsbOutDynamicState
#: UAVIONIX_ADSB_OUT_…_STATE_1090ES_TX_ENABLED, whose name is not one of Python.
_POSITION_REPORTS: Final = 128
#: Bits that both messages have at the same places.
_SHARED: Final = (
    _CONTROL.IDENT_BUTTON_ACTIVE | _CONTROL.MODE_A_ENABLED | _CONTROL.MODE_C_ENABLED | _CONTROL.MODE_S_ENABLED
    | _POSITION_REPORTS
)  # fmt: skip
_BOARD_TEMPERATURE: Final = 35
#: UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_3D.
_FIX_3D: Final = 3
#: Seconds between the beginnings of Unix time and of GPS time.
_GPS_EPOCH: Final = 315_964_800


class TransponderPort(Service):
    """The autopilot's side."""

    handles = message_ids(
        uavionix.UavionixAdsbOutControl,
        uavionix.UavionixAdsbOutCfg,
        uavionix.UavionixAdsbTransceiverHealthReport,
    )

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._vehicle = vehicle
        self._control = uavionix.UavionixAdsbOutControl(squawk=1200)
        self._configuration = uavionix.UavionixAdsbOutCfg(
            ICAO=0xAD0000 | vehicle.address.system,
            callsign=f"ARDU{vehicle.address.system:04X}",
            emitterType=common.AdsbEmitterType.UAV,
            aircraftSize=1,
            gpsOffsetLat=4,
            gpsOffsetLon=1,
            rfSelect=uavionix.UavionixAdsbOutRfSelect.RX_ENABLED,
        )
        self._transceiver: Address | None = None
        self._heard = self._due = self._configured = float("-inf")
        vehicle.messages.provide(uavionix.UavionixAdsbOutStatus, self._status)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case uavionix.UavionixAdsbOutControl() as control:
                self._control = control
            case uavionix.UavionixAdsbOutCfg() as configuration if packet.system != self.local.system:
                self._configuration, self._configured = configuration, float("-inf")
                text = f"ADSB: Using ICAO_id {configuration.ICAO} and Callsign {configuration.callsign}"
                self._vehicle.send_statustext(text, common.MavSeverity.INFO)
            case uavionix.UavionixAdsbTransceiverHealthReport() if self._type == _MAVLINK:
                self._hear(Address(packet.system, packet.component), now)

    def next_timeout(self) -> float | None:
        is_needed = self._transceiver is not None or self._vehicle.transponder is not None
        return self._due if is_needed else None

    def handle_timeout(self, now: float) -> None:
        if self._vehicle.transponder is not None and self._type == _MAVLINK:
            self._hear(self._vehicle.transponder.local, now)
        if now < self._due:
            return
        if self._transceiver is None:
            self._due = now + DYNAMIC_INTERVAL  # until ADSB_TYPE is 1
            return
        if now - self._heard > HEALTH_TIMEOUT or self._type != _MAVLINK:
            self._transceiver = None
            self._vehicle.send_statustext("ADSB: Transceiver heartbeat timed out", common.MavSeverity.ERROR)
            return
        self._due = now + DYNAMIC_INTERVAL
        if not self._vehicle.autopilot.has_position:
            return
        if now - self._configured >= CONFIGURATION_INTERVAL:
            self._configured = now
            self._deliver(self._configuration, self._transceiver)
        self._deliver(self._dynamic(now), self._transceiver)

    def _hear(self, transceiver: Address, now: float) -> None:
        if self._transceiver is None:
            self._due = now
        self._transceiver, self._heard = transceiver, now

    def _deliver(self, message: FromAutopilot, transceiver: Address) -> None:
        """Give a message to the transponder of the vehicle, or send it to another transceiver."""
        fitted = self._vehicle.transponder
        if fitted is not None and fitted.local == transceiver:
            fitted.take(message)
        else:
            self.send(message, transceiver)

    @property
    def _type(self) -> int:
        return int(self._vehicle.parameters.get("ADSB_TYPE", 0))

    @property
    def _on_ground(self) -> bool:
        return self._vehicle.body.on_ground

    def _status(self, _: float) -> list[uavionix.UavionixAdsbOutStatus]:
        if self._type != _SERIAL:
            return []
        state = int(self._control.state) & _SHARED | (_STATE.ON_GROUND if self._on_ground else 0)
        return [
            uavionix.UavionixAdsbOutStatus(
                state=state,
                squawk=self._control.squawk,
                flight_id=self._control.flight_id,
                boardTemp=_BOARD_TEMPERATURE,
            )
        ]

    def _dynamic(self, now: float) -> uavionix.UavionixAdsbOutDynamic:
        readings = self._vehicle.body.sensors
        return uavionix.UavionixAdsbOutDynamic(
            utcTime=max(round(now) - _GPS_EPOCH, 0),
            gpsLat=round(readings.gps_latitude * 1e7),
            gpsLon=round(readings.gps_longitude * 1e7),
            gpsAlt=round(readings.gps_altitude * 1e3),
            gpsFix=_FIX_3D,
            state=_DYNAMIC.ON_GROUND if self._on_ground else 0,
            squawk=self._control.squawk,
        )
