"""The ADS-B transponder that an autopilot controls: `vehicle.transponder`.

    await vehicle.transponder.set(squawk="7000", flight_id="LX1", transmits=True, altitude=True)
    print(vehicle.transponder.status)

ArduPilot passes UAVIONIX_ADSB_OUT_CONTROL on to a transponder at a serial port (ADSB_TYPE 3, uAvionix UCP)
and reports its state by UAVIONIX_ADSB_OUT_STATUS. The message has no acknowledgement, so that report is the
answer. PX4 sends its own parameters to a transponder and takes no control from a ground station.

The registration and the flight id of a transponder that speaks MAVLink (ADSB_TYPE 1) are in the transponder
itself: UAVIONIX_ADSB_OUT_CFG_REGISTRATION and UAVIONIX_ADSB_OUT_CFG_FLIGHTID reach it through the autopilot,
which forwards messages without a target, and it answers UAVIONIX_ADSB_GET by the requested message.
"""

from __future__ import annotations

import asyncio
import re
from contextlib import suppress
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.dialects import common, uavionix
from mavstack.errors import CommandDenied, InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.services.message_request.interval import message_id_of, name_of
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.vehicle import Vehicle

_OPERATION: Final = "setting the transponder of"
_CONTROL = uavionix.UavionixAdsbOutControlState
_STATE = uavionix.UavionixAdsbOutStatusState
#: UAVIONIX_ADSB_OUT_…_STATE_1090ES_TX_ENABLED, whose name is not one of Python.
_POSITION_REPORTS: Final = 128
#: Hertz at which the state is requested, and seconds between two repetitions of the control message.
_RATE: Final = 1.0
_REPEAT: Final = 1.0
_POLL: Final = 0.1
#: Seconds to wait for a report by default.
DEFAULT_TIMEOUT: Final = 10.0
_UNKNOWN_ALTITUDE: Final = 2**31 - 1
_SQUAWK: Final = re.compile("[0-7]{4}")
_FLIGHT_ID: Final = re.compile("[A-Z0-9 ]{0,8}")
_REGISTRATION: Final = re.compile("[A-Z0-9]{0,8} *")
_PX4_SETTINGS: Final = "set ADSB_SQUAWK and ADSB_EMERGC instead, and restart it"
#: Why a vehicle refuses to report a transponder, by MAV_AUTOPILOT.
_NO_REPORT: Final[Mapping[int, str]] = MappingProxyType(
    {
        common.MavAutopilot.PX4: "PX4 does not report its transponder; read ADSB_SQUAWK and ADSB_CALLSIGN_1",
        common.MavAutopilot.ARDUPILOTMEGA: "ArduPilot reports a transponder with ADSB_TYPE 3 alone",
    }
)
#: The parts of a state that the control message sets.
_COMPARED: Final = _STATE.MODE_A_ENABLED | _STATE.MODE_C_ENABLED | _STATE.MODE_S_ENABLED | _POSITION_REPORTS


_Identity = TypeVar("_Identity", uavionix.UavionixAdsbOutCfgRegistration, uavionix.UavionixAdsbOutCfgFlightid)


@dataclass(frozen=True, slots=True)
class TransponderStatus:
    """The state of a transponder.

    Attributes:
        squawk: The Mode A code, four octal digits.
        flight_id: The flight identification; empty if none is set.
        transmits: True if it replies and sends its position.
        altitude: True if it reports its altitude too (Mode C).
        ident: True while it identifies itself to a controller.
        on_ground: True if it reports that the vehicle is on the ground.
        temperature: Of its board, in degrees Celsius.
        faults: The names of its faults, such as "GPS_NO_POS".
    """

    squawk: str
    flight_id: str
    transmits: bool
    altitude: bool
    ident: bool
    on_ground: bool
    temperature: int
    faults: tuple[str, ...] = ()


