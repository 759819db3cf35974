"""The services of one simulated vehicle, created at each boot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.component import RemoteComponent
from mavstack.node.engine import Engine
from mavstack.node.parts import parts_of
from mavstack.services.command import CommandServer
from mavstack.services.ftp import FtpServer
from mavstack.services.heartbeat import Discovery, HeartbeatSender
from mavstack.services.log import LogServer
from mavstack.services.manual_control import ManualControlReceiver
from mavstack.services.message_request import MessageServer
from mavstack.services.mission import MissionServer, MissionServerOptions
from mavstack.services.modes import ModeChanged, ModeServer
from mavstack.services.parameters import ParameterWritten
from mavstack.services.ping import PingServer
from mavstack.services.serial_control import ShellServer
from mavstack.services.setpoints import SetpointReceiver
from mavstack.services.signing_setup import KeySettled, SigningSetupServer
from mavstack.services.statustext import StatustextSender
from mavstack.services.timesync import TimesyncServer
from mavstack.sim.autopilot.corrected_gps import CorrectedGps
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack._core import HasCoreDialect
    from mavstack.dialects import Message
    from mavstack.node.channel_state import ChannelState
    from mavstack.services import Address, Service
    from mavstack.services.mission import MissionItem, Plan
    from mavstack.services.modes import AvailableMode
    from mavstack.sim.port import Port
    from mavstack.sim.signing_keys import SigningKeys
    from mavstack.sim.vehicle import SimulatedVehicle


#: Seconds after which a vehicle repeats its request for an item of a plan.
_REQUEST_INTERVALS = {Firmware.ARDUPILOT: 1.0, Firmware.PX4: 0.25}


class Services:
    """The services on one vehicle's engine."""

    def __init__(self, vehicle: SimulatedVehicle, dialect: HasCoreDialect, keys: SigningKeys) -> None:
        self._vehicle = vehicle
        local, profile = vehicle.address, vehicle.profile
        self.engine = engine = Engine(local, dialect)
        engine.signing_states = keys.states
        autopilot = vehicle.firmware.mav_autopilot
        self.beacon = engine.add(HeartbeatSender(local, profile.mav_type(vehicle), autopilot))
        self.discovery = engine.add(Discovery(local))
        self.commands = engine.add(CommandServer(local))
        self.messages = engine.add(MessageServer(local, self.commands))
        self.texts = engine.add(StatustextSender(local))
        self.modes = engine.add(
            ModeServer(
                local,
                [mode.available for mode in profile.modes],
                profile.initial,
                autopilot=autopilot,
                may_enter=self._may_enter,
                refusal=profile.refusal,
            )
        )
        self.modes.register(self.commands)
        self.parameters = engine.add(vehicle.parameters.new_server(local, engine.touch))
        self.mission = engine.add(
            MissionServer(
                local,
                vehicle.plans,
                MissionServerOptions(
                    home_first=vehicle.firmware is Firmware.ARDUPILOT,
                    frames_of_locations=vehicle.firmware is Firmware.ARDUPILOT,
                    plain_requests=vehicle.firmware is Firmware.ARDUPILOT,
                    float_answers=True,
                    request_interval=_REQUEST_INTERVALS[vehicle.firmware],
                ),
                validate=self._validate,
                check=self._check,
                guided=profile.guided_items(vehicle),
            )
        )
        self.mission.answer_commands(self.commands, engine.touch)
        self.sticks = engine.add(ManualControlReceiver(local))
        self.setpoints = engine.add(SetpointReceiver(local))
        self.shell = engine.add(ShellServer(local))
        self.files = engine.add(
            FtpServer(local, vehicle.storage.files, is_authenticated=engine.routes.is_verified)
        )
        self.logs = engine.add(LogServer(local, vehicle.storage.logs))
        servers: list[Callable[[Address], Service]] = [PingServer, TimesyncServer]
        servers += [part.server for part in parts_of(RemoteComponent) if part.server is not None]
        for make in servers:
            engine.add(make(local))
        engine.add(CorrectedGps(local, vehicle.body))
        self.signing_setup = engine.add(SigningSetupServer(local, may_set=keys.refusal, as_autopilot=True))
        vehicle.on_event(KeySettled, keys.settled)
        vehicle.on_event(ModeChanged, self._mode_changed)
        vehicle.on_event(ParameterWritten, vehicle.parameters.written)

    def port_of(self, state: ChannelState) -> Port | None:
        """Return the port of a channel; None if it was closed meanwhile."""
        return next((port for port in self._vehicle.ports if port.state is state), None)

    def refresh_heartbeat(self) -> None:
        """Send HEARTBEAT immediately if its content has changed."""
        autopilot, beacon = self._vehicle.autopilot, self.beacon
        fields = (autopilot.base_mode, autopilot.mode.number, autopilot.system_status)
        if (beacon.base_mode, beacon.custom_mode, beacon.system_status) != fields:
            beacon.base_mode, beacon.custom_mode, beacon.system_status = fields
            beacon.send_now(self._vehicle.now)
            self.engine.touch(beacon)

    def refresh_type(self) -> None:
        """Send the next HEARTBEAT with the present MAV_TYPE."""
        self.beacon.type = self._vehicle.profile.mav_type(self._vehicle)

    def send(self, message: Message, target: Address | None = None) -> None:
        """Send a message, such as HOME_POSITION after a change of home; without a target to everybody."""
        self.engine.send(message, self._vehicle.now, target)

    def _validate(self, plan: Plan, source: Address) -> int:
        return self._vehicle.autopilot.mission.validate(plan, source)

    def _check(self, plan_type: int, seq: int, item: MissionItem) -> int:
        return self._vehicle.autopilot.mission.check(plan_type, seq, item)

    def _may_enter(self, mode: AvailableMode, source: Address) -> str | None:
        return self._vehicle.autopilot.may_enter(mode, source)

    def _mode_changed(self, event: ModeChanged) -> None:
        if event.source is not None:
            self._vehicle.autopilot.entered(event.mode.custom_mode, event.source)
