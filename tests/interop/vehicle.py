"""A vehicle on UDP for peers: every service, telemetry, and handlers of common commands."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.links import open_link
from mavstack.services.ftp import DirectoryStore, FtpServer
from mavstack.services.parameters import Encoding
from mavstack.services.version import AutopilotVersion, FirmwareVersion, provide_versions
from tests.node.vehicle import Vehicle

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest

RESULT = common.MavResult
CAN = common.MavProtocolCapability
SENSOR = common.MavSysStatusSensor
ARMED = common.MavModeFlag.SAFETY_ARMED | common.MavModeFlag.CUSTOM_MODE_ENABLED
HEALTHY = SENSOR.SENSOR_3D_GYRO | SENSOR.SENSOR_3D_ACCEL | SENSOR.SENSOR_3D_MAG
LATITUDE, LONGITUDE = 47.3977415, 8.5455941


class FlyingVehicle(Vehicle):
    """A vehicle that arms, takes off, lands and publishes telemetry."""

    def __init__(self, link, *, root=None, autopilot: int = common.MavAutopilot.PX4) -> None:
        super().__init__(link, autopilot=autopilot)
        self.parameters.add("MIS_TAKEOFF_ALT", 2.5, minimum=0.0, maximum=80.0)
        self.parameters.add("GAIN", -0.123)
        self.parameters.add("LARGE", (1 << 31) - 1 if self.is_bytewise else 1 << 23)
        self.parameters.add("NEGATIVE", -7, common.MavParamType.INT32)
        if root is not None:
            self._host.engine.remove(self.ftp)
            self.ftp = self.serve(FtpServer(self.address, DirectoryStore(root)))
        self.landed: int = common.MavLandedState.ON_GROUND
        self.takeoffs: list[CommandRequest] = []
        self._heartbeat.base_mode = common.MavModeFlag.CUSTOM_MODE_ENABLED
        self.on_command(common.MavCmd.COMPONENT_ARM_DISARM)(self._arm)
        self.on_command(common.MavCmd.NAV_TAKEOFF)(self._take_off)
        self.on_command(common.MavCmd.NAV_LAND)(self._land)
        self.on_command(common.MavCmd.DO_SET_HOME)(lambda request: RESULT.ACCEPTED)
        self.on_command(common.MavCmd.PREFLIGHT_CALIBRATION)(self._calibrate)
        self.mission.answer_commands(self.commands.server, self._host.engine.touch)
        version = AutopilotVersion(capabilities=self.capabilities, flight=FirmwareVersion(1, 16))
        provide_versions(self.message_server, version)
        for message, produce in telemetry(self).items():
            self.publish(message, produce, interval=0.2)

    @property
    def is_bytewise(self) -> bool:
        return self.parameters.encoding is Encoding.BYTEWISE

    @property
    def capabilities(self) -> int:
        encoding = CAN.PARAM_ENCODE_BYTEWISE if self.is_bytewise else CAN.PARAM_ENCODE_C_CAST
        return CAN.MAVLINK2 | CAN.MISSION_INT | CAN.COMMAND_INT | CAN.FTP | encoding

    @property
    def is_armed(self) -> bool:
        return bool(self._heartbeat.base_mode & common.MavModeFlag.SAFETY_ARMED)

    def _arm(self, request: CommandRequest) -> int:
        arm = request.command.param1 == 1
        if not arm and self.landed == common.MavLandedState.IN_AIR:
            return RESULT.DENIED
        self._heartbeat.base_mode = ARMED if arm else common.MavModeFlag.CUSTOM_MODE_ENABLED
        self._heartbeat.send_now(self.now())
        self.wake(self._heartbeat)
        return RESULT.ACCEPTED

    def _take_off(self, request: CommandRequest) -> int:
        if not self.is_armed:
            return RESULT.TEMPORARILY_REJECTED
        self.takeoffs.append(request)
        self.landed = common.MavLandedState.IN_AIR
        return RESULT.ACCEPTED

    def _land(self, request: CommandRequest) -> int:
        self.landed = common.MavLandedState.ON_GROUND
        return RESULT.ACCEPTED

    async def _calibrate(self, request: CommandRequest) -> int:
        self.commands.progress(request, 50)
        return RESULT.ACCEPTED


def telemetry(vehicle: FlyingVehicle) -> dict:
    """Return the producer of each telemetry message."""
    place = {"lat": round(LATITUDE * 1e7), "lon": round(LONGITUDE * 1e7)}
    return {
        common.GlobalPositionInt: lambda now: common.GlobalPositionInt(
            **place, alt=488_500, relative_alt=12_250, vx=150, vy=-250, vz=-50, hdg=9_000
        ),
        common.Attitude: lambda now: common.Attitude(roll=0.1, pitch=-0.2, yaw=1.5),
        common.SysStatus: lambda now: common.SysStatus(
            onboard_control_sensors_present=HEALTHY,
            onboard_control_sensors_enabled=HEALTHY,
            onboard_control_sensors_health=HEALTHY,
            voltage_battery=12_400,
            current_battery=1_500,
            battery_remaining=87,
        ),
        common.BatteryStatus: lambda now: common.BatteryStatus(
            id=0, voltages=[4_150, 4_150, 4_100] + [0xFFFF] * 7, current_battery=1_500, battery_remaining=87
        ),
        common.GpsRawInt: lambda now: common.GpsRawInt(
            **place, fix_type=common.GpsFixType.RTK_FIXED, alt=488_500, eph=80, epv=120, satellites_visible=14
        ),
        common.HomePosition: lambda now: common.HomePosition(
            latitude=place["lat"], longitude=place["lon"], altitude=476_250
        ),
        common.ExtendedSysState: lambda now: common.ExtendedSysState(landed_state=vehicle.landed),
        common.VfrHud: lambda now: common.VfrHud(airspeed=5.0, groundspeed=4.5, throttle=40, climb=0.5),
        common.RcChannels: lambda now: common.RcChannels(chancount=8, chan1_raw=1_500, rssi=80),
    }


@asynccontextmanager
async def vehicle_on_udp(**options):
    """Yield a vehicle on a UDP server link, and its port."""
    link = open_link("udpin://127.0.0.1:0")
    async with FlyingVehicle(link, **options) as vehicle:
        yield vehicle, link.address[1]
