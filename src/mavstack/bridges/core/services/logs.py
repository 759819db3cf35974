"""Services of logs: requests whose answers are the topics log_entry and log_data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.row import Service
from mavstack.dialects import common
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

Fields = dict[str, Any]


async def request_list(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Request the list of logs (mavros_msgs/LogRequestList)."""
    vehicle.component.send(common.LogRequestList(start=request["start"], end=request["end"]))
    return {"success": True}


async def request_data(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Request a part of a log (mavros_msgs/LogRequestData)."""
    wanted = {"id": request["id"], "ofs": request["offset"], "count": request["count"]}
    vehicle.component.send(common.LogRequestData(**wanted))
    return {"success": True}


async def request_end(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """End the transfer (mavros_msgs/LogRequestEnd)."""
    vehicle.component.send(common.LogRequestEnd())
    return {"success": True}


async def erase(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Erase all logs (std_srvs/Trigger)."""
    vehicle.component.send(common.LogErase())
    return {"success": True}


_PREFIX: Final = "log_transfer/raw/log_request_"
ROWS: Final = (
    Service(
        f"{_PREFIX}list",
        "mavros_msgs/srv/LogRequestList",
        request_list,
        Role.OPERATE,
        "answers on log_transfer/raw/log_entry",
    ),
    Service(
        f"{_PREFIX}data",
        "mavros_msgs/srv/LogRequestData",
        request_data,
        Role.OPERATE,
        "answers on log_transfer/raw/log_data",
    ),
    Service(f"{_PREFIX}end", "mavros_msgs/srv/LogRequestEnd", request_end, Role.OPERATE, "LOG_REQUEST_END"),
    Service(f"{_PREFIX}erase", "std_srvs/srv/Trigger", erase, Role.ADMINISTER, "LOG_ERASE"),
)
