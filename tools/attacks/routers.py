"""The routers that are attacked: each joins a vehicle's port and a port for ground stations."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import tempfile
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.security import SigningKey

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Self

KEY: Final = SigningKey.from_passphrase("attacks")
#: The text that makes tickets for the WebSocket gate, and the address of the stations behind gates.
TICKET_KEY: Final = "attacks on the gate"
STATION: Final = (250, 190)
#: The file of our router in its folder.
CONFIG: Final = "router.toml"
#: The how-to guide whose configuration is attacked, and what differs on this machine.
_GUIDE: Final = Path(__file__).parents[2] / "docs" / "guides" / "firewall.md"
_CHANGES: Final = {
    '"serial:///dev/ttyACM0?baud=921600"': '"udpin://127.0.0.1:{vehicle}"',
    '"udpin://0.0.0.0:14550"': '"udpin://127.0.0.1:{ground}"',
    '"10.1.0.0/16"': '"127.0.0.0/8"',
    'in = "field"': 'in = "{key}"',
    'out = "field"': 'out = "{key}"',
}
#: The same router with a WebSocket gate and a sealed link.
_GATES: Final = """\
[endpoint.gate]
url = "wsin://127.0.0.1:{gate}?ticket_key={folder}/ticket.key&role=operate"
[endpoint.sealed]
url = "sealed+udpin://127.0.0.1:{sealed}?shared_key={folder}/field.key"
[endpoint.tcp]
url = "tcpin://127.0.0.1:{tcp}"
[endpoint.tls]
url = "tlsin://127.0.0.1:{tls}?cert={folder}/cert.pem&key={folder}/key.pem"
[[firewall.rule]]
name = "stations behind gates"
endpoints = ["gate", "sealed", "tcp", "tls"]
systems = [250]
"""
_MAVLINK_ROUTER: Final = """\
[General]
TcpServerPort = 0
[UdpEndpoint vehicle]
Mode = Server
Address = 127.0.0.1
Port = {vehicle}
[UdpEndpoint ground]
Mode = Server
Address = 127.0.0.1
Port = {ground}
[UdpEndpoint other]
Mode = Server
Address = 127.0.0.1
Port = {other}
"""
_OTHER: Final = """\
[endpoint.other]
url = "udpin://127.0.0.1:{other}"
"""


@dataclass(frozen=True, slots=True)
class Ports:
    """The ports of one run.

    Attributes:
        vehicle: The router's port for the vehicle.
        ground: The router's port for ground stations.
        pilot: The port of the ground station.
        gate: The port of the WebSocket gate.
        sealed: The port of the sealed link.
        tcp: The port of a TCP endpoint.
        tls: The port of a TLS endpoint.
        other: The router's port for others, without a firewall.
    """

    vehicle: int
    ground: int
    pilot: int
    gate: int = 0
    sealed: int = 0
    tcp: int = 0
    tls: int = 0
    other: int = 0

    @classmethod
    def free(cls) -> Self:
        """Return ports that are free now, each another one."""
        with ExitStack() as stack:
            probes = [
                stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in fields(cls)
            ]
            for probe in probes:
                probe.bind(("127.0.0.1", 0))
            return cls(*(probe.getsockname()[1] for probe in probes))


@dataclass(frozen=True, slots=True)
class RouterProgram:
    """A router that can be started.

    Attributes:
        name: Its name in the table.
        command: Makes the command line; it may write files into the folder.
    """

    name: str
    command: Callable[[Ports, Path], list[str]]

    @contextmanager
    def running(self, ports: Ports) -> Iterator[Path]:
        """Run the router for the length of a block.

        Args:
            ports: Its ports.

        Yields:
            The folder of its files, when it has bound both ports.
        """
        with tempfile.TemporaryDirectory() as folder:
            environment = {**os.environ, "HOME": folder, "XDG_CONFIG_HOME": folder}
            process = subprocess.Popen(  # noqa: S603 (the command is ours)
                self.command(ports, Path(folder)),
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            try:
                _wait_until_bound(process, ports)
                yield Path(folder)
            finally:
                process.terminate()
                try:
                    process.wait(5)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()


def available(names: list[str]) -> list[RouterProgram]:
    """Return the routers that are installed; ours first.

    Args:
        names: Only these; empty: all.

    Returns:
        The routers.
    """
    programs = [RouterProgram("mavstack", _ours)]
    if shutil.which("mavproxy.py") or (Path(sys.executable).parent / "mavproxy.py").exists():
        programs.append(RouterProgram("MAVProxy", _mavproxy))
    if _mavlink_routerd():
        programs.append(RouterProgram("mavlink-router", _mavlink_router))
    return [program for program in programs if not names or program.name in names]


def with_gates() -> RouterProgram:
    """Return our router with a WebSocket gate and a sealed link."""
    return RouterProgram("mavstack", _ours_with_gates)


def without_signing(program: RouterProgram) -> RouterProgram:
    """Return ours with the firewall of the guide alone; another router as it is."""
    return RouterProgram("mavstack", _ours_unsigned) if program.name == "mavstack" else program


def without_firewall(program: RouterProgram) -> RouterProgram:
    """Return ours with its endpoints alone; another router as it is."""
    return RouterProgram("mavstack", _ours_plain) if program.name == "mavstack" else program


def _guide() -> str:
    """Return the firewall and the gateway of the how-to guide, for this machine."""
    blocks = _GUIDE.read_text("utf-8").split("```toml\n")[1:]
    rules, gateway = (block.split("```")[0] for block in blocks[:2])
    text = rules + "".join(gateway.partition("[endpoint.ground.signing]")[1:])
    for before, after in _CHANGES.items():
        if before not in text:
            raise SystemExit(f"{_GUIDE}: {before} is missing; the attacks run the configuration of the guide")
        text = text.replace(before, after)
    return text


def _ours(ports: Ports, folder: Path) -> list[str]:
    KEY.save(folder / "field.key")
    return _route(ports, folder, _guide())


def _ours_unsigned(ports: Ports, folder: Path) -> list[str]:
    return _route(ports, folder, _guide().partition("[endpoint.ground.signing]")[0])


def _ours_plain(ports: Ports, folder: Path) -> list[str]:
    return _route(ports, folder, _guide().partition("[firewall]")[0] + _OTHER)


def _ours_with_gates(ports: Ports, folder: Path) -> list[str]:
    (folder / "ticket.key").write_text(TICKET_KEY)
    (folder / "ticket.key").chmod(0o600)
    KEY.save(folder / "field.key")
    _make_certificate(folder)
    return _route(ports, folder, _guide() + _GATES)


def _make_certificate(folder: Path) -> None:
    openssl = shutil.which("openssl")
    if openssl is None:
        raise SystemExit("the attacks on gates need the program openssl, which makes a certificate")
    line = "req -x509 -newkey rsa:2048 -nodes -keyout key.pem -out cert.pem -days 2 -subj /CN=127.0.0.1"
    subprocess.run([openssl, *line.split()], cwd=folder, check=True, capture_output=True)  # noqa: S603


def _route(ports: Ports, folder: Path, text: str) -> list[str]:
    config = folder / CONFIG
    config.write_text(text.format(**asdict(ports), folder=folder, key=folder / "field.key"))
    return [sys.executable, "-m", "mavstack", "route", str(config), "--once"]


def _mavproxy(ports: Ports, folder: Path) -> list[str]:
    beside = Path(sys.executable).parent / "mavproxy.py"
    script = str(beside) if beside.exists() else str(shutil.which("mavproxy.py"))
    return [
        sys.executable, script, f"--master=udpin:127.0.0.1:{ports.vehicle}",
        f"--out=udpin:127.0.0.1:{ports.ground}", f"--out=udpin:127.0.0.1:{ports.other}",
        "--daemon", "--non-interactive",
        f"--state-basedir={folder}", "--default-modules=",
    ]  # fmt: skip


def _mavlink_router(ports: Ports, folder: Path) -> list[str]:
    config = folder / "main.conf"
    config.write_text(_MAVLINK_ROUTER.format(**asdict(ports)))
    return [_mavlink_routerd(), "-c", str(config)]


def _mavlink_routerd() -> str:
    return os.environ.get("MAVLINK_ROUTERD") or shutil.which("mavlink-routerd") or ""


def _wait_until_bound(process: subprocess.Popen[bytes], ports: Ports) -> None:
    """Wait until the router has bound its ports."""
    from time import monotonic, sleep

    end = monotonic() + 30
    while not all(map(_is_bound, (ports.vehicle, ports.ground))):
        if process.poll() is not None:
            raise SystemExit(f"the router ended with exit code {process.returncode}")
        if monotonic() > end:
            raise SystemExit("the router did not bind its ports within 30 s")
        sleep(0.05)


def _is_bound(port: int) -> bool:
    """Return whether a UDP port is in use, from the tables of Linux: a probe could be in the router's way."""
    tables = "".join(Path(f"/proc/net/{name}").read_text("ascii") for name in ("udp", "udp6"))
    return f":{port:04X} " in tables
