"""A scripted autopilot that refuses requests with a reason, accepts them without acting, or stops sending."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.links import Impairment, MemoryNetwork, impair
from mavstack.services import Service, message_ids
from mavstack.services.log import LogServer
from mavstack.services.modes import ModeServer, mode_names, mode_number, modes_of
from mavstack.services.statustext import chunks_of
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.node.vehicle import MODES
from tests.node.vehicle import Vehicle as VehicleWithAllServices

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from mavstack.dialects import Message
    from mavstack.vehicle import Connection, Vehicle

CMD, RESULT, SEVERITY = common.MavCmd, common.MavResult, common.MavSeverity
PX4, ARDUPILOT = common.MavAutopilot.PX4, common.MavAutopilot.ARDUPILOTMEGA
ARMED = common.MavModeFlag.SAFETY_ARMED | common.MavModeFlag.CUSTOM_MODE_ENABLED
#: Messages that every connection sends; tests ignore them.
BACKGROUND_MESSAGES = (
    common.Heartbeat,
    common.Ping,
    common.Timesync,
    common.MissionAck,
)
#: Commands that the autopilot accepts, and the modes that PX4 enters for some of them.
ACCEPTED = {
    CMD.COMPONENT_ARM_DISARM: None,
    CMD.NAV_TAKEOFF: "TAKEOFF",
    CMD.NAV_LAND: "LAND",
    CMD.NAV_RETURN_TO_LAUNCH: "RTL",
    CMD.DO_REPOSITION: "LOITER",
    CMD.DO_ORBIT: "ORBIT",
    CMD.DO_CHANGE_SPEED: None,
    CMD.DO_SET_HOME: None,
    CMD.CONDITION_YAW: None,
    CMD.DO_LAND_START: None,
    CMD.MISSION_START: None,
    CMD.PREFLIGHT_REBOOT_SHUTDOWN: None,
    CMD.RUN_PREARM_CHECKS: None,
    **dict.fromkeys(
        (
            *(CMD.IMAGE_START_CAPTURE, CMD.IMAGE_STOP_CAPTURE, CMD.VIDEO_START_CAPTURE),
            *(CMD.VIDEO_STOP_CAPTURE, CMD.VIDEO_START_STREAMING, CMD.VIDEO_STOP_STREAMING),
            *(CMD.SET_CAMERA_MODE, CMD.SET_CAMERA_ZOOM, CMD.SET_CAMERA_FOCUS, CMD.STORAGE_FORMAT),
            *(CMD.RESET_CAMERA_SETTINGS, CMD.CAMERA_TRACK_POINT, CMD.CAMERA_TRACK_RECTANGLE),
            *(CMD.CAMERA_STOP_TRACKING, CMD.DO_GIMBAL_MANAGER_CONFIGURE, CMD.DO_GIMBAL_MANAGER_PITCHYAW),
            *(CMD.DO_SET_ROI_LOCATION, CMD.DO_SET_ROI_SYSID, CMD.DO_SET_ROI_NONE),
        )
    ),
    CMD.PREFLIGHT_CALIBRATION: None,
    CMD.PREFLIGHT_STORAGE: None,
    ardupilotmega.MavCmd.DO_CANCEL_MAG_CAL: None,
    CMD.DO_VTOL_TRANSITION: None,
    CMD.DO_FLIGHTTERMINATION: None,
    CMD.DO_SET_SERVO: None,
    CMD.DO_SET_RELAY: None,
    CMD.DO_SET_ACTUATOR: None,
    CMD.DO_MOTOR_TEST: None,
    CMD.ACTUATOR_TEST: None,
    CMD.DO_GRIPPER: None,
    CMD.DO_WINCH: None,
    CMD.DO_SET_ROI_WPNEXT_OFFSET: None,
    ardupilotmega.MavCmd.SET_EKF_SOURCE_SET: None,
}
#: Requests other than commands that can be refused.
REQUEST_MESSAGES = (
    *(common.MissionCount, common.MissionRequestList, common.MissionClearAll, common.MissionSetCurrent),
    *(common.ParamSet, common.ParamRequestRead, common.ParamRequestList),
    *(common.FileTransferProtocol, common.LogRequestList, common.LogRequestData, common.LogErase),
)


class StatusTextOnRequest(Service):
    """Sends a status text when a request arrives, before another service answers that request."""

    handles = message_ids(*REQUEST_MESSAGES)

    def __init__(self, local) -> None:
        super().__init__(local)
        self.text = ""

    def receive(self, packet, now) -> None:
        if self.text:
            for chunk in chunks_of(self.text, SEVERITY.CRITICAL, 77):
                self.send(chunk)
            self.text = ""


class ScriptedAutopilot(VehicleWithAllServices):
    """A vehicle that stays at `altitude` and moves only if a test changes its position."""

    def __init__(self, *links, autopilot=PX4, kind=common.MavType.QUADROTOR) -> None:
        super().__init__(*links, autopilot=autopilot if autopilot in MODES else PX4)
        self._heartbeat.type, self._heartbeat.autopilot = kind, autopilot
        self.logs_server = next(each for each in self._host.engine._services if isinstance(each, LogServer))
        self._serve_modes(autopilot, kind)
        self.refused: dict[int, int] = {}
        self.on_refusal: Callable[[], None] = lambda: None
        self.executes = True  # False: it acknowledges commands and does nothing
        self.silent = False
        self.altitude, self.heading, self.speed = 20.0, 0.0, 0.0
        self.latitude, self.longitude = 47.397742, 8.545594
        self.landed = common.MavLandedState.IN_AIR
        self.ready = True
        self.received: list[Message] = []
        self.reports_home = True
        self._support_commands()
        self._publish_telemetry()
        self._answer_after_status_text()
        self.add_packet_listener(None, lambda packet: self.received.append(packet.message))
        self._discard_data_while_silent()
        if mode_number(autopilot, kind, "LOITER") is not None:
            self.enter("LOITER")

    # Called by tests

    def enter(self, mode: str) -> None:
        """Enter a mode."""
        number = mode_number(self._heartbeat.autopilot, self._heartbeat.type, mode)
        assert number is not None, mode
        self.modes._current = self.modes._named(number)
        self._show_mode(number)

    def land(self) -> None:
        """Stand on the ground from the next EXTENDED_SYS_STATE on."""
        self.landed = common.MavLandedState.ON_GROUND

    def arm(self, armed: bool = True) -> None:
        self._heartbeat.base_mode = ARMED if armed else common.MavModeFlag.CUSTOM_MODE_ENABLED
        self._send_heartbeat_now()

    def refuse(self, *commands: int, result: int = RESULT.DENIED) -> None:
        self.refused |= dict.fromkeys(map(int, commands), result)

    def refuse_plans(self, result: int) -> None:
        self.mission._validate = lambda plan, source: result

    def requests(self, *without: type[Message]) -> list[Message]:
        """Return the messages since `received` was cleared, without those that every connection sends."""
        ignored = BACKGROUND_MESSAGES + without
        return [message for message in self.received if not isinstance(message, ignored)]

    # Internals

    def _serve_modes(self, autopilot, kind) -> None:
        names = list(mode_names(autopilot, kind)) or MODES[PX4]
        self._host.engine.remove(self.modes)
        standard = {
            0x03040000: common.MavStandardMode.POSITION_HOLD,
            0x04040000: common.MavStandardMode.MISSION,
        }
        offered = modes_of(autopilot, kind, names, standard)
        self.modes = self.serve(ModeServer(self.address, offered, names[0], autopilot=autopilot))
        self.modes.register(self.commands.server)

    def _support_commands(self) -> None:
        server = self.commands.server
        for command, mode in ACCEPTED.items():
            server.support(command, lambda request, mode=mode: self._do(request, mode))
        self.mission.answer_commands(server, self._host.engine.touch)
        for command in server.supported:
            server.support(command, self._unless_refused(server.handler_of(command)))

    def _unless_refused(self, handler):
        def answer(request):
            result = self.refused.get(int(request.command.command))
            if result is None:
                return handler(request)
            self.on_refusal()
            return common.MavResult(result)

        return answer

    def _do(self, request, mode):
        if request.command.command == CMD.COMPONENT_ARM_DISARM and self.executes:
            self.arm(request.command.param1 == 1)
        if mode and self.executes and self._heartbeat.autopilot == PX4:
            self.enter(mode)
        return RESULT.ACCEPTED

    def _publish_telemetry(self) -> None:
        self.publish(common.GlobalPositionInt, self._position, interval=0.25)
        self.publish(
            common.ExtendedSysState,
            lambda now: common.ExtendedSysState(landed_state=self.landed),
            interval=0.5,
        )
        self.publish(common.SysStatus, self._status, interval=0.5)
        self.publish(common.HomePosition, self._home)
        self.publish(common.CameraSettings, lambda now: common.CameraSettings())

    def _position(self, now):
        return common.GlobalPositionInt(
            lat=round(self.latitude * 1e7),
            lon=round(self.longitude * 1e7),
            alt=round((self.altitude + 488) * 1000),
            relative_alt=round(self.altitude * 1000),
            vx=round(self.speed * 100),
            hdg=round(self.heading * 100),
        )

    def _status(self, now):
        check = common.MavSysStatusSensor.PREARM_CHECK
        health = check if self.ready else 0
        return common.SysStatus(
            onboard_control_sensors_present=check,
            onboard_control_sensors_enabled=check,
            onboard_control_sensors_health=health,
        )

    def _home(self, now):
        if not self.reports_home:
            return None
        return common.HomePosition(
            latitude=round(47.397742 * 1e7), longitude=round(8.545594 * 1e7), altitude=488_000
        )

    def _answer_after_status_text(self) -> None:
        services = tuple(self._host.engine._services)
        for service in services:
            self._host.engine.remove(service)
        self.status_text_on_request = StatusTextOnRequest(self.address)
        for service in (self.status_text_on_request, *services):
            self.serve(service)

    def _discard_data_while_silent(self) -> None:
        data_to_send = self._host.engine.data_to_send
        self._host.engine.data_to_send = lambda now: [data for data in data_to_send(now) if not self.silent]

    def _on_event(self, event, service=None) -> None:
        if type(event).__name__ == "ModeChanged":
            if self.executes:
                self._show_mode(self.modes.current.custom_mode)
            return
        super()._on_event(event, service)

    def _show_mode(self, number: int) -> None:
        self._heartbeat.custom_mode = number
        self._send_heartbeat_now()

    def _send_heartbeat_now(self) -> None:
        if self.is_open:
            self._heartbeat.send_now(self.now())
            self.wake(self._heartbeat)


@dataclass
class ScriptedHarness:
    """A scripted autopilot, and the connection and the vehicle of the program that uses it."""

    autopilot: ScriptedAutopilot
    connection: Connection
    vehicle: Vehicle
    packet_listeners: set = field(default_factory=set)

    @property
    def camera(self):
        return self.vehicle.component.camera

    @property
    def gimbal(self):
        return self.vehicle.gimbal

    def send_statustext(self, text: str, severity: int = SEVERITY.CRITICAL, after: float = 0.0) -> None:
        """Let the vehicle send a status text, now or after some seconds."""
        if after:
            asyncio.get_running_loop().call_later(after, self.autopilot.send_statustext, text, severity)
        else:
            self.autopilot.send_statustext(text, severity)

    def count_packet_listeners(self) -> None:
        """Start to count the packet listeners that are added."""
        packets = self.connection._host.packet_dispatch
        add, remove = packets.add, packets.remove
        self.packet_listeners = set()

        def add_counted(*args):
            listener = add(*args)
            self.packet_listeners.add(listener)
            return listener

        def remove_counted(listener):
            self.packet_listeners.discard(listener)
            remove(listener)

        packets.add, packets.remove = add_counted, remove_counted

    def open_resources(self) -> dict[str, int]:
        """Return the number of listeners, subscriptions, services and tasks."""
        host = self.connection._host
        return {
            "packet listeners": len(self.packet_listeners),
            "subscriptions": len(host.packet_dispatch._open),
            "event listeners": len(host.event_dispatch._open),
            "services": len(host.engine._services),
            "operations": len(host.driver._waiting),
            "tasks": len(asyncio.all_tasks()),
        }


@asynccontextmanager
async def scripted_harness(
    latency: float = 0.0, network: MemoryNetwork | None = None, *, armed: bool = True, **options
) -> AsyncIterator[ScriptedHarness]:
    """Run a scripted autopilot, armed and in the air, and a connection that has received its messages."""
    network = network or MemoryNetwork()
    link = impair(network.link(), Impairment(latency=latency)) if latency else network.link()
    async with ScriptedAutopilot(network.link(), **options) as autopilot, connect(link) as connection:
        autopilot.arm(armed)
        vehicle = await connection.wait_for_vehicle(1)
        vehicle.component.events().close()  # its receiver stays, as after the first call
        await asyncio.sleep(1.0 + 2 * latency)
        autopilot.received.clear()
        harness = ScriptedHarness(autopilot, connection, vehicle)
        harness.count_packet_listeners()
        yield harness


def run_scenario(scenario: Callable[[ScriptedHarness], Awaitable[None]], **options) -> None:
    """Run a scenario in virtual time."""

    async def run() -> None:
        async with scripted_harness(**options) as harness:
            await scenario(harness)

    run_virtually(run())
