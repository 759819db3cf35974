"""A Remote ID module beside a simulated vehicle, and the vehicle's refusal to arm without it.

The module is the component ODID_TXRX_1. The vehicle may arm once the module knows who the vehicle is
(OPEN_DRONE_ID_BASIC_ID) and where the operator is (OPEN_DRONE_ID_SYSTEM or its update, not older than 5 s).
Ground stations send these messages to the module or, as MAVProxy does, to the autopilot, which passes them
on: ArduPilot all of them, PX4 OPEN_DRONE_ID_SYSTEM alone.
The autopilot sends OPEN_DRONE_ID_LOCATION each second. ArduPilot, with bit 0 of DID_OPTIONS, checks the
messages of the operator itself, in this order and with these words. Source: ArduPilot, AP_OpenDroneID;
PX4, MavlinkReceiver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.heartbeat import HeartbeatSender
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

INTERVAL: Final = 1.0
OPERATOR_TIMEOUT: Final = 5.0
#: Seconds without messages of the operator or the module after which ArduPilot reports a pre-arm problem.
ARDUPILOT_TIMEOUT: Final = 3.0
_UNKNOWN_DIRECTION, _UNKNOWN_ALTITUDE = 36_100, -1000.0


class RemoteIdModule(Service):
    """The module of one vehicle; it also sends the location, as the autopilot does."""

    handles = message_ids(common.OpenDroneIdBasicId, common.OpenDroneIdSystem, common.OpenDroneIdSystemUpdate)

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        system = vehicle.address.system
        super().__init__(Address(system, common.MavComponent.ODID_TXRX_1))
        self._vehicle = vehicle
        self._due = vehicle.now
        self._is_known = self._has_type = False
        self._operator_at: float | None = None
        vehicle.engine.add(HeartbeatSender(self.local, common.MavType.ODID, common.MavAutopilot.INVALID))
        vehicle.engine.add(self)
        vehicle.engine.add(_Relay(self, vehicle))

    @property
    def problem(self) -> str:
        """Why the vehicle may not arm; empty if it may."""
        if not self._is_known:
            return "missing BasicID"
        if self._operator_at is None:
            return "missing operator location"
        if self._vehicle.now - self._operator_at > OPERATOR_TIMEOUT:
            return "operator location is too old"
        return ""

    @property
    def ardupilot_problem(self) -> str:
        """Why ArduPilot does not arm; empty if it does."""
        if not self._has_type:
            return "UA_TYPE required in BasicID"
        if self._operator_at is None:
            return "operator location must be set"
        if self._vehicle.now - self._operator_at > ARDUPILOT_TIMEOUT:
            return "SYSTEM not available"
        return self.problem

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.OpenDroneIdBasicId() as basic:
                self._is_known = bool(bytes(basic.uas_id).strip(b"\0"))
                self._has_type = basic.id_type != common.MavOdidIdType.NONE
            case common.OpenDroneIdSystem() | common.OpenDroneIdSystemUpdate() as place:
                if place.operator_latitude or place.operator_longitude:
                    self._operator_at = now

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        self._due = now + INTERVAL
        states = common.MavOdidArmStatus
        status = states.PRE_ARM_FAIL_GENERIC if self.problem else states.GOOD_TO_ARM
        self.send(common.OpenDroneIdArmStatus(status=status, error=self.problem))
        self._vehicle.services.send(self._location())

    def _location(self) -> common.OpenDroneIdLocation:
        body, states = self._vehicle.body, common.MavOdidStatus
        readings = body.sensors
        is_armed = self._vehicle.autopilot.armed
        return common.OpenDroneIdLocation(
            status=states.AIRBORNE if is_armed and not body.on_ground else states.GROUND,
            direction=_UNKNOWN_DIRECTION,
            latitude=round(readings.gps_latitude * 1e7),
            longitude=round(readings.gps_longitude * 1e7),
            altitude_barometric=_UNKNOWN_ALTITUDE,
            altitude_geodetic=readings.gps_altitude,
            height=_UNKNOWN_ALTITUDE,
            timestamp=self._vehicle.now % 3600,
        )


class _Relay(Service):
    """The autopilot's side: messages that are addressed to it reach the module."""

    def __init__(self, module: RemoteIdModule, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._module = module
        self.handles = message_ids(common.OpenDroneIdSystem) if vehicle.firmware == "px4" else module.handles

    def receive(self, packet: Packet, now: float) -> None:
        self._module.receive(packet, now)
