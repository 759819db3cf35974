"""Robustness of a node against programs that fail, cancel and close at the worst moment, in virtual time."""

from __future__ import annotations

import asyncio
import contextlib
from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, MavstackError, RemoteCancelled, RemoteError
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services import Service, message_ids
from mavstack.services.manual_control import ManualInput
from mavstack.services.mission import MissionItem, PlanType
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import Vehicle, VehiclePair

if TYPE_CHECKING:
    from tests.seeds import Seeds

WAYPOINTS = [MissionItem(common.MavCmd.NAV_WAYPOINT, param5=n, param6=8, param7=9) for n in range(30)]


class ReportedErrors:
    """The errors that the loop's exception handler got."""

    def __init__(self) -> None:
        self.errors: list[str] = []
        asyncio.get_running_loop().set_exception_handler(self._add)

    def _add(self, _loop: object, context: dict[str, object]) -> None:
        self.errors.append(f"{context['message']}: {context.get('exception')!r}")


def fail(*_: object) -> None:
    raise ZeroDivisionError("a defect of the program")


class FailingService(Service):
    """A service whose every method fails."""

    handles = message_ids(common.Heartbeat)

    def receive(self, packet, now) -> None:
        fail()

    def next_timeout(self) -> float:
        return 1.0

    def handle_timeout(self, now) -> None:
        fail()

    def bulk_messages(self, now, has_room):
        fail()
        yield


def test_a_failing_service_stops_no_other_and_causes_no_busy_loop() -> None:
    async def work() -> int:
        reported = ReportedErrors()
        async with VehiclePair() as pair:
            pair.ground.serve(FailingService(pair.ground.address))
            await asyncio.sleep(30)
            assert (await pair.remote.ping()).received == 4
            assert (await pair.remote.get_version()).capabilities
        assert "FailingService" in reported.errors[0]
        return len(reported.errors)

    assert 30 < run_virtually(work()) < 1500


def test_a_failing_producer_is_reported_and_the_others_continue() -> None:
    async def work() -> None:
        reported = ReportedErrors()
        async with VehiclePair() as pair:
            pair.vehicle.publish(common.Attitude, fail, interval=0.1)
            pair.vehicle.publish(common.VfrHud, lambda _: common.VfrHud(), interval=0.1)
            async with pair.remote.stream(common.VfrHud) as messages:
                await asyncio.sleep(5)
                assert len(messages.drain()) > 40
            assert await pair.remote.modes.list()
        assert reported.errors
        assert all("MessageServer" in text and "ZeroDivisionError" in text for text in reported.errors)

    run_virtually(work())


def test_a_failing_progress_callback_is_reported_and_the_transfer_succeeds() -> None:
    async def work() -> None:
        reported = ReportedErrors()
        async with VehiclePair() as pair:
            assert len(await pair.remote.params.download(progress=fail)) == 40
            await pair.remote.mission.upload(WAYPOINTS, progress=fail)
            assert list((await pair.remote.mission.download(progress=fail)).items) == WAYPOINTS
        assert any("the progress callback of" in text for text in reported.errors)

    run_virtually(work())


@pytest.mark.parametrize("outcome", [None, "ok", True, 300, (0, "much"), (0, 1, 2)])
def test_an_async_handler_with_an_invalid_result_fails(outcome: object) -> None:
    async def work() -> None:
        reported = ReportedErrors()
        async with VehiclePair() as pair:

            @pair.vehicle.on_command(common.MavCmd.DO_SET_SERVO)
            async def servo(_request) -> object:
                return outcome

            with pytest.raises(CommandDenied, match="FAILED"):
                await pair.remote.command(common.MavCmd.DO_SET_SERVO)
            assert not pair.vehicle.commands.server.running
        assert "the handler of DO_SET_SERVO failed" in reported.errors[0]

    run_virtually(work())


def test_a_plain_handler_that_raises_or_has_an_invalid_result_fails() -> None:
    async def work() -> None:
        reported = ReportedErrors()
        async with VehiclePair() as pair:
            pair.vehicle.on_command(common.MavCmd.DO_SET_SERVO)(fail)
            pair.vehicle.on_command(common.MavCmd.DO_SET_RELAY)(lambda _: "ok")
            for command in (common.MavCmd.DO_SET_SERVO, common.MavCmd.DO_SET_RELAY):
                with pytest.raises(CommandDenied, match="FAILED"):
                    await pair.remote.command(command)
        assert len(reported.errors) == 2

    run_virtually(work())


