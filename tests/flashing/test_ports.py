"""Boards by the USB ids of their ports."""

from __future__ import annotations

from types import SimpleNamespace

from mavstack.flashing.ports import PortInfo, describe


def port(device: str, vid: int | None = None, pid: int | None = None, text: str = "n/a"):
    return SimpleNamespace(device=device, vid=vid, pid=pid, description=text, serial_number=None)


def test_boards_are_known_by_their_usb_ids() -> None:
    found = describe(
        [
            port("/dev/ttyS0"),
            port("/dev/ttyACM1", 0x26AC, 0x0011, "PX4 BL FMU v2.x"),
            port("/dev/ttyACM0", 0x1209, 0x5740, "fmuv3"),
            port("/dev/ttyACM2", 0x3185, 0x0038, "PX4 BL FMU v6X"),
            port("/dev/ttyUSB9", 0x1111, 0x2222, "thing"),
        ]
    )
    assert [each.device for each in found] == sorted(each.device for each in found)
    boards = {each.device: (each.board, each.in_bootloader) for each in found}
    assert boards == {
        "/dev/ttyS0": ("", False),
        "/dev/ttyACM0": ("ArduPilot", False),
        "/dev/ttyACM1": ("PX4 bootloader", True),
        "/dev/ttyACM2": ("Auterion, Holybro or ARK", True),
        "/dev/ttyUSB9": ("", False),
    }
    assert found[0] == PortInfo("/dev/ttyACM0", "ArduPilot", "fmuv3", "1209:5740")
