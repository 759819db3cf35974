"""The capabilities of a vehicle, which a user interface reads before it shows a panel.

    if vehicle.capabilities.fence: ...
    if "compass" in vehicle.capabilities.calibrations: ...

They follow from the MAV_PROTOCOL_CAPABILITY flags of AUTOPILOT_VERSION, from the firmware and the vehicle
type, and from what was received: components, messages and parameters. A value is None while it is not known;
`Vehicle.get_version` requests the flags. An object is a snapshot: read the property again later.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported
from mavstack.services.setpoints import LocalSetpoint
from mavstack.services.version import AutopilotVersion
from mavstack.vehicle.calibration.selection import procedures_of
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.vehicle.calibration.kinds import CalibrationKind
    from mavstack.vehicle.vehicle import Vehicle

_FLAG: Final = common.MavProtocolCapability
_TYPE: Final = common.MavType

#: A parameter that exists in ArduPilot builds whose estimator has several sets of sources.
_EKF_SOURCE: Final = "EK3_SRC1_POSXY"


_SOME_POSITION: Final = LocalSetpoint(position=(0.0, 0.0, 0.0))


@dataclass(frozen=True, slots=True)
class Capabilities:
    """The capabilities of a vehicle; None: not known yet.

    Attributes:
        parameters: Parameters can be read and set: `params`.
        extended_parameters: A component has extended parameters: `component.extended_params`.
        mission: Missions can be transferred: `mission`.
        fence: Geofences can be transferred: `fence`.
        rally: Rally points can be transferred: `rally`.
        ftp: Files can be transferred by MAVLink FTP: `ftp`.
        logs: Logs can be downloaded: `logs`.
        shell: The firmware has a shell: `shell`.
        events: The vehicle sends events: `events`.
        takeoff: The vehicle takes off: `takeoff`.
        goto: The vehicle goes to locations: `goto`.
        orbit: The vehicle circles locations: `orbit`.
        roi: The vehicle points at locations: `roi`.
        home: The home position can be set: `set_home`.
        manual_control: The vehicle takes the sticks of a ground station: `component.manual_control`.
        setpoints: The vehicle follows setpoints of its position: `guided`.
        attitude_setpoints: The vehicle follows setpoints of its attitude: `guided`.
        command_int: Commands may be sent as COMMAND_INT: `command` with a frame.
        mavlink2: The vehicle speaks MAVLink 2, which signing needs: `component.setup_signing`.
        terrain: The vehicle asks for terrain data: `terrain`.
        termination: The flight can be terminated: `terminate`.
        vtol: The vehicle hovers and flies on a wing: `transition_to_fixed_wing`.
        servos: Servo outputs can be set: `actuators.set_servo`.
        relays: Relays can be switched: `actuators.set_relay`.
        actuators: Actuator outputs can be set: `actuators.set_actuator`.
        motor_test: Single motors can be run: `actuators.test_motor`.
        failures: Units fail on purpose, if a parameter permits it: `failure.inject`.
        gripper: There is a gripper: `actuators.grip`.
        winch: There is a winch: `actuators.unwind`.
        ekf_sources: The sources of the estimator can be selected: `set_ekf_source`.
        osd: There is an on-screen display.
        vtx: There is a video transmitter that the vehicle controls.
        flashing: The firmware can be replaced over USB by its bootloader.
        calibrations: The kinds of calibrations: `calibration`.
        cameras: The ids of cameras: `camera`.
        gimbals: The component ids of gimbals and gimbal managers: `find_gimbals`.
    """

    parameters: bool | None = None
    extended_parameters: bool | None = None
    mission: bool | None = None
    fence: bool | None = None
    rally: bool | None = None
    ftp: bool | None = None
    logs: bool | None = None
    shell: bool | None = None
    events: bool | None = None
    takeoff: bool | None = None
    goto: bool | None = None
    orbit: bool | None = None
    roi: bool | None = None
    home: bool | None = None
    manual_control: bool | None = None
    setpoints: bool | None = None
    attitude_setpoints: bool | None = None
    command_int: bool | None = None
    mavlink2: bool | None = None
    terrain: bool | None = None
    termination: bool | None = None
    vtol: bool | None = None
    servos: bool | None = None
    relays: bool | None = None
    actuators: bool | None = None
    motor_test: bool | None = None
    failures: bool | None = None
    gripper: bool | None = None
    winch: bool | None = None
    ekf_sources: bool | None = None
    osd: bool | None = None
    vtx: bool | None = None
    flashing: bool | None = None
    calibrations: tuple[CalibrationKind, ...] = ()
    cameras: tuple[int, ...] = ()
    gimbals: tuple[int, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the capabilities that the vehicle has."""
        return tuple(each.name for each in fields(self) if getattr(self, each.name))


