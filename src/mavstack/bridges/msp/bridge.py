"""The bridge between a flight controller that speaks MSP and MAVLink: the vehicle as a MAVLink component.

    async with FlightController("msp+serial:///dev/ttyACM0") as controller:
        async with MspBridge(controller, "udpout://127.0.0.1:14550") as bridge:
            await bridge.serve_forever()

The bridge is a node with the server sides of the services: heartbeat, parameters, modes, commands, messages
at requested rates, status texts, manual control, and missions for iNav. It polls the flight controller for
the values that the messages need (`poller`, `telemetry`). While the flight controller is silent, the bridge
sends no heartbeats, so that ground stations see the vehicle lost.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from typing import TYPE_CHECKING, Final, Self

from mavstack.bridges.msp.arming_reasons import reason_texts
from mavstack.bridges.msp.async_resource import AsyncResource
from mavstack.bridges.msp.commands import BridgedCommands
from mavstack.bridges.msp.controller_facts import read_facts
from mavstack.bridges.msp.heartbeat import ControllerHeartbeat
from mavstack.bridges.msp.missions import BridgedMissions
from mavstack.bridges.msp.modes import BridgedModes
from mavstack.bridges.msp.parameter_metadata import BridgedMetadata
from mavstack.bridges.msp.parameters import BridgedParameters
from mavstack.bridges.msp.pilot import Pilot
from mavstack.bridges.msp.poller import Poller
from mavstack.bridges.msp.rc_channels import RcChannels
from mavstack.bridges.msp.samples import Samples
from mavstack.bridges.msp.status import (
    ControllerStatus,
    base_mode,
    extended_state,
    sys_status,
    system_status,
)
from mavstack.bridges.msp.streams import Streams
from mavstack.bridges.msp.telemetry import StreamedMessage, TelemetryMessages
from mavstack.dialects import common
from mavstack.errors import InvalidStateError, LinkError, MspError, RemoteCancelled
from mavstack.links import ChannelOpened
from mavstack.msp.messages.status import InavStatus, StatusEx
from mavstack.node import Node
from mavstack.services import Address
from mavstack.services.manual_control import (
    ManualControlReceiver,
    ManualInputLost,
    ManualInputReceived,
    OverrideLost,
    OverrideReceived,
)
from mavstack.services.version import ProtocolVersion

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.bridges.msp.controller_facts import ControllerFacts
    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.links import Link
    from mavstack.msp.messages.base import MspMessage
    from mavstack.wire import Packet

DEFAULT_SYSTEM: Final = 1
#: Seconds after which the status texts with the reasons not to arm are sent again.
REASONS_INTERVAL: Final = 30.0
#: Seconds between two status polls: normally, and while the bridge sends RC channels.
STATUS_INTERVAL, CONTROL_STATUS_INTERVAL = 0.2, 0.1
#: Seconds between two AUTOPILOT_VERSION messages, and between two AVAILABLE_MODES messages for the current
#: mode: ground stations that connect later learn the firmware and the mode name from them.
IDENTITY_INTERVAL: Final = 5.0
#: Seconds after which the mode names are sent to a new peer.
GREETING_TIME: Final = 0.1
#: Seconds after which settings that could not be read are read again.
LOAD_RETRY: Final = 2.0
FAILURES: Final = (MspError, LinkError, RemoteCancelled, InvalidStateError)

logger = logging.getLogger("mavstack.bridges.msp")


class MspBridge(AsyncResource):
    """A flight controller as a MAVLink vehicle; an async context manager.

    Args:
        controller: The flight controller; open, and closed by its owner.
        links: URLs or links of MAVLink, on which the vehicle appears.
        system: The system id of the vehicle, 1 to 255.

    Raises:
        InvalidArgumentError: The system id is not in 1 to 255.
        LinkURLError: A URL is invalid.
    """

    def __init__(
        self, controller: FlightController, *links: str | Link, system: int = DEFAULT_SYSTEM
    ) -> None:
        self.controller = controller
        #: The MAVLink node that acts as the vehicle.
        self.node = Node(
            *links,
            system=system,
            component=common.MavComponent.AUTOPILOT1,
            type=common.MavType.QUADROTOR,
            autopilot=common.MavAutopilot.GENERIC,
            heartbeat=False,
        )
        self._status = ControllerStatus()
        self._facts: ControllerFacts | None = None
        self._samples = Samples()
        self._channels = RcChannels()
        self._tasks: list[asyncio.Task[None]] = []
        self._reasons: tuple[str, ...] = ()
        self._reasons_due = 0.0
        self._to_load = asyncio.Event()

    async def open(self) -> Self:
        """Ask the flight controller for its facts, then appear on the links.

        Returns:
            The bridge itself.

        Raises:
            MspTimeout: The flight controller does not answer.
            LinkError: A link cannot be opened, or is down.
        """
        facts = await read_facts(self.controller)
        status = await self.controller.get(self._status_message(facts))
        self._create_parts(facts)
        self._heartbeat.silent = True  # send no heartbeat until its fields are known
        await self.node.open()
        self._samples.booted_at = self.node.now()
        self._use_facts(facts)
        with suppress(*FAILURES):  # the mission is read again together with the settings
            await self._missions.load()  # a program may ask for the mission as soon as it connects
        self._on_message(status)
        self._heartbeat.silent = False
        works = (
            self._poller.run(),
            self._pilot.run(),
            self._parameters.run(),
            self._missions.run(),
            self._greet_channels(),
            self._identify(),
            self._follow_sticks(),
            self._load_for_ever(),
        )
        self._tasks = [asyncio.get_running_loop().create_task(work) for work in works]
        for task in self._tasks:
            task.add_done_callback(self._on_task_ended)
        await asyncio.sleep(0)  # the tasks subscribe before the first peer connects
        self._announce()
        return self

    async def close(self) -> None:
        """Disappear from the links; the flight controller stays open. Idempotent."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._tasks.clear()
        await self.node.close()

    async def serve_forever(self) -> None:
        """Wait until the task is cancelled."""
        await asyncio.gather(*self._tasks)

    async def save(self) -> None:
        """Save the settings and the mission, so that they are there after a restart.

        Raises:
            MspDenied: The flight controller refused, because it is armed.
            MspTimeout: It does not answer.
        """
        await self._missions.save()
        await self.controller.save()

    def _on_task_ended(self, task: asyncio.Task[None]) -> None:
        if not task.cancelled() and (error := task.exception()) is not None:
            self._on_silence()  # a lost vehicle is safer than outdated values
            context = {"message": "a part of the MSP bridge failed", "exception": error}
            asyncio.get_running_loop().call_exception_handler(context)

    # Parts

    def _create_parts(self, facts: ControllerFacts) -> None:
        node, controller = self.node, self.controller
        self._heartbeat = node.serve(
            ControllerHeartbeat(node.address, facts.mav_type, common.MavAutopilot.GENERIC)
        )
        self._streams = Streams(node, self._samples)
        self._pilot = Pilot(
            controller, self._channels, status=lambda: self._status, report=node.send_statustext, now=node.now
        )
        self._telemetry = TelemetryMessages(self._samples, self._channels, is_inav=facts.info.is_inav)
        self._modes = BridgedModes(node, self._pilot, facts)
        self._parameters = BridgedParameters(controller, node, node.send_statustext)
        self._missions = BridgedMissions(node, controller, self._samples, node.send_statustext)
        self._commands = BridgedCommands(
            node,
            controller,
            self._pilot,
            status=lambda: self._status,
            save=self.save,
            restarting=self._restart,
            report=node.send_statustext,
        )
        self._sticks = node.serve(ManualControlReceiver(node.address))
        self._poller = Poller(
            controller,
            self._intervals,
            on_message=self._on_message,
            on_silence=self._on_silence,
            on_contact=self._on_contact,
        )
        BridgedMetadata(node, controller.settings.definitions, lambda: node.now() - self._samples.booted_at)
        self._publish(facts)
        node.add_packet_listener(common.Heartbeat, self._on_heartbeat)

    def _publish(self, facts: ControllerFacts) -> None:
        status = self._status_message(facts)
        self._streams.add(
            (
                *self._telemetry.streamed(),
                *self._missions.streamed(),
                StreamedMessage(common.SysStatus, (status,), 1.0, self._sys_status),
                StreamedMessage(common.ExtendedSysState, (status,), 1.0, self._extended_state),
            )
        )
        for kind, interval in self._missions.polled().items():
            self._streams.poll(kind, interval)
        self.node.publish(common.SystemTime, self._system_time, interval=1.0)
        self.node.publish(common.AutopilotVersion, self._version)
        self.node.publish(common.ProtocolVersion, lambda _: ProtocolVersion().to_message())

    @staticmethod
    def _status_message(facts: ControllerFacts) -> type[MspMessage]:
        return InavStatus if facts.info.is_inav else StatusEx

    def _intervals(self) -> Mapping[type[MspMessage], float]:
        if self._facts is not None:
            interval = CONTROL_STATUS_INTERVAL if self._pilot.in_control else STATUS_INTERVAL
            self._streams.poll(self._status_message(self._facts), interval)
        return self._streams.intervals()

    def _use_facts(self, facts: ControllerFacts) -> None:
        self._facts = facts
        self._heartbeat.type = facts.mav_type
        self._pilot.set_facts(facts)
        self._modes.set_facts(facts, self.node.now())
        self._to_load.set()

    async def _load_for_ever(self) -> None:
        """Read settings and mission, now and after each restart of the flight controller."""
        while True:
            await self._to_load.wait()
            self._to_load.clear()
            facts = self._facts
            try:
                if facts is not None:
                    await self._parameters.load(facts)
                    await self._missions.load()
            except FAILURES as error:
                logger.warning("%s", error)
                await asyncio.sleep(LOAD_RETRY)
                self._to_load.set()

    # Contact with the flight controller

    def _on_silence(self) -> None:
        self._heartbeat.silent = True
        self._samples.clear()
        self.node.wake(self._heartbeat)

    async def _on_contact(self) -> None:
        """Take the facts of a flight controller that answers again: it may have restarted."""
        facts = await read_facts(self.controller)
        self._samples.booted_at = self.node.now()
        self._use_facts(facts)
        self._heartbeat.silent = False
        self._announce()

    def _restart(self) -> None:
        self._poller.expect_restart()

    async def _greet_channels(self) -> None:
        """Tell each new peer at once what the vehicle is, and its modes as soon as the peer knows it."""
        async with self.node.events(ChannelOpened) as events:
            async for _ in events:
                self._announce()
                await asyncio.sleep(GREETING_TIME)
                events.drain()
                self._modes.announce()

    async def _identify(self) -> None:
        """Tell from time to time what the firmware is, and the name of its mode, for ever."""
        while True:
            await asyncio.sleep(IDENTITY_INTERVAL)
            if not self._heartbeat.silent and (version := self._version(self.node.now())) is not None:
                self.node.send(version)
                self.node.send(self._modes.current_message())

    def _announce(self) -> None:
        if not self._heartbeat.silent:
            now = self.node.now()
            self._heartbeat.send_now(now)
            self._heartbeat.handle_timeout(now)
            self.node.wake(self._heartbeat)
            if (version := self._version(now)) is not None:
                self.node.send(version)  # after the heartbeat, which makes the vehicle known
            self._reasons_due = now  # the new peer has not received the reasons

    # Status

    def _on_message(self, message: MspMessage) -> None:
        if self._facts is None:
            return
        status = ControllerStatus.read(message, self._facts.boxes)
        if status is not None:
            self._status = status
            self._refresh_heartbeat(status)
            self._report_reasons()
        self._missions.receive(message)
        self._streams.receive(message)

    def _refresh_heartbeat(self, status: ControllerStatus) -> None:
        mode, beacon = self._modes.update(status), self._heartbeat
        fields = (
            base_mode(status, mode.standard_mode, mode.custom_mode),
            mode.custom_mode,
            system_status(status),
        )
        if (beacon.base_mode, beacon.custom_mode, beacon.system_status) != fields:
            beacon.base_mode, beacon.custom_mode, beacon.system_status = fields
            beacon.send_now(self.node.now())
            self.node.wake(beacon)

    def _failed_checks(self) -> tuple[str, ...]:
        by_channels = self._pilot.is_possible and not self._pilot.in_control
        return self._status.failed_checks(by_channels=by_channels)

    def _report_reasons(self) -> None:
        """Send the reasons not to arm when they change, and again from time to time."""
        reasons, now = self._failed_checks(), self.node.now()
        if reasons == self._reasons and (not reasons or now < self._reasons_due):
            return
        self._reasons, self._reasons_due = reasons, now + REASONS_INTERVAL
        for text in reason_texts(reasons):
            self.node.send_statustext(text, common.MavSeverity.WARNING)

    # Messages

    def _sys_status(self) -> common.SysStatus:
        return sys_status(self._status, self._telemetry.power(), ready=not self._failed_checks())

    def _extended_state(self) -> common.ExtendedSysState:
        return extended_state(self._status)

    def _system_time(self, now: float) -> common.SystemTime | None:
        if self._heartbeat.silent:
            return None
        return common.SystemTime(time_boot_ms=int((now - self._samples.booted_at) * 1000) & 0xFFFFFFFF)

    def _version(self, _now: float) -> common.AutopilotVersion | None:
        """Return AUTOPILOT_VERSION; `now` is that of a producer."""
        return None if self._facts is None else self._facts.version().to_message()

    # Sticks

    def _on_heartbeat(self, packet: Packet) -> None:
        self._pilot.sign_of_life(Address(packet.system, packet.component))

    async def _follow_sticks(self) -> None:
        kinds = (ManualInputReceived, ManualInputLost, OverrideReceived, OverrideLost)
        async with self.node.events(*kinds, of=self._sticks) as events:
            async for event in events:
                match event:
                    case ManualInputReceived(source, sticks):
                        self._pilot.move_sticks(source, sticks)
                    case OverrideReceived(source, channels):
                        self._pilot.override(source, dict(channels))
                    case ManualInputLost(source) | OverrideLost(source):
                        self._pilot.end_manual(source)
