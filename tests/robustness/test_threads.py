"""Blocking programs: concurrent calls of several threads, closing during a call, and Ctrl-C in any call."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from threading import Event, Thread, Timer

import pytest

from mavstack.dialects import common
from mavstack.errors import MavstackError, RemoteCancelled
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.services.parameters import ParameterClient
from mavstack.services.ping import PingClient
from mavstack.sync import Node
from tests.interrupts import interrupt_main_thread, keyboard_interrupts

QUADROTOR, PX4 = common.MavType.QUADROTOR, common.MavAutopilot.PX4


@pytest.fixture
def vehicle():
    with Node("udpin://127.0.0.1:0", system=1, component=1, type=QUADROTOR, autopilot=PX4) as node:
        yield node


@pytest.fixture
def ground(vehicle: Node):
    host, port = vehicle.links[0].address
    with Node(f"udpout://{host}:{port}") as node:
        yield node


def test_threads_call_concurrently(vehicle: Node, ground: Node) -> None:
    vehicle.on_command(common.MavCmd.DO_SET_SERVO)(lambda request: common.MavResult.ACCEPTED)
    vehicle.on_command(common.MavCmd.DO_SET_RELAY)(lambda request: common.MavResult.ACCEPTED)
    found = ground.wait_for_autopilot(timeout=10)

    def work(number: int) -> int:
        command = common.MavCmd.DO_SET_SERVO if number % 2 else common.MavCmd.DO_SET_RELAY
        assert ground.components
        return found.command(command, number).result

    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(work, range(100))) == {common.MavResult.ACCEPTED}


@pytest.mark.parametrize("call", ["serve_forever", "next", "command", "wait_for_autopilot"])
def test_a_blocking_call_ends_when_another_thread_closes_the_node(call: str) -> None:
    node = Node("udpin://127.0.0.1:0").open()
    began, outcome = Event(), []
    messages = node.stream(common.Attitude)
    calls = {
        "serve_forever": node.serve_forever,
        "next": lambda: next(messages, None),
        "command": lambda: node.component(1).command(common.MavCmd.NAV_LAND),
        "wait_for_autopilot": node.wait_for_autopilot,
    }

    def work() -> None:
        began.set()
        try:
            outcome.append(calls[call]())
        except MavstackError as error:
            outcome.append(error)

    thread = Thread(target=work, daemon=True)
    thread.start()
    began.wait(10)
    Timer(0.05, node.close).start()
    thread.join(20)
    assert not thread.is_alive()
    assert len(outcome) == 1


def call_forever(node: Node, errors: list[str]) -> None:
    try:
        while True:
            len(node.components)
    except MavstackError as error:
        errors.append(str(error))


def test_a_call_during_the_close_by_another_thread_never_hangs() -> None:
    for _ in range(20):
        node = Node("udpin://127.0.0.1:0").open()
        errors: list[str] = []
        threads = [Thread(target=call_forever, args=(node, errors), daemon=True) for _ in range(3)]
        for thread in threads:
            thread.start()
        node.close()
        for thread in threads:
            thread.join(20)
            assert not thread.is_alive()
        assert ["closed" in error for error in errors] == [True] * 3


def test_a_subscription_is_closed_from_another_thread(ground: Node) -> None:
    messages = ground.stream(common.Attitude)
    Timer(0.05, messages.close).start()
    assert list(messages) == []


def test_several_threads_read_one_subscription(vehicle: Node, ground: Node) -> None:
    ground.wait_for_autopilot(timeout=10)
    messages = ground.stream(common.Attitude)
    with ThreadPoolExecutor(3) as pool:
        answers = [pool.submit(next, messages) for _ in range(3)]
        for number in range(3):
            vehicle.send(common.Attitude(time_boot_ms=number))
        assert {answer.result(10).time_boot_ms for answer in answers} == {0, 1, 2}


def test_blocks_may_be_left_after_the_node_was_closed() -> None:
    with Node("udpin://127.0.0.1:0") as node, node.stream() as messages:
        node.close()
        with pytest.raises(MavstackError, match="the node is closed"):
            next(messages)


def test_mappings_are_copies(vehicle: Node, ground: Node) -> None:
    assert type(ground.wait_for_autopilot(timeout=10).params.cached) is dict


@pytest.mark.parametrize("call", ["next", "ping", "parameters", "wait_for_autopilot", "serve_forever"])
def test_the_node_is_usable_after_ctrl_c_in_any_call(vehicle: Node, ground: Node, call: str) -> None:
    found = ground.wait_for_autopilot(timeout=10)
    silent = ground.component(9)
    messages = ground.stream(common.Attitude)
    calls = {
        "next": lambda: next(messages),
        "ping": silent.ping,
        "parameters": silent.params.download,
        "wait_for_autopilot": lambda: ground.wait_for_autopilot(9),
        "serve_forever": ground.serve_forever,
    }
    interrupt_main_thread(after=0.1)
    with keyboard_interrupts(), pytest.raises(KeyboardInterrupt):
        calls[call]()  # type: ignore[operator]
    assert not silent._inner._clients.get(ParameterClient).busy
    assert not silent._inner._clients.get(PingClient).busy
    assert found.ping(1).received == 1


def test_an_interrupted_call_cleans_up_before_it_returns() -> None:
    portal, cleaned = BlockingPortal(), []

    async def work() -> None:
        try:
            await asyncio.sleep(100)
        finally:
            await asyncio.sleep(0.2)
            cleaned.append(True)

    interrupt_main_thread(after=0.1)
    with keyboard_interrupts(), pytest.raises(KeyboardInterrupt):
        portal.wait(work())
    assert cleaned
    portal.close()
    portal.close()


def test_a_cancelled_operation_raises_remote_cancelled() -> None:
    node = Node("udpin://127.0.0.1:0").open()
    Timer(0.1, node.close).start()
    with pytest.raises(RemoteCancelled):
        node.component(1).command(common.MavCmd.NAV_LAND)
