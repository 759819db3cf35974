"""The checks of `mav doctor`; a check that raises becomes a failed finding."""

from __future__ import annotations

import asyncio
import os
import platform
import sys
from collections.abc import Callable, Iterable
from enum import Enum
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from mavstack import __version__

if TYPE_CHECKING:
    from mavstack.links import Link

_TIMEOUT: Final = 2.0
#: Distribution, its purpose, and the extra that installs it; a distribution without an extra is required.
_LIBRARIES: Final = (
    ("numpy", "tables of logs", ""),
    ("rich", "live pictures", "cli"),
    ("prompt_toolkit", "completion in the shell", "cli"),
    ("pyserial", "serial ports", "serial"),
    ("websockets", "WebSocket links", "web"),
    ("cryptography", "sealed links", "secure"),
)
#: The links that a thread of the core can read.
_READ_LINKS: Final = "UDP, TCP, Unix sockets and serial ports"
_CPU_FEATURES: Final = ("sha_ni", "sha2", "avx2", "neon", "asimd")


class Status(Enum):
    """The result of a check."""

    OK = "ok"
    NOTE = "note"
    MISSING = "missing"
    FAILED = "failed"


class Finding(NamedTuple):
    """One finding of a check, with a remedy if there is one."""

    name: str
    status: Status
    detail: str
    remedy: str = ""


Check: TypeAlias = Callable[[], Iterable[Finding]]


def run_checks() -> list[Finding]:
    """Run all checks and return their findings in order."""
    findings: list[Finding] = []
    for name, check in _CHECKS:
        try:
            findings += check()
        except Exception as error:  # noqa: BLE001 (any error is a finding)
            findings.append(Finding(name, Status.FAILED, f"{type(error).__name__}: {error}"))
    return findings


def _versions() -> Iterable[Finding]:
    yield Finding("mavstack", Status.OK, f"{__version__} in {Path(__file__).parents[2]}")
    yield Finding("python", Status.OK, f"{platform.python_implementation()} {platform.python_version()}")
    yield Finding("platform", Status.OK, f"{platform.system()} {platform.release()} on {platform.machine()}")
    if features := _cpu_features():
        yield Finding("processor", Status.OK, f"{os.cpu_count()} cores, {' '.join(features)}")


def _cpu_features() -> list[str]:
    """Return the processor features that make the core faster; known only on Linux."""
    try:
        words = set(Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").split())
    except OSError:
        return []
    return [feature for feature in _CPU_FEATURES if feature in words]


def _libraries() -> Iterable[Finding]:
    for name, purpose, extra in _LIBRARIES:
        try:
            yield Finding(name, Status.OK, f"{version(name)}, for {purpose}")
        except PackageNotFoundError:
            if extra:
                yield Finding(name, Status.MISSING, f"for {purpose}", f"pip install 'mavstack[{extra}]'")
            else:
                yield Finding(name, Status.FAILED, f"for {purpose}", f"pip install {name}")


def _core() -> Iterable[Finding]:
    """Check that the core computes a known checksum, and parses the packets that it encodes."""
    from mavstack._core import TOOLCHAIN
    from mavstack.dialects import common
    from mavstack.wire import Parser, Signing, crc16, encode

    yield Finding("toolchain", Status.OK, f"the core was built by {TOOLCHAIN}")
    if crc16(b"123456789") != 0x6F91:
        yield Finding("core", Status.FAILED, "the checksum is wrong")
        return
    message = common.Attitude(time_boot_ms=1, roll=0.5)
    for kind, protocol, signing in (
        ("MAVLink 1", 1, None),
        ("MAVLink 2", 2, None),
        ("signed", 2, Signing(bytes(32), timestamp=1)),
    ):
        data = encode(message, system=1, component=1, version=protocol, signing=signing, now=1.5e9)
        found = Parser(common).feed(data)
        if len(found) != 1 or found[0].message != message:
            yield Finding("core", Status.FAILED, f"a parsed {kind} packet differs from the encoded one")
            return
    yield Finding("core", Status.OK, "checksum, MAVLink 1, MAVLink 2 and signed packets are correct")


def _dialects() -> Iterable[Finding]:
    from mavstack.dialects import Dialect

    dialect = Dialect.load("all")
    yield Finding("dialects", Status.OK, f"{len(dialect)} messages and {len(dialect.enums)} enums in all")


def _udp() -> Iterable[Finding]:
    seconds = asyncio.run(_udp_delay())
    yield Finding("udp", Status.OK, f"a datagram over 127.0.0.1 took {seconds * 1000:.1f} ms")


async def _udp_delay() -> float:
    """Return the seconds that a datagram takes between two links."""
    from mavstack.links import open_link

    loop = asyncio.get_running_loop()
    async with asyncio.timeout(_TIMEOUT), open_link("udpin://127.0.0.1:0") as receiver:
        host, port = receiver.address or ("", 0)
        async with open_link(f"udpout://{host}:{port}") as sender:
            started = loop.time()
            sender.channels[0].write(b"mavstack")
            await _received(receiver)
            return loop.time() - started


async def _received(link: Link) -> bytes:
    from mavstack.links import BytesReceived

    async for event in link:
        if isinstance(event, BytesReceived):
            return event.data
    raise ConnectionError("the link ended")


def _input() -> Iterable[Finding]:
    """Report which part reads the links of a program."""

    async def is_native() -> bool:
        from mavstack.node.native_input import is_possible

        return is_possible(asyncio.get_running_loop())

    if asyncio.run(is_native()):
        yield Finding("input", Status.OK, f"{_READ_LINKS} are read by a thread of the core")
    else:
        remedy = "unset MAVSTACK_INPUT" if "MAVSTACK_INPUT" in os.environ else ""
        yield Finding("input", Status.NOTE, f"{_READ_LINKS} are read by asyncio", remedy)


def _serial_ports() -> Iterable[Finding]:
    ports = _found_ports()
    if not ports:
        yield Finding("serial ports", Status.NOTE, "none found")
    for device, description in ports:
        about = f"{device} {description}".strip()
        if sys.platform == "linux" and Path(device).exists() and not os.access(device, os.R_OK | os.W_OK):
            remedy = "sudo usermod -a -G dialout $USER, then log in again"
            yield Finding("serial port", Status.NOTE, f"{about}, no permission to open it", remedy)
        else:
            yield Finding("serial port", Status.OK, about)


def _found_ports() -> list[tuple[str, str]]:
    try:
        from serial.tools.list_ports import comports
    except ImportError:
        names = [*Path("/dev").glob("ttyACM*"), *Path("/dev").glob("ttyUSB*")]
        return sorted((str(name), "") for name in names)
    described = ((port.device, port.description or "") for port in comports())
    return sorted((device, "" if text == "n/a" else text) for device, text in described)


_CHECKS: Final[tuple[tuple[str, Check], ...]] = (
    ("versions", _versions),
    ("libraries", _libraries),
    ("core", _core),
    ("dialects", _dialects),
    ("udp", _udp),
    ("input", _input),
    ("serial ports", _serial_ports),
)
