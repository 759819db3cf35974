"""The preconditions of each call that acts on a vehicle: one table, checked before anything is sent.

A row names what a call needs: an armed vehicle, or one that flies. A precondition that the telemetry leaves
open counts as met; then the vehicle decides. `ALWAYS` holds for every acting call. A call whose precondition
is not met raises `ActionRefused`, and the vehicle stays as it is.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import ActionRefused
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.telemetry.problems import recent
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.vehicle.vehicle import Vehicle

    #: Returns why a call is not possible now, and what to do; None if it is, or if that is not known.
    Precondition: TypeAlias = Callable[[Vehicle], str | None]


#: The estimates of a horizontal position with which ArduPilot goes to places.
_POSITION: Final = ardupilotmega.EkfStatusFlags.POS_HORIZ_ABS | ardupilotmega.EkfStatusFlags.POS_HORIZ_REL


def armed(vehicle: Vehicle) -> str | None:
    """Require a vehicle that is armed."""
    return "it is not armed; arm it first" if vehicle.armed is False else None


def airborne(vehicle: Vehicle) -> str | None:
    """Require that a vehicle that flies is in the air: on the ground a plane would run at full throttle."""
    grounded = vehicle.vehicle_type.flies and vehicle.in_air is False
    return "it is on the ground; take off first" if grounded else None


def located(vehicle: Vehicle) -> str | None:
    """Require that the position of a submarine is estimated: it arms without one, and refuses GUIDED then."""
    status = recent(vehicle.telemetry, ardupilotmega.EkfStatusReport)
    if vehicle.vehicle_type is not VehicleType.SUB or status is None or status.flags & _POSITION:
        return None
    return 'its position is not estimated; wait_until_ready(mode="GUIDED") waits for that'


#: The key of the call that sends any command. A command that reads is allowed while several vehicles use one
#: system id.
ANY_COMMAND: Final = "command"
#: The preconditions of every call that acts on a vehicle.
ALWAYS: Final[tuple[Precondition, ...]] = ()
#: The preconditions of each call; an empty tuple means that the call needs only `ALWAYS`.
PRECONDITIONS: Final[Mapping[str, tuple[Precondition, ...]]] = MappingProxyType(
    {
        "takeoff": (armed,),
        "land": (armed,),
        "rtl": (armed,),
        "hold": (armed,),
        "goto": (armed, airborne, located),
        "orbit": (armed, airborne, located),
        "turn": (armed, airborne),
        "transition": (armed, airborne),
        "guided": (armed,),
        "follow": (armed, airborne),
        "mission start": (armed,),
        "mission pause": (armed,),
        **dict.fromkeys(("arm", "disarm", "mode", "speed", "home", "terminate", "mission fly"), ()),
        **dict.fromkeys(("command", "mission current", "roi", "outputs", "ekf sources"), ()),
        **dict.fromkeys(("reboot", "calibration", "wind"), ()),
    }
)


def check_preconditions(vehicle: Vehicle, call: str, operation: str) -> None:
    """Raise unless a vehicle can take a call now; nothing is sent.

    Args:
        vehicle: The vehicle.
        call: The key of the call in `PRECONDITIONS`.
        operation: The operation as errors name it, with its preposition.

    Raises:
        SystemIdConflictError: Several vehicles use the system id, and none was chosen.
        ActionUnsupported: The firmware lacks the call.
        ActionRefused: A precondition is not met; the text names it and the remedy.
    """
    if call != ANY_COMMAND:
        vehicle.connection.refuse_conflict(vehicle.system, operation)
    firmware_of(vehicle).check_supported(call)
    for precondition in (*ALWAYS, *PRECONDITIONS[call]):
        reason = precondition(vehicle)
        if reason is not None:
            raise refusal(vehicle, operation, reason)


def refusal(vehicle: Vehicle, operation: str, reason: str) -> ActionRefused:
    """Return the error for an action that was refused before anything was sent."""
    code = common.MavResult.TEMPORARILY_REJECTED
    return ActionRefused(operation, str(vehicle.address), answer=reason, code=code)
