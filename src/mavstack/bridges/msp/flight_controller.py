"""A flight controller with Betaflight or iNav, over MSP.

    async with FlightController("msp+serial:///dev/ttyACM0") as controller:
        print(controller.info.firmware, controller.info.version_text)
        attitude = await controller.get(Attitude)
        await controller.settings.set("BF_PID_ROLL_P", 50)
        await controller.save()

All calls share the line: one request is in flight at a time, those of a higher priority first.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Final, Self, TypeVar

from mavstack.bridges.msp.async_resource import AsyncResource
from mavstack.bridges.msp.cli_session import CliSession
from mavstack.bridges.msp.connection import MspConnection
from mavstack.bridges.msp.settings import ControllerSettings
from mavstack.errors import LinkError, MspDenied, MspFirmwareError, MspTimeout, RemoteCancelled
from mavstack.msp.firmware_info import BETAFLIGHT, FirmwareInfo
from mavstack.msp.messages.base import MspMessage
from mavstack.msp.messages.identification import (
    IDENTIFICATION,
    ApiVersion,
    FcVariant,
    FcVersion,
    firmware_info,
)
from mavstack.msp.requests import DEFAULT_RETRIES, Priority

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from mavstack.bridges.msp.connection import RawLine
    from mavstack.links import Link, LinkURL
    from mavstack.msp.frame import Frame, FrameVersion
    from mavstack.msp.requests import Request, RequestEngine

logger = logging.getLogger("mavstack.bridges.msp")

M = TypeVar("M", bound=MspMessage)

#: Major versions of the MSP API that are supported: 1 of Betaflight; 1 and 2 of iNav.
API_MAJORS: Final = {BETAFLIGHT: (1,)}
OTHER_API_MAJORS: Final = (1, 2)
_MSP_REBOOT, _MSP_SET_PASSTHROUGH, _MSP_EEPROM_WRITE = 68, 245, 250
_NO_ANSWER: Final = (
    "check the baud rate, and that the port of the controller has MSP and no other program uses it"
)
#: Seconds between the reboot request and the first attempt to reach the controller, and between attempts.
REBOOT_PAUSE: Final = 1.0
#: Seconds in which a controller that reboots must answer again.
REBOOT_TIMEOUT: Final = 30.0
#: Seconds for one reply to EEPROM_WRITE: the flash is erased first.
SAVE_TIMEOUT: Final = 5.0
#: The argument of MSP_SET_PASSTHROUGH for a serial port, and for the ESCs.
PASSTHROUGH_SERIAL, PASSTHROUGH_ESC = 0xFD, 0xFF


class FlightController(AsyncResource):
    """A client of one flight controller; an async context manager.

    Args:
        link: The link, or its URL; the controller opens and closes it.

    Attributes:
        info: The identity of the firmware, known after `open`.
        settings: The settings by their names.
    """

    def __init__(self, link: str | LinkURL | Link) -> None:
        self._connection = MspConnection(link)
        self.info = FirmwareInfo("")
        self.settings = ControllerSettings(self)

    @property
    def name(self) -> str:
        """The URL in error texts."""
        return self._connection.name

    @property
    def connected(self) -> bool:
        """True while the link has a channel."""
        return self._connection.connected

    @property
    def engine(self) -> RequestEngine:
        """The request engine, for its counters."""
        return self._connection.engine

    async def open(self) -> Self:
        """Open the link, and ask the controller what it is.

        Returns:
            The controller itself.

        Raises:
            LinkError: The link cannot be opened, or has no peer.
            MspTimeout: The controller does not answer.
            MspFirmwareError: The firmware has an interface that is not known.
        """
        await self._connection.open()
        try:
            await self.identify()
        except BaseException:
            await self.close()
            raise
        return self

    async def close(self) -> None:
        """End all requests, and close the link. Idempotent."""
        await self._connection.close()

    async def identify(self) -> FirmwareInfo:
        """Ask the controller what it is, and keep the answer in `info`.

        Returns:
            The identity.

        Raises:
            MspTimeout: The controller does not answer.
            MspFirmwareError: The firmware has an interface that is not known.
        """
        found: dict[type[MspMessage], MspMessage] = {}
        self.info = FirmwareInfo("")
        for kind in IDENTIFICATION:
            try:
                found[kind] = await self.get(kind, priority=Priority.CONTROL)
            except MspDenied:
                if kind in (ApiVersion, FcVariant, FcVersion):
                    raise
            except MspTimeout as error:
                if kind is not ApiVersion:
                    raise
                answer = f"no answer; {_NO_ANSWER}"
                raise MspTimeout(
                    "asking for the version of", self.name, attempts=error.attempts, answer=answer
                ) from None
            self.info = firmware_info(found)  # later messages are decoded with this information
        self._require_known_interface()
        logger.info("%s: %s %s", self.name, self.info.firmware, self.info.version_text)
        return self.info

    async def get(
        self,
        kind: type[M],
        argument: bytes | MspMessage = b"",
        *,
        priority: Priority = Priority.NORMAL,
        timeout: float | None = None,  # noqa: ASYNC109 (its typed error names the command)
    ) -> M:
        """Request a message.

        Args:
            kind: The class of the message.
            argument: The payload of the request, for commands that have one; empty: none.
            priority: Its place among the waiting requests.
            timeout: Seconds for the whole call; None: until all attempts have failed.

        Returns:
            The message.

        Raises:
            MspTimeout: No reply came in time.
            MspDenied: The firmware does not know the command, or its state forbids it.
            MspDecodeError: The reply does not have the layout of the message.
            LinkError: The link is down.
        """
        payload = argument.encode(self.info) if isinstance(argument, MspMessage) else argument
        reply = await self._connection.request(
            kind.COMMAND, payload, name=kind.NAME, priority=priority, timeout=timeout
        )
        return kind.decode(reply, self.info)

    async def send(
        self,
        message: MspMessage,
        *,
        priority: Priority = Priority.NORMAL,
        timeout: float | None = None,  # noqa: ASYNC109 (its typed error names the command)
    ) -> None:
        """Send a message, and wait until the firmware has accepted it.

        Args:
            message: The message.
            priority: Its place among the waiting requests.
            timeout: Seconds for the whole call; None: until all attempts have failed.

        Raises:
            MspTimeout: No reply came in time.
            MspDenied: The firmware refused the message.
            LinkError: The link is down.
        """
        await self._connection.request(
            message.COMMAND, message.encode(self.info), name=message.NAME, priority=priority, timeout=timeout
        )

    async def request(
        self,
        command: int,
        payload: bytes = b"",
        *,
        priority: Priority = Priority.NORMAL,
        timeout: float | None = None,  # noqa: ASYNC109 (its typed error names the command)
        retries: int = DEFAULT_RETRIES,
        version: FrameVersion | None = None,
    ) -> bytes:
        """Send any command, and wait for its reply.

        Args:
            command: Number of the command.
            payload: The bytes of the message.
            priority: Its place among the waiting requests.
            timeout: Seconds for the whole call; None: until all attempts have failed.
            retries: Further attempts after the first one.
            version: The encoding; None: v1, or v2 if v1 cannot carry the request.

        Returns:
            The payload of the reply.

        Raises:
            MspTimeout: No reply came in time.
            MspDenied: The firmware refused the request.
            LinkError: The link is down.
        """
        return await self._connection.request(
            command, payload, priority=priority, timeout=timeout, retries=retries, version=version
        )

    def on_unsolicited(self, callback: Callable[[Frame], None] | None) -> None:
        """Call a function with each frame that answers no request; None: none."""
        self._connection.on_unsolicited(callback)

    async def save(self) -> None:
        """Write all settings to the memory that survives a restart (MSP_EEPROM_WRITE).

        Raises:
            MspDenied: The firmware refused it, because it is armed.
            MspTimeout: No reply came in time.
        """
        await self._connection.request(
            _MSP_EEPROM_WRITE, name="MSP_EEPROM_WRITE", retries=0, reply_timeout=SAVE_TIMEOUT
        )

    async def reboot(self, *, timeout: float = REBOOT_TIMEOUT) -> None:  # noqa: ASYNC109 (typed error)
        """Restart the controller, and wait until it answers again.

        Args:
            timeout: Seconds for the restart.

        Raises:
            MspDenied: The firmware refused it.
            MspTimeout: The controller does not answer afterwards.
        """
        with suppress(MspTimeout, RemoteCancelled):  # some controllers restart before they reply
            await self._connection.request(_MSP_REBOOT, name="MSP_REBOOT", retries=0)
        await self.wait_for_restart(timeout)

    async def wait_for_restart(self, timeout: float = REBOOT_TIMEOUT) -> None:  # noqa: ASYNC109 (typed error)
        """Wait until a controller that restarts answers again.

        Args:
            timeout: Seconds to wait.

        Raises:
            MspTimeout: The controller does not answer in time.
        """
        try:
            async with asyncio.timeout(timeout):
                while True:
                    await asyncio.sleep(REBOOT_PAUSE)
                    with suppress(MspTimeout, LinkError, RemoteCancelled):
                        await self.identify()
                        return
        except TimeoutError:
            answer = f"no answer for {timeout:g} s"
            raise MspTimeout("restarting", self.name, answer=answer) from None

    @asynccontextmanager
    async def cli(self, *, restart: bool = True) -> AsyncIterator[CliSession]:
        """Open the command line interface; the controller restarts at the end of the block.

        Args:
            restart: Wait at the end until the controller answers again.

        Raises:
            MspTimeout: The CLI does not open, or the controller does not answer after the restart.
            InvalidStateError: The line is in use.
            LinkError: The link is down.
        """
        async with self._connection.exclusive("its CLI is open") as line:
            session = CliSession(line, self.name)
            await session.enter()
            try:
                yield session
            finally:
                await session.exit()
        if restart:
            await self.wait_for_restart()

    async def dump(self, scope: str = "diff all") -> str:
        """Return all settings as commands of the CLI; the controller restarts afterwards.

        Args:
            scope: `diff all`, `diff`, `dump all` or `dump`.

        Raises:
            MspTimeout: The controller does not answer in time.
            LinkError: The link is down.
        """
        async with self.cli() as session:
            return await session.dump(scope)

    async def restore(self, dump: str, progress: Callable[[int, int], None] | None = None) -> int:
        """Apply the commands of a dump and save them; the controller restarts.

        Args:
            dump: The text of a dump.
            progress: Called with the number of commands that were sent, and of all.

        Returns:
            The number of commands.

        Raises:
            MspDenied: Commands had errors; nothing was saved.
            MspTimeout: The controller does not answer in time.
            InvalidArgumentError: A line of the dump cannot be sent; nothing was sent.
            LinkError: The link is down.
        """
        async with self.cli() as session:
            return await session.restore(dump, progress)

    @asynccontextmanager
    async def passthrough(self, port: int | None = None) -> AsyncIterator[RawLine]:
        """Connect the line with another port of the controller, until the controller restarts.

        Args:
            port: Identifier of a serial port, as in the reply to `serial` of the CLI; None: the ESCs, by
                the 4-way interface.

        Raises:
            MspDenied: The controller has no such port or no ESCs, or does not support it.
            MspTimeout: No reply came in time.
            LinkError: The link is down.
        """
        payload = bytes([PASSTHROUGH_ESC, 0] if port is None else [PASSTHROUGH_SERIAL, port])
        connection, where = self._connection, "the ESCs" if port is None else f"serial port {port}"

        def request() -> Request:
            return connection.engine.request(_MSP_SET_PASSTHROUGH, payload, name="MSP_SET_PASSTHROUGH")

        async with connection.exclusive(f"its line is connected with {where}", request) as line:
            if not any(line.reply):
                raise MspDenied(f"connecting {where} of", self.name, answer="the controller has none")
            yield line

    def _require_known_interface(self) -> None:
        info = self.info
        if info.api[0] not in API_MAJORS.get(info.variant, OTHER_API_MAJORS):
            version = ".".join(map(str, info.api))
            answer = (
                f"{info.firmware} {info.version_text} has version {version} of MSP, which is not known here"
            )
            raise MspFirmwareError("connecting to", self.name, answer=answer)
