from __future__ import annotations

import asyncio

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.errors import (
    InvalidArgumentError,
    InvalidStateError,
    LinkClosedError,
    LinkError,
    MspDecodeError,
    MspDenied,
    MspFirmwareError,
    MspTimeout,
    RemoteCancelled,
)
from mavstack.links import Impairment, memory_pair
from mavstack.msp import Frame, Priority
from mavstack.msp.messages import Name
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.controllers import IDENTITY, Firmware, controller_of


def test_opening_asks_the_controller_what_it_is():
    async def main():
        async with controller_of(Firmware()) as controller:
            info = controller.info
            assert (info.firmware, info.version_text, info.api) == ("Betaflight", "4.5.1", (1, 46))
            assert (info.board, info.target, info.name) == ("S405", "STM32F405", "quad")
            assert info.uid == "0302010007060504" + "0b0a0908"
            assert controller.connected
        assert not controller.connected

    run_virtually(main())


def test_messages_that_a_firmware_does_not_have_are_left_out():
    async def main():
        firmware = Firmware({number: IDENTITY[number] for number in (1, 2, 3)})
        async with controller_of(firmware) as controller:
            assert (controller.info.variant, controller.info.board) == ("BTFL", "")

    run_virtually(main())


def test_an_interface_that_is_not_known_is_refused():
    async def main():
        firmware = Firmware({**IDENTITY, 1: b"\x00\x02\x05"})
        with pytest.raises(MspFirmwareError, match=r"Betaflight 4\.5\.1 has version 2\.5 of MSP"):
            async with controller_of(firmware):
                pass
        firmware.replies[2] = b"INAV"
        async with controller_of(firmware) as controller:
            assert controller.info.is_inav

    run_virtually(main())


def test_a_line_without_a_controller():
    async def main():
        with pytest.raises(MspTimeout, match=r"asking for .* failed after 3 attempts: no answer;"):
            async with controller_of(Firmware(silent=True)):
                pass

    run_virtually(main())


def test_requests_and_messages():
    async def main():
        firmware = Firmware({**IDENTITY, 11: b"", 4000: b"ab"})
        async with controller_of(firmware) as controller:
            assert await controller.get(Name) == Name("quad")
            assert await controller.request(4000, b"x") == b"ab"
            with pytest.raises(MspDenied, match=r"MSP command 77 on .* refused by the firmware"):
                await controller.request(77)
            firmware.replies[10] = None
            with pytest.raises(MspDenied, match=r"^MSP_NAME on "):
                await controller.get(Name)
            firmware.replies[160] = b"short"
            with pytest.raises(MspDecodeError):
                await controller.identify()

    run_virtually(main())


def test_the_timeout_of_a_call_includes_its_time_in_the_queue():
    async def main():
        firmware = Firmware()
        async with controller_of(firmware) as controller:
            firmware.silent = True
            started = asyncio.get_running_loop().time()
            calls = [controller.request(1, timeout=0.3), controller.request(2, timeout=0.3)]
            errors = await asyncio.gather(*calls, return_exceptions=True)
            assert [type(error) for error in errors] == [MspTimeout, MspTimeout]
            assert asyncio.get_running_loop().time() - started == pytest.approx(0.3)

    run_virtually(main())


def test_a_cancelled_call_frees_the_line():
    async def main():
        firmware = Firmware(delay=0.2)
        async with controller_of(firmware) as controller:
            task = asyncio.create_task(controller.request(10))
            await asyncio.sleep(0.1)
            task.cancel()
            assert await controller.request(2) == b"BTFL"

    run_virtually(main())


def test_control_is_sent_before_what_waits():
    async def main():
        firmware = Firmware({**IDENTITY, 200: b""})
        async with controller_of(firmware) as controller:
            firmware.received.clear()
            polls = [asyncio.create_task(controller.request(10)) for _ in range(3)]
            await asyncio.sleep(0)
            await controller.request(200, priority=Priority.CONTROL)
            await asyncio.gather(*polls)
            assert [frame.command for frame in firmware.received] == [10, 200, 10, 10]

    run_virtually(main())


def test_a_lost_link_ends_requests_with_a_typed_error():
    async def main():
        firmware = Firmware()
        async with controller_of(firmware) as controller:
            firmware.silent = True
            task = asyncio.create_task(controller.request(10))
            await asyncio.sleep(0.01)
            await controller._connection._link.close()
            with pytest.raises(RemoteCancelled, match=r"the link was lost"):
                await task
            with pytest.raises(LinkClosedError, match=r"is not connected"):
                await controller.request(10)

    run_virtually(main())


def test_a_link_without_a_peer():
    async def main():
        with pytest.raises(LinkError, match="nothing is connected"):
            await FlightController(memory_pair()[0]).open()

    run_virtually(main())


async def test_a_link_that_cannot_be_opened_is_named_as_it_was_given():
    with pytest.raises(LinkError, match=r"^cannot open msp\+tcp://127\.0\.0\.1:9: connection refused"):
        await FlightController("msp+tcp://127.0.0.1:9").open()


