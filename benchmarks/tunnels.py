"""Ways to protect a UDP link between two machines, in one run: packets per second and processor time.

    python -m benchmarks.tunnels --wireguard PROGRAM [--packets 100000] [--turns 3]

Two network namespaces of Linux stand for the machines, so this needs root. A process in each sends or counts
the packets of a flight over a link: plain, sealed, and plain inside of a WireGuard tunnel, for which PROGRAM
(wireguard-go) runs in both namespaces. The processor time is that of all processes, except the work of the
kernel for packets on their way.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Final, NamedTuple

from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey

from mavstack import open_link
from mavstack.links import BytesReceived, ChannelOpened
from mavstack.security import SigningKey

from . import workload

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.links.base import Link
    from mavstack.links.channel import Channel

#: The two namespaces, their addresses, and those inside of the tunnel.
SENDER, RECEIVER = "mavstack-a", "mavstack-b"
OUTSIDE, INSIDE = ("10.77.0.1", "10.77.0.2"), ("10.78.0.1", "10.78.0.2")
PORT, TUNNEL_PORT = 14550, 51820
BURST: Final = 32
#: Bytes under way, which the queue of a tunnel can hold, and those after which the receiver reports.
_MAX_AHEAD, _REPORT = 12 << 10, 2 << 10
#: Seconds without a report after which the bytes under way count as lost.
_REPORT_TIMEOUT: Final = 0.2
_REPORT_SIZE: Final = 8


class Cost(NamedTuple):
    """Packets per second of time, and microseconds of processor time per packet."""

    rate: float
    processor: float


async def _opened(link: Link) -> Channel:
    async for event in link:
        if isinstance(event, ChannelOpened):
            return event.channel
    raise SystemExit("the link ended")


async def send(url: str, count: int) -> None:
    """Send packets; print those that arrived per second, and the processor time in seconds."""
    packets = list(workload.build(count).packets(count))
    reports = bytearray()
    async with open_link(url) as link:
        channel = await _opened(link)
        reader = asyncio.create_task(_collect(link, reports))
        started, used, sent, lost = time.perf_counter(), time.process_time(), 0, 0
        for at in range(0, count, BURST):
            sent += sum(len(packet) for packet in packets[at : at + BURST] if channel.write(packet))
            await asyncio.sleep(0)
            lost += await _wait_for_reports(reports, sent - lost, _MAX_AHEAD)
        lost += await _wait_for_reports(reports, sent - lost, _REPORT)
        arrived = count * (1 - lost / sent)
        print(arrived / (time.perf_counter() - started), time.process_time() - used)
        reader.cancel()


async def receive(url: str) -> None:
    """Count bytes, and report them to the sender, until the process is ended."""
    received, reported = 0, 0
    async with open_link(url) as link:
        print("ready", flush=True)
        async for event in link:
            if not isinstance(event, BytesReceived):
                continue
            received += len(event.data)
            if received - reported >= _REPORT:
                reported = received
                event.channel.write(received.to_bytes(_REPORT_SIZE))


async def _wait_for_reports(reports: bytearray, sent: int, ahead: int) -> int:
    """Wait until at most so many bytes are under way; return the bytes that count as lost."""
    deadline, known = time.perf_counter() + _REPORT_TIMEOUT, _reported(reports)
    while sent - known > ahead:
        if time.perf_counter() > deadline:
            return sent - known
        await asyncio.sleep(0)
        if (reported := _reported(reports)) != known:
            deadline, known = time.perf_counter() + _REPORT_TIMEOUT, reported
    return 0


async def _collect(link: Link, reports: bytearray) -> None:
    async for event in link:
        if isinstance(event, BytesReceived):
            reports += event.data
            del reports[:-_REPORT_SIZE]


def _reported(reports: bytearray) -> int:
    return int.from_bytes(reports)


def _run(*words: str) -> None:
    subprocess.run(words, check=True, capture_output=True)


@contextmanager
def _namespaces() -> Iterator[None]:
    """Make two namespaces with a cable between them."""
    try:
        for name in (SENDER, RECEIVER):
            _run("ip", "netns", "add", name)
        _run(
            "ip",
            "-n",
            SENDER,
            "link",
            "add",
            "cable",
            "type",
            "veth",
            "peer",
            "name",
            "cable",
            "netns",
            RECEIVER,
        )
        for name, address in zip((SENDER, RECEIVER), OUTSIDE, strict=True):
            _run("ip", "-n", name, "address", "add", f"{address}/24", "dev", "cable")
            _run("ip", "-n", name, "link", "set", "cable", "up")
        yield
    finally:
        for name in (SENDER, RECEIVER):
            subprocess.run(["ip", "netns", "del", name], check=False, capture_output=True)


@contextmanager
def _tunnel(program: str) -> Iterator[list[int]]:
    """Run a WireGuard tunnel between the namespaces; yield the ids of its processes."""
    keys = [X25519PrivateKey.generate() for _ in OUTSIDE]
    with ExitStack() as stack:
        processes = []
        for index, name in enumerate((SENDER, RECEIVER)):
            device = f"wg-{name[-1]}"
            words = ["ip", "netns", "exec", name, program, "--foreground", device]
            environment = {**os.environ, "LOG_LEVEL": "error"}
            process = subprocess.Popen(words, env=environment, stderr=subprocess.DEVNULL)
            stack.callback(process.wait)
            stack.callback(process.terminate)
            processes.append(process.pid)
            _configure(device, keys[index], keys[1 - index], OUTSIDE[1 - index], INSIDE[1 - index])
            _run("ip", "-n", name, "address", "add", f"{INSIDE[index]}/24", "dev", device)
            _run("ip", "-n", name, "link", "set", device, "mtu", "1420", "up")
        yield processes


def _configure(device: str, key: X25519PrivateKey, peer: X25519PrivateKey, host: str, inside: str) -> None:
    """Give a WireGuard program its keys, over its socket."""
    lines = [
        "set=1",
        f"private_key={key.private_bytes_raw().hex()}",
        f"listen_port={TUNNEL_PORT}",
        f"public_key={peer.public_key().public_bytes_raw().hex()}",
        f"endpoint={host}:{TUNNEL_PORT}",
        f"allowed_ip={inside}/32",
    ]
    path = Path("/var/run/wireguard") / f"{device}.sock"
    end = time.monotonic() + 10
    while not path.exists():
        if time.monotonic() > end:
            raise SystemExit(f"there is no {path}: the WireGuard program did not start")
        time.sleep(0.05)
    with socket.socket(socket.AF_UNIX) as control:
        control.connect(str(path))
        control.sendall("\n".join([*lines, "", ""]).encode())
        if b"errno=0" not in (answer := control.recv(4096)):
            raise SystemExit(f"the WireGuard program refuses its keys: {answer!r}")


def _processor(processes: list[int]) -> float:
    """Return the processor time of processes in seconds."""
    ticks = 0
    for process in processes:
        fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def _measure(listening: str, connecting: str, packets: int, others: list[int]) -> Cost:
    """Send packets from one namespace to the other."""
    module = [sys.executable, "-m", "benchmarks.tunnels"]
    words = ["ip", "netns", "exec", RECEIVER, *module, "--receive", listening]
    receiver = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    try:
        assert receiver.stdout is not None
        receiver.stdout.readline()
        processes = [receiver.pid, *others]
        before = _processor(processes)
        words = ["ip", "netns", "exec", SENDER, *module, "--send", connecting, "--packets", str(packets)]
        sender = subprocess.run(words, capture_output=True, text=True, check=True, timeout=300)
        processor = _processor(processes) - before
    finally:
        receiver.terminate()
        receiver.wait()
    rate, used = map(float, sender.stdout.split())
    return Cost(rate, (processor + used) / packets * 1e6)


def main() -> None:
    """Measure in turns, and print a line for each way."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.tunnels")
    parser.add_argument("--wireguard", metavar="PROGRAM", help="wireguard-go, or another with its socket")
    parser.add_argument("--packets", type=int, default=100_000)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--send", metavar="URL", help=argparse.SUPPRESS)
    parser.add_argument("--receive", metavar="URL", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.send or options.receive:
        asyncio.run(send(options.send, options.packets) if options.send else receive(options.receive))
        return
    if os.geteuid() or shutil.which("ip") is None:
        raise SystemExit("network namespaces need root, and the program ip")
    for name, costs in _turns(options).items():
        rate, processor = (median(each) for each in zip(*costs, strict=True))
        print(f"{name:12} {rate:>9,.0f} packets/s {processor:>7.1f} us of processor time per packet")


def _turns(options: argparse.Namespace) -> dict[str, list[Cost]]:
    costs: dict[str, list[Cost]] = {}
    with tempfile.TemporaryDirectory(prefix="mavstack-bench-") as folder, ExitStack() as stack:
        key = Path(folder) / "bench.key"
        SigningKey.generate().save(key)
        stack.enter_context(_namespaces())
        others = stack.enter_context(_tunnel(options.wireguard)) if options.wireguard else []
        ways: dict[str, tuple[str, str, str, list[int]]] = {
            "plain": ("", OUTSIDE[1], "", []),
            "sealed": ("sealed+", OUTSIDE[1], f"?shared_key={key}", []),
            "sealed, AES": ("sealed+", OUTSIDE[1], f"?shared_key={key}&cipher=aes256", []),
        }
        if others:
            ways["WireGuard"] = ("", INSIDE[1], "", others)
        for _ in range(options.turns):
            for name, (prefix, host, query, used) in ways.items():
                urls = [f"{prefix}{kind}://{host}:{PORT}{query}" for kind in ("udpin", "udpout")]
                costs.setdefault(name, []).append(_measure(urls[0], urls[1], options.packets, used))
    return costs


if __name__ == "__main__":
    main()
