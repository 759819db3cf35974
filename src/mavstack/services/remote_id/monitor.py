"""The Remote ID of a vehicle as it is heard: its module, whether it may arm, and why not.

A module is a component ODID_TXRX_1 to 3. It sends a heartbeat, and OPEN_DRONE_ID_ARM_STATUS with a reason
while it lacks something. Autopilots refuse to arm without it if their parameters say so (DID_ENABLE of
ArduPilot, COM_ARM_ODID 2 of PX4). Source: guide, Open Drone ID Protocol; ArduPilot, AP_OpenDroneID.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.wire import Packet

MODULES: Final = frozenset(
    {common.MavComponent.ODID_TXRX_1, common.MavComponent.ODID_TXRX_2, common.MavComponent.ODID_TXRX_3}
)
#: Seconds without a heartbeat after which a module counts as lost.
MODULE_TIMEOUT: Final = 3.0
#: Seconds after which the status of a module is out of date.
STATUS_TIMEOUT: Final = 5.0
#: Seconds after which the position of the operator is too old.
OPERATOR_TIMEOUT: Final = 5.0
_GOOD = common.MavOdidArmStatus.GOOD_TO_ARM
_KINDS = (
    common.Heartbeat,
    common.OpenDroneIdArmStatus,
    common.OpenDroneIdBasicId,
    common.OpenDroneIdLocation,
    common.OpenDroneIdSystem,
    common.OpenDroneIdSystemUpdate,
    common.OpenDroneIdOperatorId,
    common.OpenDroneIdSelfId,
)


@dataclass(frozen=True, slots=True)
class RemoteIdStatus:
    """The state of a vehicle's Remote ID.

    Attributes:
        module: The component id of its module; None if none was heard.
        may_arm: Whether the module says that the vehicle may arm; None if it says nothing.
        reasons: Why the vehicle may not arm, in words; the text of the module first.
        uas_id: The id that the module or the autopilot sends; empty if none was heard.
        operator_id: The id of the operator; empty if none was heard.
        operator: Latitude and longitude of the operator in degrees; None if they were not heard.
        location: Latitude and longitude of the vehicle in degrees; None if they were not heard.
        status: The MAV_ODID_STATUS of the vehicle; None if it was not heard.
    """

    module: int | None
    may_arm: bool | None
    reasons: tuple[str, ...]
    uas_id: str = ""
    operator_id: str = ""
    operator: tuple[float, float] | None = None
    location: tuple[float, float] | None = None
    status: int | None = None


class RemoteIdMonitor(Service):
    """Keeps the newest messages about the Remote ID of one system, of its module and of ground stations.

    Args:
        local: The address of the local component.
        system: The system id of the vehicle.
    """

    handles = message_ids(*_KINDS)

    def __init__(self, local: Address, system: int) -> None:
        super().__init__(local)
        self._system = system
        self._latest: dict[type, tuple[Message, float]] = {}
        self._module: tuple[int, float] | None = None

    def receive(self, packet: Packet, now: float) -> bool:
        message = packet.message
        kind = next((kind for kind in _KINDS if isinstance(message, kind)), None)
        if kind is common.Heartbeat or kind is common.OpenDroneIdArmStatus:
            if packet.system != self._system or packet.component not in MODULES:
                return False
            self._module = packet.component, now
        if kind is not None and message is not None:
            self._latest[kind] = message, now
        return False

    def status(self, now: float) -> RemoteIdStatus:
        """Return the state of the Remote ID."""
        module = self._module
        if module is None or now - module[1] > MODULE_TIMEOUT:
            lost = "is silent" if module else "was heard"
            reason = f"the Remote ID module {module[0]} {lost}" if module else f"no Remote ID module {lost}"
            return self._described(None, None, (reason,), now)
        status = self._newest(common.OpenDroneIdArmStatus, now, STATUS_TIMEOUT)
        if status is None:
            return self._described(module[0], None, ("the module sends no OPEN_DRONE_ID_ARM_STATUS",), now)
        may_arm = status.status == _GOOD
        reasons = () if may_arm else (status.error or "the module gives no reason", *self._missing(now))
        return self._described(module[0], may_arm, tuple(reasons), now)

    def _missing(self, now: float) -> list[str]:
        """Return the messages that a module needs and did not get."""
        missing = []
        if self._newest(common.OpenDroneIdBasicId, now, 60.0) is None:
            missing.append("no OPEN_DRONE_ID_BASIC_ID was heard")
        if self._operator(now) is None:
            missing.append("no position of the operator was heard (OPEN_DRONE_ID_SYSTEM): mav rid send")
        if self._newest(common.OpenDroneIdLocation, now, OPERATOR_TIMEOUT) is None:
            missing.append("the autopilot sends no OPEN_DRONE_ID_LOCATION")
        return missing

    def _described(
        self, module: int | None, may_arm: bool | None, reasons: tuple[str, ...], now: float
    ) -> RemoteIdStatus:
        basic = self._newest(common.OpenDroneIdBasicId, now, 60.0)
        operator_id = self._newest(common.OpenDroneIdOperatorId, now, 60.0)
        location = self._newest(common.OpenDroneIdLocation, now, OPERATOR_TIMEOUT)
        return RemoteIdStatus(
            module,
            may_arm,
            reasons,
            "" if basic is None else id_text(bytes(basic.uas_id)),
            "" if operator_id is None else operator_id.operator_id,
            self._operator(now),
            None if location is None else _place(location.latitude, location.longitude),
            None if location is None else int(location.status),
        )

    def _operator(self, now: float) -> tuple[float, float] | None:
        update = self._newest(common.OpenDroneIdSystemUpdate, now, OPERATOR_TIMEOUT)
        system = self._newest(common.OpenDroneIdSystem, now, OPERATOR_TIMEOUT)
        newest = update or system
        return None if newest is None else _place(newest.operator_latitude, newest.operator_longitude)

    def _newest(self, kind: type[Message], now: float, timeout: float) -> Any:  # noqa: ANN401
        message, at = self._latest.get(kind, (None, 0.0))
        return message if now - at <= timeout else None


def id_text(data: bytes) -> str:
    """Return an id of 20 bytes as text: its characters, or hexadecimal digits if it has others."""
    text = data.rstrip(b"\0")
    return text.decode("ascii") if all(32 <= byte < 127 for byte in text) else text.hex()


def _place(latitude: int, longitude: int) -> tuple[float, float] | None:
    """Return a position in degrees; 0, 0 is not known."""
    return (latitude / 1e7, longitude / 1e7) if latitude or longitude else None