def capabilities_of(vehicle: Vehicle) -> Capabilities:
    """Return the capabilities of a vehicle as far as they are known now."""
    reader = _Reader(vehicle)
    firmware = firmware_of(vehicle)
    features = firmware.FEATURES
    cameras, gimbals = tuple(reader.cameras()), tuple(reader.gimbals())
    return Capabilities(
        parameters=reader.first(features.get("parameters"), reader.parameters()),
        extended_parameters=bool(cameras) or reader.heard(common.ParamExtValue),
        mission=reader.first(reader.flag(_FLAG.MISSION_INT), features.get("mission")),
        fence=reader.first(features.get("fence"), reader.flag(_FLAG.MISSION_FENCE)),
        rally=reader.first(features.get("rally"), reader.flag(_FLAG.MISSION_RALLY)),
        ftp=reader.first(features.get("ftp"), reader.flag(_FLAG.FTP)),
        logs=reader.first(features.get("logs"), reader.heard(common.LogEntry)),
        shell=features.get("shell"),
        events=reader.first(
            features.get("events"), reader.heard(common.CurrentEventSequence), reader.heard(common.Event)
        ),
        takeoff=reader.action("takeoff", possible=vehicle.vehicle_type.flies),
        goto=reader.action("goto", possible=True),
        orbit=reader.action("orbit", possible=firmware.can_orbit),
        roi=reader.action("roi", possible=True),
        home=reader.action("home", possible=True),
        manual_control=features.get("manual_control"),
        setpoints=reader.first(
            features.get("setpoints"),
            reader.follows_positions(),
            reader.flag(_FLAG.SET_POSITION_TARGET_LOCAL_NED),
        ),
        attitude_setpoints=reader.first(
            features.get("attitude_setpoints"), reader.flag(_FLAG.SET_ATTITUDE_TARGET)
        ),
        command_int=reader.flag(_FLAG.COMMAND_INT),
        mavlink2=reader.flag(_FLAG.MAVLINK2),
        terrain=reader.first(features.get("terrain"), reader.flag(_FLAG.TERRAIN)),
        termination=reader.flag(_FLAG.FLIGHT_TERMINATION),
        vtol=reader.vtol(),
        servos=features.get("servos"),
        relays=features.get("relays"),
        actuators=features.get("actuators"),
        motor_test=features.get("motor_test"),
        failures=features.get("failures"),
        gripper=reader.first(
            features.get("gripper"), reader.enabled("gripper"), reader.flag(_FLAG.GRIPPER) or None
        ),
        winch=reader.first(features.get("winch"), reader.enabled("winch"), reader.heard(common.WinchStatus)),
        ekf_sources=features.get("ekf_sources", reader.has_parameter(_EKF_SOURCE)),
        osd=reader.enabled("osd"),
        vtx=reader.enabled("vtx"),
        flashing=reader.flashing() if features.get("flashing") else features.get("flashing"),
        calibrations=tuple(procedures_of(vehicle)),
        cameras=cameras,
        gimbals=gimbals,
    )


class _Reader:
    """Reads what is known of a vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        message = vehicle.latest(common.AutopilotVersion)
        self._version = None if message is None else AutopilotVersion.read(message)

    @staticmethod
    def first(*values: bool | None) -> bool | None:
        """Return the first value that is known."""
        return next((value for value in values if value is not None), None)

    def flag(self, flag: int) -> bool | None:
        """Return whether AUTOPILOT_VERSION has a flag."""
        return None if self._version is None else self._version.can(flag)

    def heard(self, message: type[Message]) -> bool | None:
        """Return True if a component of the vehicle has sent a message, else None."""
        components = (None, *self._vehicle.components)
        return True if any(self._vehicle.latest(message, each) for each in components) else None

    def parameters(self) -> bool | None:
        """Return whether one of the flags for parameter encodings is set."""
        flags = (_FLAG.PARAM_ENCODE_C_CAST, _FLAG.PARAM_ENCODE_BYTEWISE, _FLAG.PARAM_FLOAT)
        return None if self._version is None else any(self._version.can(flag) for flag in flags)

    def vtol(self) -> bool | None:
        """Return whether the vehicle is a VTOL."""
        return (
            None if self._vehicle.component.info is None else self._vehicle.vehicle_type is VehicleType.VTOL
        )

    def action(self, call: str, *, possible: bool) -> bool | None:
        """Return whether the firmware has a call; None for an unknown firmware, which may have it."""
        firmware = firmware_of(self._vehicle)
        if self._vehicle.component.info is None:
            return None
        if call in firmware.LACKING or not possible:
            return False
        return True if firmware.FEATURES else None

    def follows_positions(self) -> bool | None:
        """Return False if the vehicle ignores setpoints of positions; None if that is not known."""
        try:
            firmware_of(self._vehicle).check_setpoint(_SOME_POSITION)
        except ActionUnsupported:
            return False
        return None

    def enabled(self, equipment: str) -> bool | None:
        """Return whether a downloaded parameter enables an equipment; None if none was downloaded."""
        cached = self._vehicle.params.cached
        names = firmware_of(self._vehicle).EQUIPMENT_PARAMETERS.get(equipment, ())
        values = [cached[name].value for name in names if name in cached]
        return any(values) if values else None

    def has_parameter(self, name: str) -> bool | None:
        """Return True if a parameter was downloaded; a build without a feature lacks its parameters."""
        return True if name in self._vehicle.params.cached else None

    def flashing(self) -> bool | None:
        """Return whether the board has a bootloader; simulated ones have none."""
        return None if self._version is None else firmware_of(self._vehicle).has_bootloader(self._version)

    def manages_gimbals(self, component: int | None) -> bool:
        """Return whether a component sent a report of a gimbal manager; None: the autopilot."""
        reports = (common.GimbalManagerInformation, common.GimbalManagerStatus)
        return any(self._vehicle.latest(each, component) for each in reports)

    def cameras(self) -> Iterator[int]:
        """Yield the component ids of cameras, and the number of one that is attached to the autopilot."""
        for component, info in self._vehicle.components.items():
            if info.type == _TYPE.CAMERA:
                yield component
        attached = self._vehicle.latest(common.CameraInformation)
        if attached is not None:
            yield attached.camera_device_id or self._vehicle.address.component

    def gimbals(self) -> Iterator[int]:
        """Yield the component ids of gimbals, and that of an autopilot that manages one."""
        for component, info in self._vehicle.components.items():
            if info.type == _TYPE.GIMBAL or self.manages_gimbals(component):
                yield component
        if self.manages_gimbals(None) or self.flag(_FLAG.COMPONENT_IMPLEMENTS_GIMBAL_MANAGER):
            yield self._vehicle.address.component
