"""The driver that runs an engine over links with asyncio: the only module with an event loop and a clock.

One task per link reads the link's events; a thread of the core may read the socket of a link and leave out
the packets that are not wanted (see `native_input`). One timer wakes the engine for its next deadline. Timers
are not re-armed for later deadlines, since nearly every packet postpones a deadline; the engine may be woken
too early, never too late. The clock is the Unix time at which the driver was created, advanced by the loop's
own clock: it never decreases, and with a loop in virtual time it is virtual too.

A driver that stops cancels all operations. It goes on receiving for a moment while clients release what their
remote components keep for them, such as open files: the request or its answer may be lost.

Exceptions of the program's own functions (handlers, producers, progress callbacks) are reported to the loop's
exception handler; everything else continues.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from functools import partial
from time import time
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.errors import InvalidStateError, LinkClosedError, LinkError, RemoteCancelled
from mavstack.links import BytesReceived, Channel, ChannelClosed, ChannelOpened, Link, LinkDown
from mavstack.node.native_input import NativeInput, is_possible
from mavstack.services import Client, Operation, OperationEnded, Progress

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from mavstack.links import LinkEvent
    from mavstack.links.settings import Version
    from mavstack.node.channel_state import ChannelState
    from mavstack.node.engine import Engine
    from mavstack.node.host import NodeHost
    from mavstack.node.native_runs import Run
    from mavstack.services import Service
    from mavstack.wire import Packet

Result = TypeVar("Result")

#: Seconds for which a driver that stops waits until clients have released state of remote components.
RELEASE_TIMEOUT = 1.5


class Driver:
    """The tasks and the timer that run one engine; exists while its node is open."""

    def __init__(
        self,
        engine: Engine,
        *,
        on_packet: Callable[[Packet], None],
        on_event: Callable[[object, Service | None], None],
        on_channel: Callable[[ChannelState, Link], None],
        sent_listeners: Sequence[Callable[[bytes], None]] = (),
        version: Version = 2,
        on_error: Callable[[Operation[Any], float], None] = lambda operation, started_at: None,
        host: NodeHost | None = None,
    ) -> None:
        self.engine = engine
        self.channels: dict[Channel, ChannelState] = {}
        self._on_packet = on_packet
        self._on_event = on_event
        self._on_channel = on_channel
        self._sent_listeners = sent_listeners
        self._version = version
        self._on_error = on_error
        self._loop = asyncio.get_running_loop()
        engine.on_failure = self._on_failure
        self._time = self._loop.time
        self._epoch = time() - self._time()
        self._by_state: dict[ChannelState, Channel] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._timer: asyncio.TimerHandle | None = None
        self._links: set[Link] = set()
        self._steps_soon = False
        self._receiving = True
        self._stopped = False
        self._waiting: dict[Operation[Any], asyncio.Future[None]] = {}
        self._progress: dict[Operation[Any], Callable[[int, int], None]] = {}
        #: Clients that may have state of their remote components to release.
        self._releasing: set[Client] = set()
        self._operation_ended = asyncio.Event()
        #: The thread that reads links; None: the event loop reads all links.
        self.native: NativeInput | None = None
        if host is not None and is_possible(self._loop):
            self.native = NativeInput(host, self._deliver_attached, self.step, self.now)

    def now(self) -> float:
        """Return the Unix time in seconds; it never decreases."""
        return self._epoch + self._time()

    def read(self, link: Link) -> None:
        """Start the task that reads the events of an open link until the link ends."""
        task = self._loop.create_task(self._read(link))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def run(
        self,
        client: Client,
        operation: Operation[Result],
        progress: Callable[[int, int], None] | None = None,
    ) -> Result:
        """Start an operation and wait for its result; a cancelled task cancels it on both ends."""
        client.begin(operation, self.now())
        return await self.finish(client, operation, progress)

    async def finish(
        self,
        client: Client,
        operation: Operation[Result],
        progress: Callable[[int, int], None] | None = None,
    ) -> Result:
        """Wait for the result of an operation that was just started.

        If the node closes in the turn of the loop in which the operation ends, the call is cancelled too: a
        call of several operations could not begin the next one.
        """
        started_at = self.now()
        self._waiting[operation] = future = self._loop.create_future()
        if progress is not None:
            self._progress[operation] = progress
        self.engine.touch(client)
        self.step()
        try:
            await future
        except asyncio.CancelledError:
            client.cancel(operation, self.now())
            self.engine.touch(client)
            self.step()
            raise
        finally:
            self._waiting.pop(operation, None)
            self._progress.pop(operation, None)
            if client.is_releasing:
                self._releasing.add(client)
        if not self._receiving and not isinstance(operation.error, RemoteCancelled):
            answer, attempts = "the node was closed", operation.attempts
            raise RemoteCancelled(
                operation.description, str(operation.target), attempts=attempts, answer=answer
            )
        if operation.error is not None:
            self._on_error(operation, started_at)
        return operation.result()

    def step(self) -> None:
        """Write the engine's data, deliver its events, and set the timer."""
        if self.engine.idle or self._stopped:
            return
        if self._waiting:
            self.hurry()
        now = self.now()
        while True:
            self.write(self.engine.data_to_send(now))
            events = self.engine.events()
            if not events:
                break
            for service, event in events:
                self._deliver(event, service)
        self._set_timer()

    def step_soon(self) -> None:
        """Call `step` at the end of this turn of the event loop: what is sent in one turn leaves together."""
        if not self._steps_soon:
            self._steps_soon = True
            self._loop.call_soon(self._end_turn)

    def _end_turn(self) -> None:
        self._steps_soon = False
        self.hurry()
        self.step()

    def hurry(self) -> None:
        """Receive packets without delay for a moment, because an answer is awaited."""
        if self.native is not None:
            self.native.hurry()

    def stop_receiving(self) -> None:
        """Report no packet to the program from now on; a batch of datagrams may be under way."""
        self._receiving = False

    async def stop(self) -> None:
        """Cancel running operations, and stop reading. Afterwards nothing is sent, and no timer runs."""
        self.stop_receiving()
        for operation in tuple(self._waiting):
            operation.client.cancel(operation, self.now())
            self.engine.touch(operation.client)
            self._releasing.add(operation.client)
        self.step()
        await self._release()
        self._stopped = True
        if self._timer is not None:
            self._timer.cancel()
        if self.native is not None:
            self.native.stop()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _release(self) -> None:
        """Wait until the clients have released the state of their remote components, for a moment."""
        with suppress(TimeoutError):
            async with asyncio.timeout(RELEASE_TIMEOUT):
                while self._is_releasing():
                    self._operation_ended.clear()
                    await self._operation_ended.wait()
        self._releasing.clear()

    def _is_releasing(self) -> bool:
        return any(client.is_releasing for client in self._releasing)

    def _deliver(self, event: object, service: Service) -> None:
        match event:
            case OperationEnded(operation):
                self._operation_ended.set()
                future = self._waiting.get(operation)
                if future is not None and not future.done():
                    future.set_result(None)
            case Progress(operation, done, total):
                report = self._progress.get(operation)
                if report is not None:
                    self._call_safely(f"the progress callback of {operation}", report, done, total)
        self._on_event(event, service)

    def _call_safely(self, description: str, function: Callable[..., None], *arguments: object) -> None:
        try:
            function(*arguments)
        except Exception as error:  # noqa: BLE001 (a defect of the program must not stop the link)
            self._report(description, error)

    def _on_failure(self, service: Service, error: Exception) -> None:
        self._report(f"a function called by {type(service).__name__}", error)

    def _report(self, description: str, error: Exception) -> None:
        self._loop.call_exception_handler({"message": f"{description} failed", "exception": error})

    def write(self, outgoing: Sequence[tuple[ChannelState, bytes]]) -> None:
        """Write data; what goes to one link leaves together, if the link can send it so."""
        if self._stopped or not outgoing:
            return
        if len(outgoing) == 1:
            self._write(*outgoing[0])
            return
        for link in self._links:
            link.hold()
        try:
            for state, data in outgoing:
                self._write(state, data)
        finally:
            for link in self._links:
                link.release()

    def _write(self, state: ChannelState, data: bytes) -> None:
        channel = self._by_state.get(state)
        if channel is not None and not channel.closed:
            try:
                channel.write(data)
            except LinkClosedError:
                return  # the link reports the loss with ChannelClosed
            for listener in self._sent_listeners:
                listener(data)

    async def _read(self, link: Link) -> None:
        link.authenticates = self._authenticates
        try:
            if self.native is not None:
                self.native.add(link)
            self._links.add(link)
            await link.read(partial(self._handle_events, link))
        except (InvalidStateError, LinkError) as error:
            self._on_event(LinkDown(str(error), float("inf")), None)
        finally:
            self._links.discard(link)

    def _authenticates(self, data: bytes) -> bool:
        return self.engine.signing_states.authenticates(data, self.engine.dialect, self.now())

    def _handle_events(self, link: Link, events: Iterable[LinkEvent]) -> None:
        if not self._receiving and not self._is_releasing():
            return
        for event in events:
            try:
                if type(event) is BytesReceived:
                    self._receive(event)
                else:
                    self._handle(link, event)
            except Exception as error:  # noqa: BLE001 (a defect of the program must not stop the link)
                self._report(f"handling an event of {link.url}", error)
        if self.native is not None:
            self.native.settle()
        self.step()

    def _deliver_attached(self, run: Run) -> None:
        """Handle packets that the core received on a channel."""
        if not self._receiving and not self._is_releasing():
            return
        if data := run.outdated_bytes():
            self._call_safely(
                f"handling packets of {run.attached.channel.name}", self._receive_again, run, data
            )
            return
        accepted: list[Packet] = []
        if run.packets:
            try:
                accepted = self.engine.handle(run.attached.state, run.packets, self.now())
            except Exception as error:  # noqa: BLE001 (as above)
                self._report(f"handling packets of {run.attached.channel.name}", error)
        if not self._receiving:
            return
        if not run.is_kept:
            for packet in accepted:
                self._call_safely("handling a packet", self._on_packet, packet)
        elif run.listened and self.native is not None:
            self.native.call_listeners(self._checked(run, accepted), self._report_listener)

    def _receive_again(self, run: Run, data: bytes) -> None:
        """Receive packets that came before a change of keys as the channel receives them now."""
        channel, state = run.attached.channel, run.attached.state
        if self._receive_whole(state, data):
            self._note_valid(channel, state, time())

    def _checked(self, run: Run, accepted: list[Packet]) -> list[Packet]:
        """Return the packets for listeners, after the checks of the engine where they are needed."""
        if run.is_checked:
            return run.listened
        handled, known = set(map(id, run.packets)), set(map(id, accepted))
        state, now = run.attached.state, self.now()
        return [
            packet
            for packet in run.listened
            if (id(packet) in known if id(packet) in handled else self.engine.handle(state, [packet], now))
        ]

    def _report_listener(self, error: Exception) -> None:
        self._report("a packet listener", error)

    def _receive(self, event: BytesReceived) -> None:
        channel = event.channel
        state = self.channels[channel]
        is_valid = None if self.native is None else self.native.feed(channel, event.data)
        if is_valid is None:
            is_valid = self._receive_whole(state, event.data)
        if is_valid:
            self._note_valid(channel, state, event.time)

    def _note_valid(self, channel: Channel, state: ChannelState, received_at: float) -> None:
        channel.last_valid = received_at
        channel.is_authenticated |= state.verifies

    def _receive_whole(self, state: ChannelState, data: bytes) -> bool:
        """Handle each packet of received bytes; return whether they prove a valid peer."""
        packets = self.engine.receive(state, data, self._epoch + self._time())
        is_valid = bool(packets) and state.proves_validity(packets)
        if self._receiving:
            for packet in packets:
                self._on_packet(packet)
        return is_valid

    def _handle(self, link: Link, event: LinkEvent) -> None:
        match event:
            case ChannelOpened(channel):
                state = self.engine.open_channel(
                    channel.name,
                    version=link.settings.version or self._version,
                    bandwidth=link.pace or None,
                    half_duplex=link.half_duplex,
                )
                self.channels[channel], self._by_state[state] = state, channel
                self._on_channel(state, link)
                if self.native is not None:
                    self.native.channel_opened(channel, state, link)
            case ChannelClosed(channel):
                if self.native is not None:
                    self.native.channel_closed(channel)
                state = self.channels.pop(channel)
                del self._by_state[state]
                self.engine.close_channel(state)
        self._on_event(event, None)

    def _set_timer(self) -> None:
        due = self.engine.next_timeout()
        timer = self._timer
        if timer is not None:
            if due is not None and due - self._epoch >= timer.when():
                return
            timer.cancel()
            self._timer = None
        if due is not None:
            self._timer = self._loop.call_at(due - self._epoch, self._on_timer)

    def _on_timer(self) -> None:
        self._timer = None
        self.engine.handle_timeout(self.now())
        self.step()
        self._set_timer()
