"""The operator's side of Remote ID: who flies, from where, and with which vehicle.

The position of the operator is sent each second, as the rules demand; once every ten seconds it is the whole
OPEN_DRONE_ID_SYSTEM, in between the short OPEN_DRONE_ID_SYSTEM_UPDATE, because a slow radio carries little
else at a rate of 1 Hz. Ids are sent every ten seconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.dialects import Message

INTERVAL: Final = 1.0
#: All messages are sent once in this number of intervals; in between only the position is sent.
COMPLETE_EVERY: Final = 10
#: The start of 2019 in Unix seconds, from which OPEN_DRONE_ID_SYSTEM counts its time.
EPOCH: Final = 1_546_300_800
#: The value of an altitude or a limit of the area that is not known, in metres.
UNKNOWN_ALTITUDE: Final = -1000.0
_MAX_ID: Final = 20
_MAX_DESCRIPTION: Final = 23


@dataclass(frozen=True, slots=True)
class Operator:
    """The operator and the vehicle.

    Attributes:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above the ellipsoid; None if not known.
        operator_id: The registration of the operator, up to 20 characters; empty: not sent.
        uas_id: The serial number of the vehicle, up to 20 characters; empty: the module knows it.
        id_type: The MAV_ODID_ID_TYPE of `uas_id`.
        ua_type: The MAV_ODID_UA_TYPE of the vehicle.
        description: The purpose of the flight, up to 23 characters; empty: not sent.
    """

    latitude: float
    longitude: float
    altitude: float | None = None
    operator_id: str = ""
    uas_id: str = ""
    id_type: int = common.MavOdidIdType.SERIAL_NUMBER
    ua_type: int = common.MavOdidUaType.HELICOPTER_OR_MULTIROTOR
    description: str = ""

    def __post_init__(self) -> None:
        if not (abs(self.latitude) <= 90 and abs(self.longitude) <= 180):
            raise InvalidArgumentError("the position of the operator must be on Earth, in degrees")
        if self.altitude is not None and not (isfinite(self.altitude) and -1000 <= self.altitude <= 31_767.5):
            raise InvalidArgumentError(f"the operator's altitude is out of range, got {self.altitude} m")
        for name, limit in (("operator_id", _MAX_ID), ("uas_id", _MAX_ID), ("description", _MAX_DESCRIPTION)):
            text = getattr(self, name)
            if len(text) > limit or not text.isascii() or not (text.isprintable() or not text):
                raise InvalidArgumentError(f"{name} must have up to {limit} printable ASCII characters")


class RemoteIdSender(Service):
    """Sends the messages of an operator to a system.

    Args:
        local: The address of the ground station.
        system: The system id of the vehicle.
        operator: The operator; may be replaced while it moves.
        now: The time of the first messages, Unix seconds.
    """

    def __init__(self, local: Address, system: int, operator: Operator, now: float) -> None:
        super().__init__(local)
        self.operator = operator
        self._target = Address(system, 0)
        self._due = now
        self._count = 0
        #: The number of messages sent.
        self.sent = 0

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        self._due = now + INTERVAL
        is_complete = self._count % COMPLETE_EVERY == 0
        for message in [*self._ids(), self._system(now)] if is_complete else [self._update(now)]:
            self.sent += 1
            self.send(message, self._target)
        self._count += 1

    def _ids(self) -> list[Message]:
        operator, system = self.operator, self._target.system
        messages: list[Message] = []
        if operator.uas_id:
            basic = common.OpenDroneIdBasicId(
                target_system=system,
                id_type=operator.id_type,
                ua_type=operator.ua_type,
                uas_id=operator.uas_id.encode().ljust(_MAX_ID, b"\0"),
            )
            messages.append(basic)
        if operator.operator_id:
            messages.append(
                common.OpenDroneIdOperatorId(target_system=system, operator_id=operator.operator_id)
            )
        if operator.description:
            messages.append(common.OpenDroneIdSelfId(target_system=system, description=operator.description))
        return messages

    def _system(self, now: float) -> Message:
        operator = self.operator
        return common.OpenDroneIdSystem(
            target_system=self._target.system,
            operator_location_type=common.MavOdidOperatorLocationType.LIVE_GNSS,
            operator_latitude=round(operator.latitude * 1e7),
            operator_longitude=round(operator.longitude * 1e7),
            area_count=1,
            area_ceiling=UNKNOWN_ALTITUDE,
            area_floor=UNKNOWN_ALTITUDE,
            operator_altitude_geo=_altitude(operator),
            timestamp=_timestamp(now),
        )

    def _update(self, now: float) -> Message:
        operator = self.operator
        return common.OpenDroneIdSystemUpdate(
            target_system=self._target.system,
            operator_latitude=round(operator.latitude * 1e7),
            operator_longitude=round(operator.longitude * 1e7),
            operator_altitude_geo=_altitude(operator),
            timestamp=_timestamp(now),
        )


def _altitude(operator: Operator) -> float:
    return UNKNOWN_ALTITUDE if operator.altitude is None else operator.altitude


def _timestamp(now: float) -> int:
    return min(max(int(now) - EPOCH, 0), 0xFFFFFFFF)
