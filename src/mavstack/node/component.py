"""Another component, and what can be asked of it.

Each face (`parameters`, `mission`, `files` …) is made when it is first used, with the client state machine
behind it; several operations run at once, and those that the protocol forbids to overlap wait for each
other. Every call ends in its result or in a typed error of `mavstack.errors`, and a cancelled task leaves
the other end clean.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.node.control import ControlStream
from mavstack.node.extended_params import ExtendedParams
from mavstack.node.ftp import Ftp
from mavstack.node.logs import Logs
from mavstack.node.modes import Modes
from mavstack.node.params import Params
from mavstack.node.plans import Plans
from mavstack.node.shell import Shell
from mavstack.services.command import Command, CommandClient, CommandOperation
from mavstack.services.manual_control import ManualControlSender, OverrideSender
from mavstack.services.message_request import (
    GetMessageInterval,
    Interval,
    RequestMessage,
    SetMessageInterval,
)
from mavstack.services.mission import MissionClient, PlanType
from mavstack.services.ping import PingClient
from mavstack.services.serial_control import ShellClient
from mavstack.services.setpoints import SetpointStreamer
from mavstack.services.signing_setup import SigningSetupClient
from mavstack.services.timesync import TimesyncClient
from mavstack.services.version import RequestAutopilotVersion, RequestProtocolVersion

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.node.node import Node
    from mavstack.node.subscription import Subscription
    from mavstack.security import SigningKey
    from mavstack.services import Address
    from mavstack.services.command import CommandResult
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.manual_control import ChannelOverride, ManualInput
    from mavstack.services.message_request import RateSet
    from mavstack.services.ping import PingStatistics
    from mavstack.services.setpoints import Setpoint
    from mavstack.services.version import AutopilotVersion, ProtocolVersion

AnyMessage = TypeVar("AnyMessage", bound="Message")

#: For how long a component may be asked to take a key, and to prove that it did, in seconds.
SIGNING_LIMIT = 40.0


class RemoteComponent:
    """A component of another system; made by `Node.component`, `Node.wait_for_autopilot` or `Node.wait_for_component`."""

    def __init__(self, node: Node, address: Address) -> None:
        self.node = node
        self.address = address

    @property
    def info(self) -> ComponentInfo | None:
        """What its heartbeat said; None if it was never heard."""
        return self.node.components.get(self.address)

    def clear_cache(self) -> None:
        """It started anew: forget what it told before, which may be so no longer.

        What is under way goes on, and ends in its result or its error. Node calls this by itself.
        """
        for face in ("params", "extended_params", "modes"):
            if face in self.__dict__:
                self.__dict__[face].clear_cache()
        if "mission_client" in self.__dict__:
            self.mission_client.forget_progress()

    # Commands and messages

    async def command(
        self,
        command: int,
        *params: float,
        frame: int | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> CommandResult:
        """Send a MAV_CMD with up to seven parameters until it is answered.

        With a `frame` it goes as COMMAND_INT, params 5 and 6 in degrees or metres. Raises `CommandDenied` or
        `CommandTimeout`. `progress` is called with percent and 100 while a long command runs.
        """
        asked = CommandOperation(Command.of(command, params, frame), timeout=timeout)
        return await self.node.run_operation(self.command_client, asked, progress)

    async def request_message(
        self, message: type[AnyMessage], *params: float, timeout: float | None = None
    ) -> AnyMessage:
        """Ask for one message; `params` are params 2 to 6 of MAV_CMD_REQUEST_MESSAGE.

        Raises `CommandDenied` or `MessageTimeout`.
        """
        asked = RequestMessage(message, params, timeout=timeout)
        answer: AnyMessage = await self.node.run_operation(self.command_client, asked)
        return answer

    async def set_message_rate(
        self, message: type[Message] | int, rate: Interval | float, *, timeout: float | None = None
    ) -> RateSet:
        """Have it send a message so many times a second, or by an `Interval` (`DEFAULT`, `OFF`)."""
        wanted = rate if isinstance(rate, Interval) else Interval.hertz(rate)
        operation = SetMessageInterval(message, wanted, timeout=timeout)
        return await self.node.run_operation(self.command_client, operation)

    async def get_message_interval(
        self, message: type[Message] | int, *, timeout: float | None = None
    ) -> Interval:
        """At which interval it sends a message."""
        return await self.node.run_operation(self.command_client, GetMessageInterval(message, timeout=timeout))

    async def get_version(self, *, timeout: float | None = None) -> AutopilotVersion:
        """Its software, hardware and capabilities."""
        return await self.node.run_operation(self.command_client, RequestAutopilotVersion(timeout=timeout))

    async def get_protocol_version(self, *, timeout: float | None = None) -> ProtocolVersion:
        """Which versions of MAVLink it speaks."""
        return await self.node.run_operation(self.command_client, RequestProtocolVersion(timeout=timeout))

    async def ping(self, count: int = 4) -> PingStatistics:
        """How long messages take to it and back, in seconds."""
        client = self.ping_client
        return await self.node.driver.finish(client, client.ping(self.node.now(), count=count))

    def stream(self, *kinds: type[AnyMessage], queue: int = 1000) -> Subscription[AnyMessage]:
        """Its messages of these classes, as they come."""
        return self.node.stream(
            *kinds, system=self.address.system, component=self.address.component, queue=queue
        )

    def send(self, message: Message) -> None:
        """Send it a message whose target fields, if it has any, are filled in."""
        fields: dict[str, Any] = dict(zip(("target_system", "target_component"), self.address, strict=True))
        known = {name: value for name, value in fields.items() if name in message.__match_args__}
        self.node.send(message.replace(**known), self.address)

    # Parameters, files, logs, modes, keys

    @cached_property
    def params(self) -> Params:
        """Its parameters."""
        return Params(self)

    @cached_property
    def extended_params(self) -> ExtendedParams:
        """Its extended parameters, which cameras have."""
        return ExtendedParams(self)

    @cached_property
    def ftp(self) -> Ftp:
        """The files on it."""
        return Ftp(self)

    @cached_property
    def logs(self) -> Logs:
        """The logs on it."""
        return Logs(self)

    @cached_property
    def modes(self) -> Modes:
        """Its flight modes."""
        return Modes(self)

    async def setup_signing(self, key: SigningKey | None, *, timeout: float = SIGNING_LIMIT) -> None:
        """Give it a signing key, or none, and use the key with it once it is proven that it does too.

        Raises `RemoteDenied` or `RemoteTimeout`; then both sides go on as before.
        """
        client = self.signing_client
        operation = client.install(key, self.node.now(), timeout=timeout)
        await self.node.driver.finish(client, operation)

    # Steering

    def setpoints(self, rate: float = 20.0) -> ControlStream[Setpoint]:
        """Stream setpoints to it while a block lasts: what offboard and guided modes follow."""
        streamer = SetpointStreamer(self.node.address, self.address, rate)
        return ControlStream(self.node, streamer, streamer)

    def manual_control(self, rate: float = 20.0) -> ControlStream[ManualInput]:
        """Steer it by sticks while a block lasts."""
        sender = ManualControlSender(self.node.address, self.address, rate)
        return ControlStream(self.node, sender, sender)

    def override_channels(self, rate: float = 20.0) -> ControlStream[ChannelOverride]:
        """Override the channels of its radio control while a block lasts."""
        sender = OverrideSender(self.node.address, self.address, rate)
        return ControlStream(self.node, sender, sender)

    def shell(self) -> Shell:
        """Open its shell while a block lasts."""
        return Shell(self, ShellClient(self.node.address, self.address))

    # Plans

    @cached_property
    def mission(self) -> Plans:
        """What it is to fly."""
        return Plans(self, PlanType.MISSION)

    @cached_property
    def fence(self) -> Plans:
        """Where it must stay."""
        return Plans(self, PlanType.FENCE)

    @cached_property
    def rally(self) -> Plans:
        """Where it may land when it returns."""
        return Plans(self, PlanType.RALLY)

    # The state machines behind it all

    @cached_property
    def command_client(self) -> CommandClient:
        """The client that all its commands go through."""
        return self.node.serve(CommandClient(self.node.address, self.address))

    @cached_property
    def ping_client(self) -> PingClient:
        """The client that pings it."""
        return self.node.serve(PingClient(self.node.address, self.address))

    @cached_property
    def signing_client(self) -> SigningSetupClient:
        """The client that gives it keys."""
        return self.node.serve(SigningSetupClient(self.node.address, self.address))

    @cached_property
    def mission_client(self) -> MissionClient:
        """The client that all its plans go through."""
        ardupilot = self.info is not None and self.info.autopilot == common.MavAutopilot.ARDUPILOTMEGA
        return self.node.serve(MissionClient(self.node.address, self.address, home_first=ardupilot))

    @cached_property
    def clock(self) -> TimesyncClient:
        """Follows its clock from the first use on; `clock.estimate` is what is known."""
        return self.node.serve(TimesyncClient(self.node.address, self.address))

    def __repr__(self) -> str:
        return f"<RemoteComponent {self.address}>"
