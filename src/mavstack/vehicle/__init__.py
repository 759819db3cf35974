"""The application API: `connect`, the vehicles that it finds, groups of them, and their events."""

from mavstack.services.heartbeat import OwnAddressConflict
from mavstack.vehicle.actions.renumber import Renumbered
from mavstack.vehicle.actuators import Actuators
from mavstack.vehicle.calibration import (
    Calibration,
    CalibrationKind,
    CalibrationResult,
    CalibrationSession,
    CalibrationStep,
    CalibrationTask,
    ChannelRange,
    CompassFit,
    Pose,
)
from mavstack.vehicle.capabilities import Capabilities
from mavstack.vehicle.connection import Connection, NodeOptions, connect
from mavstack.vehicle.events import (
    GroundStationFound,
    GroundStationLost,
    GroundStationReturned,
    PayloadFound,
    PayloadLost,
    PayloadReturned,
    SecondAutopilotFound,
    SystemIdConflict,
    SystemIdConflictEnded,
    VehicleEvent,
    VehicleFound,
    VehicleLost,
    VehicleRebooted,
    VehicleReturned,
)
from mavstack.vehicle.group import Group, Results
from mavstack.vehicle.guided_session import GuidedSession
from mavstack.vehicle.health import Health, Problem
from mavstack.vehicle.mission import Mission, VehiclePlan
from mavstack.vehicle.roi import RegionOfInterest
from mavstack.vehicle.telemetry import MessageStream, ValueStream
from mavstack.vehicle.vehicle import Vehicle
from mavstack.vehicle.vehicle_type import VehicleType

__all__ = [
    "Actuators",
    "Calibration",
    "CalibrationKind",
    "CalibrationResult",
    "CalibrationSession",
    "CalibrationStep",
    "CalibrationTask",
    "Capabilities",
    "ChannelRange",
    "CompassFit",
    "Connection",
    "GroundStationFound",
    "GroundStationLost",
    "GroundStationReturned",
    "Group",
    "GuidedSession",
    "Health",
    "MessageStream",
    "Mission",
    "NodeOptions",
    "OwnAddressConflict",
    "PayloadFound",
    "PayloadLost",
    "PayloadReturned",
    "Pose",
    "Problem",
    "RegionOfInterest",
    "Renumbered",
    "Results",
    "SecondAutopilotFound",
    "SystemIdConflict",
    "SystemIdConflictEnded",
    "ValueStream",
    "Vehicle",
    "VehicleEvent",
    "VehicleFound",
    "VehicleLost",
    "VehiclePlan",
    "VehicleRebooted",
    "VehicleReturned",
    "VehicleType",
    "connect",
]
