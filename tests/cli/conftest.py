"""Fixtures and packets for the tests of the commands."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest

from mavstack.cli.main import main
from mavstack.dialects import common
from mavstack.wire import Encoder, encode

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from tests.cli.harness import CliHarness

START = 1_700_000_000_000_000


@dataclass(frozen=True)
class Result:
    code: int
    out: str
    err: str


@pytest.fixture
def mav(capsys) -> Callable[..., Result]:
    """Run `mav` in this process."""

    def run(*words: object) -> Result:
        code = main([str(word) for word in words])
        captured = capsys.readouterr()
        return Result(code, captured.out, captured.err)

    return run


@pytest.fixture
def simulate(monkeypatch, tmp_path) -> Callable[..., CliHarness]:
    """Make simulated vehicles that are ready to arm, and an empty cache, for the commands of a test."""
    from tests.cli.harness import CliHarness

    folder = tmp_path / "user-cache"
    monkeypatch.setattr("mavstack.files.parameter_metadata.cache.cache_directory", lambda: folder)
    return lambda *kinds, ready=True, **options: CliHarness(monkeypatch, *kinds, ready=ready, **options)


def stamped(packets: Iterable[bytes], step: int = 100_000) -> bytes:
    """Packets as a tlog, `step` microseconds apart."""
    return b"".join(struct.pack(">Q", START + index * step) + data for index, data in enumerate(packets))


def flight(count: int = 20) -> list[bytes]:
    """Packets of a vehicle and of a ground station, a heartbeat of each first."""
    vehicle, ground = Encoder(1, 1), Encoder(255, 190)
    packets = [
        vehicle.encode(
            common.Heartbeat(
                type=common.MavType.QUADROTOR,
                autopilot=common.MavAutopilot.ARDUPILOTMEGA,
                base_mode=129,
                custom_mode=5,
                system_status=common.MavState.ACTIVE,
                mavlink_version=3,
            )
        ),
        ground.encode(common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID)),
    ]
    packets += [
        vehicle.encode(common.Attitude(time_boot_ms=100 * index, roll=0.5, pitch=float("nan")))
        for index in range(count)
    ]
    return packets


def setup_signing() -> bytes:
    """A packet that carries a key which must never be seen."""
    return encode(
        common.SetupSigning(target_system=1, secret_key=bytes(range(100, 132)), initial_timestamp=987654321),
        system=255,
        component=190,
    )


@pytest.fixture
def tlog(tmp_path: Path) -> Path:
    path = tmp_path / "flight.tlog"
    path.write_bytes(stamped(flight()))
    return path