class Transponder(ReadOnly):
    """The ADS-B transponder of a vehicle; `vehicle.transponder`."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle

    @property
    def status(self) -> TransponderStatus | None:
        """The last reported state (UAVIONIX_ADSB_OUT_STATUS); None before the first report."""
        report = self._vehicle.telemetry.latest(uavionix.UavionixAdsbOutStatus)
        return None if report is None else _status_of(report)

    async def get(self, *, timeout: float | None = DEFAULT_TIMEOUT) -> TransponderStatus:
        """Request the state of the transponder (UAVIONIX_ADSB_OUT_STATUS).

        Args:
            timeout: Seconds to wait for the report; None: until retries are exhausted.

        Returns:
            The reported state.

        Raises:
            CommandDenied: The vehicle does not send the message, as PX4.
            MessageTimeout: No report came, as from a vehicle without a transponder.
        """
        component = self._vehicle.component
        try:
            report = await component.request_message(uavionix.UavionixAdsbOutStatus, timeout=timeout)
        except CommandDenied as error:
            raise self._explained(error) from None
        return _status_of(report)

    async def set(
        self,
        *,
        squawk: str = "1200",
        flight_id: str = "",
        transmits: bool = True,
        altitude: bool = True,
        ident: bool = False,
        emergency: int = 0,
        timeout: float | None = DEFAULT_TIMEOUT,
    ) -> TransponderStatus:
        """Set the transponder (UAVIONIX_ADSB_OUT_CONTROL), and wait until its report agrees.

        The message sets everything at the same time. Whether the vehicle is on the ground follows from the
        vehicle.

        Args:
            squawk: The Mode A code, four digits from 0 to 7.
            flight_id: The flight identification: at most 8 of A to Z, 0 to 9 and the space.
            transmits: Reply in Modes A and S and send the position (1090ES); False: standby.
            altitude: Report the altitude too (Mode C).
            ident: Identify the vehicle to a controller, for some seconds.
            emergency: The UAVIONIX_ADSB_EMERGENCY_STATUS.
            timeout: Seconds to wait for the report; None waits for ever.

        Returns:
            The reported state.

        Raises:
            InvalidArgumentError: A value is not possible; nothing was sent.
            ActionUnsupported: The vehicle takes the settings from its parameters (PX4); nothing was sent.
            ActionTimeout: No report agreed in time, as of a vehicle without a transponder.
        """
        _check(squawk, flight_id, emergency)
        if self._vehicle.autopilot == common.MavAutopilot.PX4:
            raise firmware_of(self._vehicle).unsupported("set its transponder by a message", _PX4_SETTINGS)
        control = uavionix.UavionixAdsbOutControl(
            state=self._state(transmits=transmits, altitude=altitude, ident=ident),
            squawk=int(squawk),
            flight_id=flight_id,
            emergencyStatus=emergency,
            baroAltMSL=_UNKNOWN_ALTITUDE,
        )
        async with deadline(timeout, _OPERATION, self._vehicle.address):
            await self._vehicle.telemetry.ensure(uavionix.UavionixAdsbOutStatus, _RATE)
            return await self._send_until_reported(control)

    async def get_flight_id(self, *, timeout: float | None = DEFAULT_TIMEOUT) -> str:
        """Request the flight id of a transponder that speaks MAVLink (UAVIONIX_ADSB_GET).

        Args:
            timeout: Seconds to wait for the answer; None waits for ever.

        Returns:
            The flight id; empty if none is set.

        Raises:
            ActionTimeout: No answer came, as from a vehicle without such a transponder.
        """
        answer = await self._get(uavionix.UavionixAdsbOutCfgFlightid, timeout)
        return _text(answer)

    async def set_flight_id(self, flight_id: str, *, timeout: float | None = DEFAULT_TIMEOUT) -> None:
        """Set the flight id of a transponder that speaks MAVLink (UAVIONIX_ADSB_OUT_CFG_FLIGHTID).

        Args:
            flight_id: At most 8 of A to Z, 0 to 9 and the space; empty: none.
            timeout: Seconds to wait until the transponder answers with it; None waits for ever.

        Raises:
            InvalidArgumentError: It is not possible; nothing was sent.
            ActionTimeout: The transponder did not answer with it.
        """
        if not _FLIGHT_ID.fullmatch(flight_id):
            raise InvalidArgumentError(_impossible_flight_id(flight_id))
        await self._set(uavionix.UavionixAdsbOutCfgFlightid(flight_id=flight_id), timeout)

    async def get_registration(self, *, timeout: float | None = DEFAULT_TIMEOUT) -> str:
        """Request the registration in a transponder that speaks MAVLink (UAVIONIX_ADSB_GET).

        Args:
            timeout: Seconds to wait for the answer; None waits for ever.

        Returns:
            The registration of the aircraft, such as "N8644B"; empty if none is set.

        Raises:
            ActionTimeout: No answer came, as from a vehicle without such a transponder.
        """
        answer = await self._get(uavionix.UavionixAdsbOutCfgRegistration, timeout)
        return _text(answer)

    async def set_registration(self, registration: str, *, timeout: float | None = DEFAULT_TIMEOUT) -> None:
        """Set the registration in a transponder (UAVIONIX_ADSB_OUT_CFG_REGISTRATION).

        Args:
            registration: Of the aircraft, at most 8 of A to Z and 0 to 9, such as "N8644B"; empty: none.
            timeout: Seconds to wait until the transponder answers with it; None waits for ever.

        Raises:
            InvalidArgumentError: It is not possible; nothing was sent.
            ActionTimeout: The transponder did not answer with it.
        """
        if not _REGISTRATION.fullmatch(registration):
            raise InvalidArgumentError(
                f"a registration must be up to 8 of A to Z and 0 to 9, got {registration!r}"
            )
        await self._set(uavionix.UavionixAdsbOutCfgRegistration(registration=registration), timeout)

    def _explained(self, error: CommandDenied) -> CommandDenied:
        """Return the refusal of a report with its reason, which no vehicle gives."""
        autopilot = self._vehicle.autopilot
        reason = _NO_REPORT.get(autopilot, "it does not report a transponder")
        answer = f"{error.answer}: {reason}"
        return CommandDenied(
            error.operation, error.target, attempts=error.attempts, answer=answer, code=error.code
        )

    async def _get(self, kind: type[_Identity], timeout: float | None) -> _Identity:
        async with deadline(timeout, f"reading {name_of(kind)} of", self._vehicle.address):
            return await self._exchange(kind)

    async def _set(self, wanted: _Identity, timeout: float | None) -> None:
        async with deadline(timeout, f"setting {name_of(type(wanted))} of", self._vehicle.address):
            await self._exchange(type(wanted), wanted)

    async def _exchange(self, kind: type[_Identity], wanted: _Identity | None = None) -> _Identity:
        """Ask until the transponder answers, with the wanted value if there is one: links lose messages."""
        vehicle, found = self._vehicle, asyncio.Queue[_Identity]()
        listener = vehicle.connection.add_listener(kind, found.put_nowait, system=vehicle.system)
        try:
            while True:
                if wanted is not None:
                    vehicle.component.send(wanted)
                vehicle.component.send(uavionix.UavionixAdsbGet(ReqMessageId=message_id_of(kind)))
                with suppress(TimeoutError):
                    async with asyncio.timeout(_REPEAT):
                        answer = await found.get()
                        while wanted is not None and _text(answer) != _text(wanted):
                            answer = await found.get()
                        return answer
        finally:
            listener.close()

    def _state(self, *, transmits: bool, altitude: bool, ident: bool) -> int:
        """Return the UAVIONIX_ADSB_OUT_CONTROL_STATE."""
        state = 0 if self._vehicle.in_air else int(_CONTROL.ON_GROUND)
        if transmits:
            state |= _CONTROL.MODE_A_ENABLED | _CONTROL.MODE_S_ENABLED | _POSITION_REPORTS
            state |= _CONTROL.MODE_C_ENABLED if altitude else 0
        return state | (_CONTROL.IDENT_BUTTON_ACTIVE if ident else 0)

    async def _send_until_reported(self, control: uavionix.UavionixAdsbOutControl) -> TransponderStatus:
        """Repeat the message, which a link may lose, until a report that came after it agrees."""
        telemetry, began = self._vehicle.telemetry, self._vehicle.telemetry.now()
        sent = float("-inf")
        while True:
            found = telemetry.latest_with_time(uavionix.UavionixAdsbOutStatus)
            if found is not None and found[1] > began and _agrees(found[0], control):
                return _status_of(found[0])
            if telemetry.now() - sent >= _REPEAT:
                self._vehicle.component.send(control)
                sent = telemetry.now()
            await asyncio.sleep(_POLL)


def _check(squawk: str, flight_id: str, emergency: int) -> None:
    if not _SQUAWK.fullmatch(squawk):
        raise InvalidArgumentError(f"a squawk must be four digits from 0 to 7, got {squawk!r}")
    if not _FLIGHT_ID.fullmatch(flight_id):
        raise InvalidArgumentError(_impossible_flight_id(flight_id))
    if emergency not in range(len(uavionix.UavionixAdsbEmergencyStatus)):
        raise InvalidArgumentError(f"an emergency must be 0 to 7, got {emergency}")


def _text(identity: _Identity) -> str:
    """Return a flight id or a registration without the spaces that fill it."""
    match identity:
        case uavionix.UavionixAdsbOutCfgRegistration(registration=text):
            return text.rstrip()
        case uavionix.UavionixAdsbOutCfgFlightid(flight_id=text):
            return text.rstrip()


def _impossible_flight_id(flight_id: str) -> str:
    return f"a flight id must be up to 8 of A to Z, 0 to 9, space, got {flight_id!r}"


def _agrees(report: uavionix.UavionixAdsbOutStatus, control: uavionix.UavionixAdsbOutControl) -> bool:
    same_modes = int(report.state) & _COMPARED == int(control.state) & _COMPARED
    same_flight = report.flight_id.rstrip() == control.flight_id.rstrip()  # some fill it with spaces
    return same_modes and same_flight and report.squawk == control.squawk


def _status_of(report: uavionix.UavionixAdsbOutStatus) -> TransponderStatus:
    state = int(report.state)
    return TransponderStatus(
        f"{report.squawk:04d}",
        report.flight_id.rstrip(),
        bool(state & _POSITION_REPORTS),
        bool(state & _STATE.MODE_C_ENABLED),
        bool(state & _STATE.IDENT_ACTIVE),
        bool(state & _STATE.ON_GROUND),
        report.boardTemp,
        tuple(each.name or "" for each in uavionix.UavionixAdsbOutStatusFault if int(report.fault) & each),
    )
