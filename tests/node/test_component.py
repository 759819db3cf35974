"""Each part of a remote component, once, against a component that offers every service."""

from __future__ import annotations

import asyncio
from contextlib import nullcontext

import pytest

from mavstack.dialects import Dialect, common
from mavstack.errors import CommandDenied, CommandTimeout, FileDenied, ModeTimeout, ParameterDenied
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services import Address
from mavstack.services.ftp import Entry, file_crc32
from mavstack.services.manual_control import ChannelOverride, ManualInput
from mavstack.services.mission import MissionItem, Plan
from mavstack.services.modes import modes_of
from mavstack.services.parameters import Encoding
from mavstack.services.setpoints import LocalSetpoint
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import COPTER, VehiclePair

PX4 = common.MavAutopilot.PX4
#: On channels 9 to 18 zero means no change, and this value releases a channel.
RELEASE_LATE = 65534


def with_pair(work, **options) -> None:
    async def run() -> None:
        async with VehiclePair(**options) as pair:
            await work(pair)

    run_virtually(run())


def test_parameters() -> None:
    async def work(pair: VehiclePair) -> None:
        parameters = pair.remote.params
        assert (await parameters.get("P_07")).value == 7
        async with parameters.changes() as changes:
            assert (await parameters.set("P_07", 70)).value == 70
            assert (await anext(changes)).parameter.name == "P_07"
        steps: list = []
        fetched = await parameters.download(progress=lambda *step: steps.append(step))
        assert {name: parameter.value for name, parameter in fetched.items()} == {
            f"P_{number:02}": 70 if number == 7 else number for number in range(40)
        }
        assert steps[-1][1] == 40
        assert pair.vehicle.parameters["P_07"] == 70
        with pytest.raises(ParameterDenied, match="reading parameter NOPE of 1/1 failed: DOES_NOT_EXIST"):
            await parameters.get("NOPE")

    with_pair(work)


def test_a_message_leaves_at_the_end_of_the_turn_or_at_once() -> None:
    async def work(pair: VehiclePair) -> None:
        sent: list[bytes] = []
        pair.remote._host.sent_listeners.append(sent.append)
        pair.remote.send(common.Attitude())
        assert sent == []
        await asyncio.sleep(0.001)
        assert len(sent) == 1
        pair.remote.send(common.Attitude(), at_once=True)
        assert len(sent) == 2
        pair.remote.send(common.Attitude(time_boot_ms=3))
        pair.remote.send(common.Attitude(time_boot_ms=4), at_once=True)
        assert [each[10] for each in sent[2:]] == [3, 4]  # the order of the calls

    with_pair(work)


def test_nothing_is_written_at_once_while_the_node_closes() -> None:
    async def work(pair: VehiclePair) -> None:
        sent: list[bytes] = []
        host = pair.remote._host
        await host.driver.stop()
        host.sent_listeners.append(sent.append)
        pair.remote.send(common.Attitude(), at_once=True)
        assert sent == []

    with_pair(work)


def test_logs() -> None:
    async def work(pair: VehiclePair) -> None:
        listed = await pair.remote.logs.list()
        assert [entry.size for entry in listed] == [10240, 5]
        assert await pair.remote.logs.download(listed[0]) == pair.vehicle.logs.contents[1]
        assert await pair.remote.logs.download(2) == b"short"
        await pair.remote.logs.erase()
        assert pair.vehicle.logs.contents == {}

    with_pair(work)


@pytest.mark.parametrize(
    ("autopilot", "mode", "name"),
    [
        (common.MavAutopilot.PX4, "return", "RTL"),
        (common.MavAutopilot.ARDUPILOTMEGA, "guided", "GUIDED"),
    ],
)
def test_modes(autopilot: int, mode: str, name: str) -> None:
    async def work(pair: VehiclePair) -> None:
        modes = pair.remote.modes
        async with modes.changes() as changes:
            await modes.set(mode)
            assert modes.current.upper() == name
            assert changes.drain()[-1].name.upper() == name
        assert len(await modes.list()) == 3

    with_pair(work, autopilot=autopilot)


def test_standard_modes() -> None:
    async def work(pair: VehiclePair) -> None:
        server, modes = pair.vehicle.modes, pair.remote.modes
        rtl, standard = 0x05040000, common.MavStandardMode
        server.offer(modes_of(PX4, COPTER, [0, 0x04040000, rtl], {rtl: standard.SAFE_RECOVERY}), 0.0)
        assert await modes.set_standard(standard.SAFE_RECOVERY) == rtl
        assert server.current.custom_mode == rtl
        assert [mode.name for mode in await modes.list()][-1] == "RTL"  # without a name on the wire
        assert (modes.current, modes._client.standard_mode) == (
            None,
            None,
        )  # not followed until now
        await asyncio.sleep(3)
        assert (modes.current, modes._client.standard_mode) == ("RTL", standard.SAFE_RECOVERY)
        with pytest.raises(CommandDenied, match="FAILED") as denied:
            await modes.set_standard(standard.ORBIT)
        assert denied.value.code == common.MavResult.FAILED
        assert server.current.custom_mode == rtl

    with_pair(work)


