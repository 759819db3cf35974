"""PX4's arm authorisation: COM_ARM_AUTH_REQ, _ID, _MET, _TO.

With method 0 the arming command waits for the answer, with method 1 it is rejected and the answer lets the
next one pass. An approval is valid for the seconds that it names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.arm_authorization import (
    ArmApproval,
    ArmAuthorizationAnswered,
    ArmAuthorizationClient,
    ArmRefusal,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.commands import Outcome
    from mavstack.sim.autopilot.tasks import Script
    from mavstack.sim.vehicle import SimulatedVehicle

_RESULT: Final = common.MavResult
_REASON: Final = common.MavArmAuthDeniedReason
_INFO, _CRITICAL = common.MavSeverity.INFO, common.MavSeverity.CRITICAL
_TWO_STEPS: Final = 1


class ArmAuthorization:
    """The authorisation of one boot."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._client = vehicle.engine.add(ArmAuthorizationClient(vehicle.address))
        self._valid_until = 0.0
        vehicle.on_event(ArmAuthorizationAnswered, self._answered)

    @property
    def is_needed(self) -> bool:
        """True if the vehicle may not arm without asking."""
        needed = int(self._vehicle.parameters["COM_ARM_AUTH_REQ"])
        return bool(needed) and self._vehicle.now > self._valid_until

    def ask(self, request: CommandRequest, arm: Callable[[], common.MavResult]) -> Outcome:
        """Ask the authoriser; `arm` arms once it approved."""
        vehicle = self._vehicle
        parameters = vehicle.parameters
        if not self._client.is_waiting:
            timeout = float(parameters["COM_ARM_AUTH_TO"])
            self._client.request(int(parameters["COM_ARM_AUTH_ID"]), vehicle.now, timeout=timeout)
            vehicle.touch(self._client)
            if int(parameters["COM_ARM_AUTH_MET"]) == _TWO_STEPS:
                vehicle.send_statustext("Arm auth: Requesting authorization...", _INFO)
        if int(parameters["COM_ARM_AUTH_MET"]) == _TWO_STEPS:
            return _RESULT.TEMPORARILY_REJECTED
        vehicle.autopilot.tasks.begin(request, self._wait(arm))
        return None

    def _wait(self, arm: Callable[[], common.MavResult]) -> Script:
        while self._client.is_waiting:
            yield None
        return _RESULT.DENIED if self.is_needed else arm()

    def _answered(self, event: ArmAuthorizationAnswered) -> None:
        for text, severity in self._texts(event.answer):
            self._vehicle.send_statustext(text, severity)

    def _texts(self, answer: ArmApproval | ArmRefusal | None) -> Iterator[tuple[str, int]]:
        match answer:
            case ArmApproval(seconds=seconds):
                self._valid_until = self._vehicle.now + seconds
                yield f"Arm auth: Authorized for the next {seconds} seconds", _INFO
            case ArmRefusal(temporarily=True):
                yield "Arm auth: Temporarily rejected", _CRITICAL
            case ArmRefusal(reason=_REASON.NONE):
                # The authoriser itself reports the reason to the ground station.
                return
            case ArmRefusal(reason=_REASON.INVALID_WAYPOINT, detail=waypoint):
                yield f"Arm auth: Denied, waypoint {waypoint} have a invalid value", _CRITICAL
            case ArmRefusal(reason=reason):
                yield _DENIALS.get(reason, "Arm auth: Denied"), _CRITICAL
            case None:
                yield "Arm auth: No response", _CRITICAL


_DENIALS: Final[dict[int, str]] = {
    _REASON.TIMEOUT: "Arm auth: Denied by timeout in authorizer",
    _REASON.AIRSPACE_IN_USE: "Arm auth: Denied because airspace is in use",
    _REASON.BAD_WEATHER: "Arm auth: Denied because of bad weather",
}
