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

FACES = (
    *(Vehicle, Actuators, RegionOfInterest, Calibration, CalibrationSession),
    *(Telemetry, MessageStream, Mission, VehiclePlan, GuidedSession),
    *(Params, Ftp, Logs, Modes, Shell, Camera, CameraSettings, Gimbal),
)


#: Reads a file; only to remember it, it asks for the version of the firmware.
NO_CALLS_OF_VEHICLES = {"Params.load_metadata"}


def calls_of(face):
    special = {"__aenter__", "__aexit__", "__anext__"}
    names = [name for name in dir(face) if name in special or not name.startswith("_")]
    return {f"{face.__name__}.{name}" for name in names if iscoroutinefunction(getattr(face, name))}


def test_every_call_has_a_row():
    wanted = set().union(*map(calls_of, FACES)) - NO_CALLS_OF_VEHICLES
    rows = [call.name for call in CALLS]
    assert len(wanted) > 50
    assert set(rows) == wanted
    assert len(rows) == len(set(rows))


def test_missing_failures_of_a_call_have_a_reason():
    for call in CALLS:
        assert call.why_not or (call.refuse and call.silent), call.name