def test_closing_the_node_cancels_its_long_commands() -> None:
    async def work() -> list[str]:
        ended: list[str] = []
        async with VehiclePair() as pair:

            @pair.vehicle.on_command(common.MavCmd.DO_WINCH)
            async def winch(request) -> common.MavResult:
                try:
                    while True:
                        pair.vehicle.commands.progress(request, 5)
                        await asyncio.sleep(1)
                finally:
                    ended.append("stopped")

            task = asyncio.ensure_future(pair.remote.command(common.MavCmd.DO_WINCH))
            await asyncio.sleep(3)
            await pair.vehicle.close()
            assert ended == ["stopped"]
            with pytest.raises(CommandDenied, match="CANCELLED"):
                await task
        return ended

    run_virtually(work())


def test_blocks_can_be_left_after_the_node_was_closed() -> None:
    async def work() -> None:
        async with (
            asyncio.timeout(100),
            VehiclePair() as pair,
            pair.remote.shell() as shell,
            pair.remote.manual_control() as sticks,
        ):
            sticks.set(ManualInput(x=1))
            shell.write_line("ls")
            await pair.ground.close()
            with pytest.raises(MavstackError, match="not open"):
                sticks.set(ManualInput(x=2))

    run_virtually(work())


def test_the_node_may_close_while_a_block_is_left() -> None:
    async def work() -> None:
        async with asyncio.timeout(100), VehiclePair() as pair:
            stream = pair.remote.manual_control()
            await stream.__aenter__()
            stream.set(ManualInput(x=1))
            leaving = asyncio.ensure_future(stream.__aexit__(None, None, None))
            await asyncio.sleep(0.15)
            await pair.ground.close()
            await leaving

    run_virtually(work())


def test_several_tasks_may_read_one_subscription() -> None:
    async def work() -> None:
        async with VehiclePair() as pair:
            messages = pair.remote.stream(common.Attitude)
            readers = [asyncio.ensure_future(anext(messages)) for _ in range(3)]
            await asyncio.sleep(1)
            readers[0].cancel()
            for number in range(2):
                pair.vehicle.send(common.Attitude(time_boot_ms=number))
            answers = await asyncio.wait_for(asyncio.gather(*readers[1:]), 5)
            assert {answer.time_boot_ms for answer in answers} == {0, 1}
            last = asyncio.ensure_future(anext(messages, None))
            await asyncio.sleep(1)
            messages.close()
            assert await last is None

    run_virtually(work())


def all_operations(remote) -> list:
    """Return one operation of each kind, not started."""
    return [
        lambda: remote.command(common.MavCmd.DO_WINCH),
        lambda: remote.request_message(common.CurrentMode),
        remote.get_version,
        remote.ping,
        remote.params.download,
        lambda: remote.params.set("P_01", 7),
        remote.extended_params.download,
        lambda: remote.ftp.download("logs/flight.bin"),
        lambda: remote.ftp.upload("new", bytes(20_000)),
        lambda: remote.ftp.list("/"),
        remote.logs.list,
        lambda: remote.logs.download(1),
        lambda: remote.modes.set("Position"),
        remote.modes.list,
        lambda: remote.mission.upload(WAYPOINTS),
        remote.mission.download,
        remote.fence.clear,
    ]


async def cancel_at_random(seed: int) -> None:
    random = Random(seed)
    reported = ReportedErrors()
    async with VehiclePair() as pair:

        @pair.vehicle.on_command(common.MavCmd.DO_WINCH)
        async def winch(_request) -> common.MavResult:
            await asyncio.sleep(20)
            return common.MavResult.ACCEPTED

        tasks = [
            asyncio.ensure_future(make())
            for make in random.sample(all_operations(pair.remote), random.randint(1, 5))
        ]
        for _ in range(random.choice([0, 1, 3, 10, 30, 100])):
            await asyncio.sleep(0)
        for task in tasks:
            task.cancel()
        closes = random.random() < 0.3
        if closes:
            await pair.ground.close()
        for outcome in await asyncio.gather(*tasks, return_exceptions=True):
            assert not isinstance(outcome, Exception) or isinstance(outcome, RemoteError), outcome
        if not closes:
            await asyncio.sleep(40)
            assert_clean(pair)
        else:
            await asyncio.sleep(1)
        assert not pair.vehicle.commands.server.running
    assert reported.errors == []


