"""Typical programs on the async API; read by type checkers, and not run."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import TYPE_CHECKING, assert_type

import mavstack
from mavstack.dialects import common
from mavstack.errors import CommandDenied, RemoteTimeout
from mavstack.node import Listener, Node, RemoteComponent, Subscription
from mavstack.services.mission import ItemReached, MissionItem, Plan
from mavstack.services.parameters import Parameter
from mavstack.vehicle import Connection, Vehicle, VehicleFound, VehicleLost

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.wire import Packet


def print_progress(done: int, total: int) -> None:
    print(f"{done} of {total}")


async def fly_a_square(url: str) -> None:
    async with mavstack.connect(url) as connection:
        assert_type(connection, Connection)
        vehicle = await connection.wait_for_vehicle(timeout=None)
        assert_type(vehicle, Vehicle)
        await vehicle.wait_until_ready()
        await vehicle.arm(timeout=10)
        await vehicle.takeoff(10)
        for north, east in ((20.0, 0.0), (0.0, 20.0)):
            await vehicle.move(north, east)
        if vehicle.position is not None:
            print(vehicle.position.latitude, vehicle.battery)
        await vehicle.rtl()


async def read_messages(vehicle: Vehicle) -> float:
    async with vehicle.stream(common.Attitude, rate=10) as attitudes:
        async for attitude in attitudes:
            assert_type(attitude, common.Attitude)
            if attitude.roll > 1:
                return attitude.roll
    latest = vehicle.latest(common.VfrHud)
    return latest.airspeed if latest is not None else 0.0


async def transfer(vehicle: Vehicle) -> None:
    parameters = await vehicle.params.download(progress=print_progress)
    assert_type(parameters, Mapping[str, Parameter])
    assert_type(await vehicle.params.set("RTL_ALT", 30), Parameter)
    assert_type(await vehicle.ftp.download("/log.bin", timeout=30), bytes)
    await vehicle.mission.upload([MissionItem(common.MavCmd.NAV_TAKEOFF, param7=10.0)])
    assert_type(await vehicle.mission.download(), Plan)
    async with vehicle.mission.reached_items() as reached:
        assert_type(reached, Subscription[ItemReached])
    for entry in await vehicle.logs.list():
        await vehicle.logs.download(entry)


async def follow_setpoints(vehicle: Vehicle) -> None:
    async with vehicle.guided() as session:
        session.velocity(1.0, 0.0, 0.5)
        await asyncio.sleep(5)
        session.position(10.0, 0.0, 20.0, yaw=90.0)


async def command_a_fleet(connection: Connection) -> None:
    group = connection.group()
    results = await group.each(lambda vehicle: vehicle.params.get("SYSID_THISMAV"), max_concurrency=4)
    for vehicle, parameter in results.check().items():
        assert_type(vehicle, Vehicle)
        assert_type(parameter, Parameter)
    async with connection.events(VehicleFound, VehicleLost) as events:
        async for event in events:
            print(event)


def use_a_dialect_of_ones_own(path: str) -> list[str]:
    dialect = mavstack.Dialect.from_xml(path)
    connection = mavstack.connect("udpin://127.0.0.1:0", dialect=dialect)
    node = Node("udpin://127.0.0.1:0", dialect=dialect)
    print(connection, node, mavstack.Parser(dialect), mavstack.Parser(common))
    return [*mavstack.open_log(path, dialect), *mavstack.open_log(path, common)]


def listen(node: Node, vehicle: Vehicle) -> list[Listener]:
    def on_attitude(message: common.Attitude) -> None:
        print(message.yaw)

    def on_packet(packet: Packet) -> None:
        print(packet.system)

    return [
        node.add_listener(common.Attitude, on_attitude, system=1),
        node.add_packet_listener(None, on_packet),
        vehicle.add_listener(common.Attitude, on_attitude),
    ]


async def ask(node: Node) -> None:
    component = await node.wait_for_autopilot(1)
    assert_type(component, RemoteComponent)
    try:
        result = await component.command(common.MavCmd.DO_SET_SERVO, 5, 1500, timeout=3)
        print(result.attempts)
    except CommandDenied as error:
        print(error.code, error.operation, error.status_texts)
    except RemoteTimeout as error:
        print(error.attempts)
    assert_type(await component.request_message(common.HomePosition), common.HomePosition)
    await component.set_message_rate(common.Attitude, 50)
    print((await component.get_version()).capabilities, (await component.ping()).round_trips)


async def offer_a_camera() -> None:
    async with Node("udpout://127.0.0.1:14550", system=1, component=100, type=common.MavType.CAMERA) as node:

        @node.on_command(common.MavCmd.IMAGE_START_CAPTURE)
        async def capture(request: CommandRequest) -> common.MavResult:
            node.commands.progress(request, 50)
            return common.MavResult.ACCEPTED

        node.publish(common.CameraInformation, lambda now: common.CameraInformation(), interval=1.0)
        node.send_statustext("ready")
        await node.serve_forever()