def test_an_accepted_standard_mode_that_is_not_entered_times_out() -> None:
    async def work(pair: VehiclePair) -> None:
        command = common.MavCmd.DO_SET_STANDARD_MODE
        pair.vehicle.commands.server.support(command, lambda _: common.MavResult.ACCEPTED)
        with pytest.raises(
            ModeTimeout, match=r"setting standard mode LAND on 1/1 failed.*accepted, but not entered"
        ):
            await pair.remote.modes.set_standard(common.MavStandardMode.LAND)

    with_pair(work)


def test_a_shell() -> None:
    async def work(pair: VehiclePair) -> None:
        async with pair.remote.shell() as shell:
            shell.write_line("ver all")
            received = ""
            while "ver all" not in received:
                received += await anext(shell)
            assert pair.vehicle.shell.owner == pair.ground.address
        await asyncio.sleep(1)
        assert pair.vehicle.shell.owner is None

    with_pair(work)


def test_setpoints_and_manual_control_end_with_their_block() -> None:
    async def work(pair: VehiclePair) -> None:
        ground = pair.ground.address
        async with pair.remote.setpoints(rate=10) as stream:
            stream.set(LocalSetpoint(velocity=(1.0, 0.0, -0.5)))
            await asyncio.sleep(1)
            setpoint, age = pair.vehicle.setpoints.latest(ground, pair.vehicle.now())
            assert setpoint.velocity == (1.0, 0.0, -0.5)
            assert age <= 0.1
        async with pair.remote.manual_control() as sticks:
            sticks.set(ManualInput(x=500))
            await asyncio.sleep(0.5)
            held, _ = pair.vehicle.sticks.latest(ground, pair.vehicle.now())
            assert held.x == 500
        async with pair.vehicle.packets(system=ground.system) as received:
            await asyncio.sleep(3)
            assert {packet.name for packet in received.drain()} == {"HEARTBEAT"}
        assert len(pair.ground._host.engine._services) < 12

    with_pair(work)


@pytest.mark.parametrize("raises", [False, True])
def test_channels_are_overridden_in_a_block_and_then_released(raises: bool) -> None:
    async def work(pair: VehiclePair) -> None:
        async def steer() -> None:
            async with pair.remote.override_channels(rate=10) as channels:
                channels.set(ChannelOverride({3: 1600, 9: 1200}))
                await asyncio.sleep(0.95)
                assert overridden() == {3: 1600, 9: 1200}
                channels.set(ChannelOverride({3: 1500}))
                await asyncio.sleep(1.0)
                assert overridden() == {3: 1500}  # a channel that is no longer overridden is released
                if raises:
                    raise ZeroDivisionError

        def overridden() -> dict[int, int] | None:
            held = pair.vehicle.sticks.overridden(pair.ground.address, pair.vehicle.now())
            return held and dict(held[0])

        async with pair.vehicle.stream(common.RcChannelsOverride) as received:
            with pytest.raises(ZeroDivisionError) if raises else nullcontext():
                await steer()
            assert overridden() is None
            pulses = [(message.chan3_raw, message.chan9_raw) for message in received.drain()]
            assert pulses.count((1600, 1200)) == 10
            assert pulses.count((1500, RELEASE_LATE)) == 10
            assert pulses[20:] == [(0, RELEASE_LATE)] * 5
            await asyncio.sleep(3)
            assert received.drain() == []

    with_pair(work)


def test_send_fills_in_the_target() -> None:
    async def work(pair: VehiclePair) -> None:
        async with pair.vehicle.stream(common.PlayTuneV2) as received:
            pair.remote.send(common.PlayTuneV2(tune="MFT200"))
            message = await anext(received)
        assert Address(message.target_system, message.target_component) == (1, 1)

    with_pair(work)


def test_files() -> None:
    async def work(pair: VehiclePair) -> None:
        files = pair.remote.ftp
        assert {entry.name for entry in await files.list("/")} >= {"logs", "hello.txt"}
        steps: list = []
        data = await files.download("/logs/flight.bin", progress=lambda *step: steps.append(step))
        assert data == bytes(range(256)) * 200
        assert steps[-1] == (len(data), len(data))
        assert await files.download("/logs/flight.bin", offset=100, size=3) == bytes([100, 101, 102])
        await files.make_directory("/plans")
        await files.upload("/plans/a.txt", b"a" * 1000)
        assert await files.checksum("/plans/a.txt") == file_crc32(b"a" * 1000)
        await files.rename("/plans/a.txt", "/plans/b.txt")
        await files.truncate("/plans/b.txt", 10)
        assert pair.vehicle.files["plans/b.txt"] == b"a" * 10
        await files.remove("/plans/b.txt")
        await files.remove_directory("/plans")
        with pytest.raises(FileDenied, match=r"plans/b.txt"):
            await files.download("/plans/b.txt")

    with_pair(work)