def assert_clean(pair: VehiclePair) -> None:
    for service in pair.ground._host.engine._services:
        assert not getattr(service, "busy", False), service
    assert len(pair.vehicle.ftp.sessions) == 0
    assert all(pair.vehicle.mission._uploads.running(kind) is None for kind in PlanType)
    assert not pair.vehicle.commands.server.running


def test_cancelling_any_operation_at_any_time_cleans_up_both_ends(seeds: Seeds) -> None:
    seeds.check(lambda seed: run_virtually(cancel_at_random(seed)))


def test_fifty_vehicles_on_one_link_at_the_same_time() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        vehicles = [Vehicle(network.link(), system=number) for number in range(1, 51)]
        async with contextlib.AsyncExitStack() as stack:
            ground = await stack.enter_async_context(Node(network.link()))
            for vehicle in vehicles:
                await stack.enter_async_context(vehicle)
            remotes = [await ground.wait_for_autopilot(vehicle.address.system) for vehicle in vehicles]
            uploads = [remote.mission.upload(WAYPOINTS) for remote in remotes]
            sets = [remote.params.set("P_01", remote.address.system) for remote in remotes]
            reads = [remote.ftp.download("hello.txt") for remote in remotes]
            await asyncio.gather(*uploads, *sets, *reads)
            for vehicle in vehicles:
                assert vehicle.parameters["P_01"] == vehicle.address.system
                assert list(vehicle.mission.plan(PlanType.MISSION).items) == WAYPOINTS

    run_virtually(work())


class SilentLinkNode(Node):
    """A ground station whose links can lose everything without an error."""

    def cut(self, number: int) -> None:
        """Lose everything that is sent and received over a link from now on."""
        for channel in self.links[number].channels:
            channel.send_bytes = lambda data: True
            channel.receive = lambda data: True


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("silently", [True, False])
def test_a_transfer_continues_over_the_other_link(number: int, silently: bool) -> None:
    async def work() -> None:
        one, other = MemoryNetwork(), MemoryNetwork()
        vehicle = Vehicle(one.link(), other.link())
        vehicle.files["large"] = bytes(range(256)) * 4000
        async with SilentLinkNode(one.link(), other.link()) as ground, vehicle:
            remote = await ground.wait_for_autopilot()
            reading = asyncio.ensure_future(remote.ftp.download("large"))
            progress = asyncio.ensure_future(remote.mission.upload(WAYPOINTS))
            for _ in range(20):
                await asyncio.sleep(0)
            assert not reading.done()
            if silently:
                ground.cut(number)
            else:
                for channel in tuple(ground.links[number].channels):
                    channel.close("cut")
            async with asyncio.timeout(60):
                assert await reading == bytes(range(256)) * 4000
                await progress

    run_virtually(work())


def test_a_link_that_closes_and_reopens() -> None:
    async def work() -> None:
        server = Node("tcpin://127.0.0.1:0", system=1, component=1, type=2, autopilot=12)
        await server.open()
        host, port = server.links[0].address
        async with Node(f"tcpout://{host}:{port}") as ground:
            remote = await ground.wait_for_autopilot(timeout=10)
            for _ in range(2):
                await server.close()
                server = Node(f"tcpin://{host}:{port}", system=1, component=1, type=2, autopilot=12)
                await server.open()
                async with ground.stream(common.Heartbeat, system=1) as messages:
                    await asyncio.wait_for(anext(messages), 20)
                assert (await asyncio.wait_for(remote.ping(1), 10)).received == 1
        await server.close()

    asyncio.run(work())


def test_open_is_idempotent() -> None:
    async def work() -> None:
        async with VehiclePair() as pair:
            driver = pair.ground._host.driver
            await asyncio.gather(pair.ground.open(), pair.ground.open())
            assert pair.ground._host.driver is driver
            assert len(pair.ground._host.engine.channels) == 1

    run_virtually(work())


def test_closing_the_node_cancels_running_operations() -> None:
    async def work() -> None:
        async with VehiclePair() as pair:
            task = asyncio.ensure_future(pair.ground.component(9).get_version())
            await asyncio.sleep(0.1)
            await pair.ground.close()
            with pytest.raises(RemoteCancelled):
                await task

    run_virtually(work())
