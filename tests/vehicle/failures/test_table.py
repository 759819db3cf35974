"""Every call of the vehicle API has a row in the failure table."""

from __future__ import annotations

from inspect import iscoroutinefunction

from mavstack.node.camera import Camera
from mavstack.node.camera_settings import CameraSettings
from mavstack.node.ftp import Ftp
from mavstack.node.gimbal import Gimbal
from mavstack.node.logs import Logs
from mavstack.node.modes import Modes
from mavstack.node.params import Params
from mavstack.node.shell import Shell
from mavstack.vehicle import Actuators, Calibration, CalibrationSession, RegionOfInterest, Vehicle
from mavstack.vehicle.guided_session import GuidedSession
from mavstack.vehicle.mission import Mission, VehiclePlan
from mavstack.vehicle.telemetry import MessageStream, Telemetry
from tests.vehicle.failures.calls import CALLS

API_CLASSES = (
    *(Vehicle, Actuators, RegionOfInterest, Calibration, CalibrationSession),
    *(Telemetry, MessageStream, Mission, VehiclePlan, GuidedSession),
    *(Params, Ftp, Logs, Modes, Shell, Camera, CameraSettings, Gimbal),
)


#: Reads a file; the version of the firmware is requested only to store the metadata in the cache. A beep has
#: no answer. Following needs a second vehicle: its failures are tested in `tests/vehicle/following`.
WITHOUT_ROW = {"Params.load_metadata", "Actuators.beep", "Vehicle.follow"}


def calls_of(api_class):
    special = {"__aenter__", "__aexit__", "__anext__"}
    names = [name for name in dir(api_class) if name in special or not name.startswith("_")]
    return {f"{api_class.__name__}.{name}" for name in names if iscoroutinefunction(getattr(api_class, name))}


def test_every_call_has_a_row():
    wanted = set().union(*map(calls_of, API_CLASSES)) - WITHOUT_ROW
    rows = [call.name for call in CALLS]
    assert len(wanted) > 50
    assert set(rows) == wanted
    assert len(rows) == len(set(rows))


def test_missing_failures_of_a_call_have_a_reason():
    for call in CALLS:
        assert call.why_not or (call.refuse and call.silent), call.name