def test_a_cancelled_download_closes_its_session() -> None:
    async def work(pair: VehiclePair) -> None:
        def stop(_done: int, _total: int) -> None:
            task.cancel()

        task = asyncio.ensure_future(pair.remote.ftp.download("/logs/flight.bin", progress=stop))
        with pytest.raises(asyncio.CancelledError):
            await task
        await asyncio.sleep(2)
        assert not pair.vehicle.ftp.sessions

    with_pair(work)


def test_ardupilot_parameters_are_downloaded_as_one_file() -> None:
    async def work(pair: VehiclePair) -> None:
        async with pair.ground.packets(common.ParamValue) as values:
            await pair.remote.params.get("P_03")
            assert not pair.remote.params.is_complete
            values.drain()
            fetched = await pair.remote.params.download()
            assert pair.remote.params.is_complete
            assert len(values.drain()) == 0
        assert {name: parameter.value for name, parameter in fetched.items()} == {
            f"P_{number:02}": number for number in range(40)
        }

    with_pair(work, autopilot=common.MavAutopilot.ARDUPILOTMEGA)


def test_px4_is_not_asked_for_its_version_before_its_parameters_are_transferred() -> None:
    async def work(pair: VehiclePair) -> None:
        async with pair.vehicle.packets(common.CommandLong) as commands:
            assert (await pair.remote.params.get("P_03")).value == 3
            await pair.remote.params.download()
            assert not commands.drain()

    with_pair(work, autopilot=common.MavAutopilot.PX4)


def test_an_autopilot_that_runs_px4_now_gets_its_encoding() -> None:
    async def work(pair: VehiclePair) -> None:
        params = pair.remote.params
        await params.get("P_03")
        assert params.encoding is Encoding.C_CAST
        pair.vehicle._heartbeat.autopilot = common.MavAutopilot.PX4
        pair.vehicle.parameters.encoding = Encoding.BYTEWISE
        async with pair.ground.stream(common.Heartbeat) as heartbeats:
            await anext(heartbeats)
        assert (await params.set("P_03", 1_000_001)).value == 1_000_001
        assert params.encoding is Encoding.BYTEWISE

    with_pair(work, autopilot=common.MavAutopilot.ARDUPILOTMEGA)


def test_extended_parameters() -> None:
    async def work(pair: VehiclePair) -> None:
        extended = pair.remote.extended_params
        assert (await extended.get("CAM_MODE")).value == "photo"
        assert (await extended.set("CAM_MODE", "video")).value == "video"
        assert list(await extended.download()) == ["CAM_MODE"]

    with_pair(work)


def test_modes_that_are_not_reported_come_from_the_documentation() -> None:
    async def work(pair: VehiclePair) -> None:
        pair.vehicle.commands.server.support(common.MavCmd.REQUEST_MESSAGE, lambda _: common.MavResult.FAILED)
        names = {mode.name.upper() for mode in await pair.remote.modes.list()}
        assert {"STABILIZE", "GUIDED", "RTL", "LOITER"} <= names

    with_pair(work, autopilot=common.MavAutopilot.ARDUPILOTMEGA)


def test_list_omits_the_directory_itself_and_its_parent() -> None:
    async def work(pair: VehiclePair) -> None:
        listed = pair.vehicle.files.list_directory
        extra = [Entry(name, is_directory=True) for name in (".", "..")]
        pair.vehicle.files.list_directory = lambda path: [*extra, *listed(path)]
        names = [entry.name for entry in await pair.remote.ftp.list()]
        assert "hello.txt" in names
        assert "." not in names
        assert ".." not in names

    with_pair(work)


def test_errors_name_a_command_of_the_nodes_dialect(tmp_path) -> None:
    xml = tmp_path / "mine.xml"
    xml.write_text(
        '<mavlink><include>common.xml</include><enums><enum name="MAV_CMD">'
        '<entry value="31900" name="MAV_CMD_SPRAY"/></enum></enums></mavlink>'
    )
    dialect = Dialect.from_xml(xml)

    async def work() -> None:
        network = MemoryNetwork()
        async with (
            Node(network.link(), system=1, component=1),
            Node(network.link(), dialect=dialect) as ground,
        ):
            component = ground.component(1)
            for command in (31900, dialect.enums["MAV_CMD"].SPRAY):
                with pytest.raises(CommandTimeout, match=r"^SPRAY on 1/1 failed after \d attempts:"):
                    await component.command(command, 1)
            held = component.mission._named(Plan.of([MissionItem(31900), MissionItem(16)]))
            assert [item.name for item in held.items] == ["SPRAY", "NAV_WAYPOINT"]
            official = Plan.of([MissionItem(16)])
            assert component.mission._named(official) is official

    run_virtually(work())


def test_received_parameters_are_read_by_name() -> None:
    async def work() -> None:
        async with VehiclePair() as pair:
            params = pair.remote.params
            with pytest.raises(KeyError, match=r"call get\('P_03'\), or download"):
                _ = params["P_03"]
            assert "P_03" not in params
            await params.download()
            assert params["P_03"].value == 3
            assert "P_03" in params
            assert list(params)[:2] == ["P_00", "P_01"]

    run_virtually(work())
