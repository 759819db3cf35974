from __future__ import annotations

import asyncio
import sys
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import LinkError, MissingExtraError
from mavstack.links import ChannelClosed, ChannelOpened, LinkDown, open_link

from .conformance import Conformance, receive
from .peers import PtyPeer

pytest.importorskip("serial")
posix_only = pytest.mark.skipif(sys.platform == "win32", reason="needs ptys")


@pytest.fixture
async def failures():
    """Collect the exceptions that no task or caller gets."""
    collected = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: collected.append(context))
    return collected


@posix_only
class TestSerial(Conformance):
    options = ""

    @asynccontextmanager
    async def pair(self, query=""):
        peer = PtyPeer()

        async def open_peer():
            return peer

        yield open_link(f"serial://{peer.path}?retry=1ms&{self.options}{query}"), open_peer
        await peer.close()


@posix_only
class TestSerialByThreads(TestSerial):
    options = "threads=yes&"


@posix_only
async def test_terminal_control_bytes_are_unchanged():
    peer = PtyPeer()
    async with open_link(f"{peer.path},57600") as link:
        channel = (await anext(link)).channel
        all_bytes = bytes(range(256))
        channel.write(all_bytes)
        assert await peer.receive(256) == all_bytes
        await peer.send(all_bytes)
        assert await receive(link, 256) == all_bytes
    await peer.close()


@posix_only
@pytest.mark.parametrize("threads", ["no", "yes"])
async def test_a_reconnected_device_is_opened_again(tmp_path, threads):
    first, device = PtyPeer(), tmp_path / "ttyDrone"
    device.symlink_to(first.path)
    async with open_link(f"serial://{device}?retry=1ms&retry_limit=2ms&threads={threads}") as link:
        channel = (await anext(link)).channel
        await first.close()
        device.unlink()
        assert isinstance(event := await anext(link), ChannelClosed)
        assert event.channel is channel
        assert isinstance(await anext(link), LinkDown)
        second = PtyPeer()
        device.symlink_to(second.path)
        while isinstance(event := await anext(link), LinkDown):
            pass
        assert isinstance(event, ChannelOpened)
        event.channel.write(b"back")
        assert await second.receive(4) == b"back"
    await second.close()


@posix_only
@pytest.mark.parametrize("threads", ["no", "yes"])
@pytest.mark.parametrize("ends_at_the_device", [False, True])
async def test_a_closed_channel_ends_once_and_the_port_is_opened_again(
    tmp_path, threads, ends_at_the_device, failures
):
    first, device = PtyPeer(), tmp_path / "ttyDrone"
    device.symlink_to(first.path)
    async with open_link(f"serial://{device}?retry=1ms&retry_limit=2ms&threads={threads}") as link:
        channel = (await anext(link)).channel
        if ends_at_the_device:
            second = PtyPeer()
            device.unlink()
            device.symlink_to(second.path)
            await first.close()
        else:
            second = first
            channel.close()
        while not isinstance(event := await anext(link), ChannelOpened):
            pass
        event.channel.write(b"back")
        assert await second.receive(4) == b"back"
    await second.close()
    assert not failures


async def test_a_missing_device_raises_with_the_available_ports():
    name = "COM250" if sys.platform == "win32" else "/dev/ttyNONE7"
    with pytest.raises(LinkError, match=rf"no such device: {name}; this machine has"):
        await open_link(f"{name},57600")


@posix_only
async def test_a_device_in_use_raises():
    peer = PtyPeer()
    async with open_link(peer.path):
        with pytest.raises(LinkError, match="is in use by another program"):
            await open_link(peer.path)
    async with open_link(peer.path) as again:
        assert isinstance(await anext(again), ChannelOpened)
    await peer.close()


@posix_only
async def test_a_device_that_is_no_serial_port_raises():
    with pytest.raises(LinkError, match="not a serial port"):
        await open_link("/dev/null")


@posix_only
@pytest.mark.skipif(sys.platform == "win32", reason="needs users")
async def test_missing_permission_raises(monkeypatch):
    import serial

    def deny(*_, **__):
        raise serial.SerialException(13, "could not open port")

    monkeypatch.setattr(serial, "Serial", deny)
    with pytest.raises(LinkError, match="no permission for /dev/ttyACM0: add yourself to the group"):
        await open_link("/dev/ttyACM0")


@pytest.mark.parametrize("text", ["PermissionError(13, 'Access is denied.')", "FileNotFoundError(2, 'x')"])
async def test_errors_of_windows_are_translated(monkeypatch, text):
    import serial

    def fail(*_, **__):
        raise serial.SerialException(f"could not open port 'COM3': {text}")

    monkeypatch.setattr(serial, "Serial", fail)
    expected = "in use" if "Permission" in text else "no such device"
    with pytest.raises(LinkError, match=expected):
        await open_link("COM3,57600", threads=True)


async def test_a_missing_extra_raises(monkeypatch):
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'mavstack\[serial\]'"):
        await open_link("/dev/ttyACM0")
