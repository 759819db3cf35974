"""The blocking API has the calls, results and errors of the async API, over real sockets."""

from __future__ import annotations

import asyncio
from queue import Queue
from threading import Event, Thread

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, LinkURLError, MavstackError, RemoteTimeout
from mavstack.services.events import LogLevel
from mavstack.sync import Node
from tests.interrupts import interrupt_main_thread, keyboard_interrupts

QUADROTOR, PX4 = common.MavType.QUADROTOR, common.MavAutopilot.PX4


@pytest.fixture
def vehicle():
    url = "udpin://127.0.0.1:0?trust_senders=yes"
    with Node(url, system=1, component=1, type=QUADROTOR, autopilot=PX4) as node:
        yield node


def url_of(vehicle: Node) -> str:
    host, port = vehicle.links[0].address
    return f"udpout://{host}:{port}"


def test_a_script_commands_and_receives(vehicle: Node) -> None:
    @vehicle.on_command(common.MavCmd.DO_SET_SERVO)
    def servo(request) -> common.MavResult:
        return common.MavResult.ACCEPTED if request.command.param1 == 5 else common.MavResult.DENIED

    with Node(url_of(vehicle)) as ground:
        found = ground.wait_for_autopilot(timeout=10)
        assert found.address == (1, 1)
        assert found.info.type == QUADROTOR
        assert found.command(common.MavCmd.DO_SET_SERVO, 5).result == common.MavResult.ACCEPTED
        with pytest.raises(CommandDenied, match="DENIED"):
            found.command(common.MavCmd.DO_SET_SERVO, 6)
        with ground.stream(common.Attitude) as attitudes:
            for number in range(3):
                vehicle.send(common.Attitude(time_boot_ms=number))
            received = [next(attitudes).time_boot_ms for _ in range(3)]
        assert received == [0, 1, 2]
        assert list(attitudes) == []
        assert (1, 1) in ground.components


def test_errors_are_those_of_the_async_api() -> None:
    with pytest.raises(LinkURLError):
        Node("nonsense")
    with Node("udpin://127.0.0.1:0") as unconnected:
        with pytest.raises(RemoteTimeout, match="waiting for an autopilot on"):
            unconnected.wait_for_autopilot(timeout=0.01)
        with pytest.raises(AttributeError):
            unconnected.no_such_name  # noqa: B018
    unconnected.close()
    with pytest.raises(MavstackError, match="closed"):
        unconnected.send(common.Heartbeat())


def test_a_handler_calls_its_own_node(vehicle: Node) -> None:
    @vehicle.on_command(common.MavCmd.DO_SET_SERVO)
    def servo(request) -> common.MavResult:
        station = vehicle.component(*request.source)
        station.ping(timeout=10)
        return common.MavResult.ACCEPTED

    with Node(url_of(vehicle)) as ground:
        assert ground.wait_for_autopilot(timeout=10).command(common.MavCmd.DO_SET_SERVO).result == 0


def test_a_handler_that_returns_none_ends_its_command_later(vehicle: Node) -> None:
    returned = Event()

    @vehicle.on_command(common.MavCmd.DO_WINCH)
    def winch(request) -> None:
        Thread(target=finish, args=[request]).start()

    def finish(request) -> None:
        assert returned.wait(10)
        vehicle.commands.server.complete(request, common.MavResult.DENIED)

    with Node(url_of(vehicle)) as ground:
        remote = ground.wait_for_autopilot(timeout=10)
        returned.set()
        with pytest.raises(CommandDenied, match="DENIED"):
            remote.command(common.MavCmd.DO_WINCH, timeout=10)


def test_a_blocking_call_in_a_listener_is_an_error(vehicle: Node) -> None:
    caught: Queue[str] = Queue()

    def call(_message) -> None:
        try:
            vehicle.wait_for_autopilot(timeout=0.01)
        except MavstackError as error:
            caught.put(str(error))

    vehicle.add_listener(common.Heartbeat, call)
    with Node(url_of(vehicle)):
        assert "a callback would wait for its own thread" in caught.get(timeout=10)


@pytest.mark.flight
def test_events_by_iteration_and_by_a_listener(vehicle: Node) -> None:
    heard: Queue[int] = Queue()
    with Node(url_of(vehicle)) as ground:
        remote = ground.wait_for_autopilot(timeout=10)
        listener = remote.add_event_listener(lambda event: heard.put(event.id))
        with remote.events(severity=LogLevel.WARNING) as events:
            for number, levels in ((1, 0x66), (2, 0x64)):
                vehicle.send(common.Event(id=number, sequence=number, log_levels=levels))
            event = next(events)
        assert (event.id, event.severity, events.lost) == (2, LogLevel.WARNING, 0)
        assert [heard.get(timeout=10) for _ in range(2)] == [1, 2]
        listener.close()


def test_ctrl_c_cancels_the_operation_on_both_ends(vehicle: Node) -> None:
    stopped = Event()

    @vehicle.on_command(common.MavCmd.DO_WINCH)
    async def winch(_request) -> common.MavResult:
        interrupt_main_thread()  # while the script waits for the answer
        try:
            await asyncio.Event().wait()
        finally:
            stopped.set()
        return common.MavResult.ACCEPTED

    with Node(url_of(vehicle)) as ground:
        found = ground.wait_for_autopilot(timeout=10)
        with keyboard_interrupts(), pytest.raises(KeyboardInterrupt):
            found.command(common.MavCmd.DO_WINCH)
        assert stopped.wait(10)
