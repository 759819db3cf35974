"""Generated libraries in folders of tests, and the checks of programs of the guides."""

from __future__ import annotations

import socket
import subprocess
from typing import TYPE_CHECKING

from mavstack import Parser, encode
from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect, common
from tests.docs.blocks import BLOCKS

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.codegen import GeneratedFile

#: Messages for a small library: those of the guides, texts, arrays, extensions and 64-bit values.
SMALL = (
    *("HEARTBEAT", "ATTITUDE", "STATUSTEXT", "PARAM_SET", "COMMAND_LONG", "AUTOPILOT_VERSION"),
    *("BATTERY_STATUS", "GPS_STATUS", "ESC_INFO", "PLAY_TUNE", "TUNNEL", "VICON_POSITION_ESTIMATE"),
)


def files(
    language: str, dialect: Dialect | str = "common", *, only: tuple[str, ...] = (), package: str = ""
) -> list[GeneratedFile]:
    """Generate a library."""
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else dialect
    return generate(make_library(loaded, only=only, package=package), language)


def guide_programs(page: str, folder: Path) -> list[Path]:
    """Write the files of a guide; return their paths."""
    found = []
    for block in BLOCKS:
        if block.page.endswith(page) and block.directive.startswith("file: "):
            path = folder / block.directive.removeprefix("file: ")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, "utf-8")
            found.append(path)
    assert found, page
    return found


def write(generated: list[GeneratedFile], folder: Path) -> Path:
    """Write a library; return its folder."""
    write_files(generated, folder)
    return folder


def check_ground_station(command: list[str], cwd: Path | None = None) -> None:
    """Run the program "Receive and send" of a guide with a port, and fly past it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        vehicle.settimeout(0.2)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        with subprocess.Popen([*command, str(port)], stdout=subprocess.PIPE, text=True, cwd=cwd) as program:
            try:
                answer = _exchange(vehicle, port)
                assert program.stdout is not None
                printed = [program.stdout.readline().strip() for _ in range(2)]
            finally:
                program.kill()
    (packet,) = Parser(Dialect.load("common")).feed(answer)
    assert (packet.system, packet.component) == (255, 190)
    assert isinstance(packet.message, common.Heartbeat)
    assert packet.message.type == common.MavType.GCS
    assert packet.message.mavlink_version == 3
    assert printed[0] == "vehicle 7: roll 0.500"
    assert printed[1].upper().endswith("QUADROTOR ARMED")


def _exchange(vehicle: socket.socket, port: int) -> bytes:
    heartbeat = common.Heartbeat(type=common.MavType.QUADROTOR, base_mode=common.MavModeFlag.SAFETY_ARMED)
    messages = (common.Attitude(roll=0.5), heartbeat)
    data = b"".join(encode(item, system=7, component=1, sequence=n) for n, item in enumerate(messages))
    for _ in range(200):
        vehicle.sendto(data, ("127.0.0.1", port))
        try:
            return vehicle.recv(2048)
        except (TimeoutError, ConnectionError):
            continue
    raise AssertionError("the program does not answer")


def check_signing(command: list[str], cwd: Path | None = None) -> None:
    """Run the program "Sign and verify" of a guide."""
    printed = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60, cwd=cwd).stdout
    assert printed.lower().splitlines() == ["signed: true", "refused: 1"]