def test_save_and_reboot():
    async def main():
        firmware = Firmware({**IDENTITY, 68: b"\0", 250: b""})
        async with controller_of(firmware) as controller:
            await controller.save()
            firmware.replies[10] = b"after"
            await controller.reboot()
            assert firmware.restarts == 1
            assert controller.info.name == "after"
            firmware.silent = True
            with pytest.raises(MspTimeout, match=r"^restarting .* no answer for 4 s"):
                await controller.reboot(timeout=4)

    run_virtually(main())


def test_the_cli():
    async def main():
        firmware = Firmware()
        async with controller_of(firmware) as controller:
            async with controller.cli() as cli:
                assert await cli.run("set gyro_hardware = MPU") == "gyro_hardware set to MPU"
                assert await cli.run("") == ""
                assert (await cli.run("nonsense")).startswith("###ERROR IN nonsense")
                with pytest.raises(InvalidArgumentError, match=r"completion"):
                    await cli.run("set name = ?")
                with pytest.raises(InvalidStateError, match=r"its CLI is open"):
                    await controller.request(1)
            assert firmware.restarts == 1
            assert firmware.settings == {"gyro_hardware": "AUTO"}
            assert await controller.get(Name) == Name("quad")

    run_virtually(main())


def test_saving_in_the_cli():
    async def main():
        firmware = Firmware()
        async with controller_of(firmware) as controller:
            async with controller.cli() as cli:
                await cli.run("set gyro_hardware = MPU")
                await cli.save()
                with pytest.raises(InvalidStateError, match=r"the CLI is closed"):
                    await cli.run("version")
            assert (firmware.saved, firmware.restarts) == ({"gyro_hardware": "MPU"}, 1)

    run_virtually(main())


def test_dump_and_restore():
    async def main():
        firmware = Firmware()
        async with controller_of(firmware) as controller:
            dump = await controller.dump()
            assert dump.startswith("# version\n# test\n")
            assert dump.endswith("set gyro_hardware = AUTO\nbatch end\n\nsave\n")
            steps: list[tuple[int, int]] = []
            changed = dump.replace("AUTO", "MPU")
            assert await controller.restore(changed, lambda *step: steps.append(step)) == 3
            assert steps == [(1, 3), (2, 3), (3, 3)]
            assert firmware.saved == {"gyro_hardware": "MPU"}

    run_virtually(main())


def test_nothing_is_saved_if_a_line_of_a_dump_has_an_error():
    async def main():
        firmware = Firmware()
        async with controller_of(firmware) as controller:
            dump = "set gyro_hardware = MPU\n# heading\nset baro = BMP\nsave\n"
            with pytest.raises(MspDenied, match=r"line 3, 'set baro = BMP': ERROR IN set: INVALID NAME"):
                await controller.restore(dump)
            assert firmware.saved == {"gyro_hardware": "AUTO"}
            with pytest.raises(InvalidArgumentError, match=r"^line 2: "):
                await controller.restore("set a = 1\nset name = what?")

    run_virtually(main())


def test_a_cli_that_does_not_open_or_does_not_answer():
    async def main():
        firmware = Firmware()
        async with controller_of(firmware) as controller:
            firmware.silent = True
            with pytest.raises(MspTimeout, match=r"opening the CLI of .* after 2 attempts: no prompt"):
                async with controller.cli():
                    pass
            firmware.silent = False
            async with controller.cli(restart=False) as cli:
                firmware.silent = True
                with pytest.raises(MspTimeout, match=r"CLI command 'dump' on .* no complete reply"):
                    await cli.run("dump", timeout=1)
            with pytest.raises(MspTimeout):
                await controller.request(1)

    run_virtually(main())


def test_passthrough():
    async def main():
        firmware = Firmware({**IDENTITY, 245: lambda payload: bytes([payload == b"\xfd\x02"])})
        async with controller_of(firmware) as controller:
            with pytest.raises(MspDenied, match=r"^connecting the ESCs of .* the controller has none"):
                async with controller.passthrough():
                    pass
            async with controller.passthrough(2) as line:
                line.write(b"hello")
                assert await line.read() == b"HELLO"
                with pytest.raises(InvalidStateError, match=r"connected with serial port 2"):
                    await controller.request(1)
            assert firmware.raw == b"hello"

    run_virtually(main())


def test_frames_that_answer_no_request():
    async def main():
        firmware = Firmware({**IDENTITY, 10: lambda payload: bytes([payload == b""])})
        async with controller_of(firmware) as controller:
            seen: list[Frame] = []
            controller.on_unsolicited(seen.append)
            controller._connection._receive_data(bytes.fromhex("244d3e01b604b3"))
            assert [frame.command for frame in seen] == [182]

    run_virtually(main())


def test_a_slow_serial_line():
    async def main():
        async with controller_of(Firmware(), Impairment(bandwidth=11520)) as controller:
            started = asyncio.get_running_loop().time()
            await controller.get(Name)
            # 6 bytes there, 10 back, and 1 ms of the firmware
            assert asyncio.get_running_loop().time() - started == pytest.approx(16 / 11520 + 0.001)

    run_virtually(main())
