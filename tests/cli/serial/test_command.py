"""`mav serial` over real sockets and terminals."""

from __future__ import annotations

import json
import os
import socket
import sys
import threading
import time
from contextlib import contextmanager

import pytest

from mavstack.cli.main import main
from mavstack.gnss import NmeaFramer
from mavstack.sim import BackgroundSimulator

POSITIONS = ("GPGGA", "GPRMC")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


@contextmanager
def tcp(port: int):
    with socket.create_connection(("127.0.0.1", port)) as connection, connection.makefile("rb", 0) as file:
        yield file


class Reader(threading.Thread):
    """Opens a port as soon as it is there, and keeps the sentences that it sends."""

    def __init__(self, connect) -> None:
        super().__init__(daemon=True)
        self._connect = connect
        self.sentences: list[str] = []

    def run(self) -> None:
        framer, end = NmeaFramer(), time.monotonic() + 20
        while time.monotonic() < end and len(self.sentences) < 2:
            try:
                with self._connect() as port:
                    while (data := port.read(200)) and len(self.sentences) < 2:
                        self.sentences += framer.feed(data)
            except OSError:
                time.sleep(0.05)


def mav(capsys, *words, code=0):
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def relayed(capsys, reader, *words):
    reader.start()
    with BackgroundSimulator(airborne=True) as simulator:
        done = mav(capsys, "serial", *words, "--url", simulator.url, "--for", "4")
    reader.join()
    assert [sentence[:5] for sentence in reader.sentences[:2]] == list(POSITIONS)
    return done


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo terminals")
def test_a_port_as_terminal(capsys, tmp_path):
    path = tmp_path / "ttyGPS"
    done = relayed(
        capsys,
        Reader(lambda: os.fdopen(os.open(path, os.O_RDWR | os.O_NOCTTY), "rb", 0)),
        "--device",
        "gps1",
        "--pty",
        str(path),
    )
    assert done.out.startswith(f"gps1 of 1/1 at {path}\n")
    assert not path.exists()


def test_positions_at_a_tcp_port(capsys):
    port = free_port()
    reader = Reader(lambda: tcp(port))
    done = relayed(capsys, reader, "--nmea", "--tcp", f"127.0.0.1:{port}", "--rate", "5", "--json")
    assert json.loads(done.out)["from_vehicle"] > 100


def test_wrong_usage(capsys):
    assert "not a number" in mav(capsys, "serial", "--nmea", "--tcp", "a:b", code=2).err
    assert "--rate must be" in mav(capsys, "serial", "--nmea", "--pty", "x", "--rate", "99", code=2).err
    assert "invalid choice" in mav(capsys, "serial", "--device", "gps7", "--pty", "x", code=2).err
