"""The selection of calibrations by the firmware and the type of a vehicle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.vehicle.calibration import ardupilot, msp, px4
from mavstack.vehicle.firmware import MspFirmware, firmware_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.calibration.kinds import CalibrationKind
    from mavstack.vehicle.calibration.procedure import Procedure
    from mavstack.vehicle.vehicle import Vehicle


def procedures_of(vehicle: Vehicle) -> Mapping[CalibrationKind, Procedure]:
    """Return the procedures that a vehicle has; none for a firmware that is not known."""
    if isinstance(firmware_of(vehicle), MspFirmware):
        return msp.PROCEDURES
    match vehicle.autopilot:
        case common.MavAutopilot.ARDUPILOTMEGA:
            table, lacking = ardupilot.PROCEDURES, ardupilot.lacking(vehicle.vehicle_type)
        case common.MavAutopilot.PX4:
            table, lacking = px4.PROCEDURES, px4.lacking(vehicle.vehicle_type)
        case _:
            return {}
    return {kind: procedure for kind, procedure in table.items() if kind not in lacking}
