"""The services and actions of a vehicle as calls with JSON, for buses without types of their own.

A call has the name of its row in the mapping table ("set_mode", "action/takeoff"). Its request is an object
with the fields of the ROS type, its reply an object:

    {"ok": true, "result": {…}}      {"ok": false, "reason": "arming 1/1 failed: FAILED (PreArm: …)"}

Fields that are left out are 0, false or empty, as in ROS; the altitude and yaw of `action/goto` are kept. The
fields that a row lists as `required` must be given, since their default values would act: a request without
`value` must not disarm.
"""

from __future__ import annotations

import logging
from math import nan
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.endpoints import NO_CONTROL
from mavstack.bridges.core.plain_json import plain
from mavstack.bridges.core.row import Action, Service
from mavstack.bridges.core.table import ACTIONS, SERVICES
from mavstack.bridges.core.types import codec_of
from mavstack.bridges.core.types.model import Container
from mavstack.errors import CdrError, InvalidArgumentError, InvalidStateError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.bridges.core.services.context import ServiceContext
    from mavstack.bridges.core.types import Definition
    from mavstack.security.roles import Role
    from mavstack.vehicle import Vehicle

logger = logging.getLogger("mavstack.bridges")
_FLOATS: Final = ("float32", "float64")
_ROWS: Final[tuple[Service | Action, ...]] = (*SERVICES, *ACTIONS)
#: The rows of services and actions, by name.
CALLS: Final[Mapping[str, Service | Action]] = {row.name: row for row in _ROWS}


class VehicleCalls:
    """The calls of one vehicle.

    Args:
        vehicle: The vehicle.
        role: The role of the bus: which calls are passed to the vehicle.
        context: The state of the services.
    """

    def __init__(self, vehicle: Vehicle, role: Role, context: ServiceContext) -> None:
        self._vehicle = vehicle
        self._role = role
        self._context = context

    async def call(self, name: str, request: Mapping[str, Any]) -> dict[str, Any]:
        """Answer a call; a failure is an answer with the reason, also an error of the program."""
        try:
            result = await self._run(name, request)
        except Exception as error:  # noqa: BLE001 (a request may hold anything)
            logger.info("%s of vehicle %d: %s", name, self._vehicle.system, error)
            return {"ok": False, "reason": str(error) or type(error).__name__}
        return {"ok": result.get("success", True) is not False, "result": plain(result)}

    async def _run(self, name: str, request: Mapping[str, Any]) -> dict[str, Any]:
        row = CALLS.get(name)
        if row is None:
            raise InvalidArgumentError(f"there is no call {name!r:.60}: see `mav bridge list`")
        if row.role > self._role:
            raise InvalidStateError(NO_CONTROL)
        if isinstance(row, Action):
            await row.run(self._vehicle, request_fields(row, request))
            return {}
        return await row.handle(self._vehicle, request_fields(row, request), self._context)


def request_fields(row: Service | Action, request: Mapping[str, Any]) -> dict[str, Any]:
    """Return all fields of a request, checked.

    Args:
        row: The service or action.
        request: The fields that are given.

    Raises:
        InvalidArgumentError: A field is missing or unknown, or a value does not fit its type.
    """
    is_action = isinstance(row, Action)
    codec = codec_of(f"{row.type}_{'Goal' if is_action else 'Request'}")
    is_enough = isinstance(row, Service) and request.get(row.required_unless) is True
    _check_given(codec.definition, () if is_enough else row.required, request)
    numbers = {field.name for field in codec.definition.fields if field.type.base in _FLOATS}
    given = {name: nan if value is None and name in numbers else value for name, value in request.items()}
    if is_action:
        given = dict.fromkeys(numbers, nan) | given
    try:
        return codec.decode_fields(codec.encode_fields(given))
    except (CdrError, TypeError, ValueError, AttributeError) as error:
        raise InvalidArgumentError(f"the request is not valid: {error}") from None


def _check_given(definition: Definition, required: tuple[str, ...], request: Mapping[str, Any]) -> None:
    for name in required:
        if name not in request:
            raise InvalidArgumentError(f"the request needs the field {name!r}")
    for field in definition.fields:
        single_bool = field.type.base == "bool" and field.type.container is Container.ONE
        if single_bool and not isinstance(request.get(field.name, False), bool):
            raise InvalidArgumentError(f"the field {field.name!r} must be true or false")
