"""The storage of one vehicle: its file store, the served file tree, and its onboard logs."""

from __future__ import annotations

from errno import EINVAL
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError
from mavstack.services.addressing import BROADCAST
from mavstack.sim.parameters import metadata_files
from mavstack.sim.storage.dataflash_logs import DataflashLogs
from mavstack.sim.storage.flight_logs import DEFAULT_LOG_CAPACITY
from mavstack.sim.storage.roots import ardupilot_root, file_store, px4_root
from mavstack.sim.storage.sample import LoggedParameter, LogStart
from mavstack.sim.storage.ulog_logs import UlogLogs
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from mavstack.services.mission import Plan
    from mavstack.services.parameters import Parameter
    from mavstack.sim.storage.flight_logs import FlightLogs
    from mavstack.sim.vehicle import SimulatedVehicle

#: Versions of the firmwares in log files, and the hash of their source code.
ARDUPILOT_VERSION, PX4_VERSION = (4, 6, 0), (1, 16, 0)
GIT_HASH = "6d617673"
_NAMES = {
    "copter": "ArduCopter",
    "plane": "ArduPlane",
    "vtol": "ArduPlane",
    "rover": "ArduRover",
    "boat": "ArduRover",
    "sub": "ArduSub",
}


class Storage:
    """The files (`files`, for FtpServer) and the logs (`logs`, for LogServer) of one vehicle.

    Args:
        vehicle: The vehicle.
        folder: Where the files are kept between runs; None keeps them in memory.
        capacity: Maximum bytes of all logs.
    """

    def __init__(
        self,
        vehicle: SimulatedVehicle,
        *,
        folder: str | os.PathLike[str] | None = None,
        capacity: int = DEFAULT_LOG_CAPACITY,
    ) -> None:
        self._vehicle = vehicle
        self.store = file_store(folder)
        table = vehicle.parameters.table
        self.logs: FlightLogs
        if vehicle.firmware is Firmware.PX4:
            self.files = px4_root(self.store, table)
            self.logs = UlogLogs(self.store, self._log_start, capacity=capacity)
        else:
            self.files = ardupilot_root(
                self.store,
                table,
                self._plan,
                lambda: vehicle.uptime,
                set_parameters=self._set_parameters,
                set_plan=self._set_plan,
            )
            self.logs = DataflashLogs(self.store, self._log_start, capacity=capacity)
        for path, file in metadata_files(vehicle.firmware, vehicle.vehicle_type).items():
            self.files.add(path, file)

    @property
    def firmware(self) -> str:
        """Banner of the firmware."""
        vehicle = self._vehicle
        if vehicle.firmware is Firmware.PX4:
            return "PX4 v{}.{}.{}".format(*PX4_VERSION)
        return "{} V{}.{}.{} ({})".format(_NAMES[vehicle.vehicle_type], *ARDUPILOT_VERSION, GIT_HASH)

    def _log_start(self) -> LogStart:
        """Return the facts at the start of a log."""
        vehicle = self._vehicle
        home, frame = vehicle.autopilot.home, vehicle.body.frame
        return LogStart(
            boot=vehicle.booted_at,
            firmware=self.firmware,
            version=PX4_VERSION if vehicle.firmware is Firmware.PX4 else ARDUPILOT_VERSION,
            git_hash=GIT_HASH,
            system=vehicle.address.system,
            vehicle=vehicle.vehicle_type.mav_type,
            parameters=[
                LoggedParameter(each.name, each.value, each.default) for each in vehicle.parameters.table
            ],
            mission=self._plan(common.MavMissionType.MISSION).items,
            origin=frame.to_global(0.0, 0.0, 0.0),
            home=None if home is None else (home.latitude, home.longitude, home.altitude),
            mode=vehicle.autopilot.mode.number,
        )

    def _plan(self, kind: int) -> Plan:
        """Return the plan of a MAV_MISSION_TYPE."""
        return self._vehicle.mission.plan(kind)

    def _set_plan(self, plan: Plan) -> None:
        """Replace a plan by an uploaded one."""
        mission = self._vehicle.mission
        self._vehicle.touch(mission)
        if mission.accept(plan, BROADCAST) != common.MavMissionResult.ACCEPTED:
            raise OSError(EINVAL, "the plan was refused")

    def _set_parameters(self, parameters: Sequence[Parameter]) -> None:
        """Set uploaded parameters, all or none."""
        table = self._vehicle.parameters
        known = [parameter for parameter in parameters if parameter.name in table]
        for parameter in known:
            if table.table[parameter.name].refusal(parameter.value) is not None:
                raise OSError(EINVAL, f"{parameter.name} was refused")
        for parameter in known:
            try:
                table.set(parameter.name, parameter.value)
            except LocalProtocolError as error:
                raise OSError(EINVAL, str(error)) from None
