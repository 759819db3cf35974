"""`mav traffic` with a receiver and a simulated vehicle, over real sockets."""

from __future__ import annotations

import json
import socket
import threading

from mavstack.cli.main import main
from mavstack.sim import BackgroundSimulator
from tests.traffic.test_sbs import NAME

LINE = b"MSG,3,1,1,4CA2D6,1,,,,,,1640,,,47.3995,8.5456,,,0,0,0,0\r\n"


def mav(capsys, *words, code=0):
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def shown(capsys, *words):
    """The output of the command beside a receiver with one aircraft."""
    with socket.create_server(("127.0.0.1", 0)) as server, BackgroundSimulator() as simulator:

        def serve() -> None:
            connection, _ = server.accept()
            with connection:
                connection.sendall(NAME + LINE)
                connection.recv(1)

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        source = f"sbs://127.0.0.1:{server.getsockname()[1]}"
        done = mav(capsys, "traffic", source, "--url", simulator.url, "--for", "8", *words)
        thread.join()
    return done.out


def test_aircraft_and_alarms(capsys):
    text = shown(capsys)
    assert "RYR1427 passes at " in text
    assert "4CA2D6   RYR1427   47.3995" in text
    assert "1 aircraft, 2 reports, " in text


def test_json(capsys):
    found = json.loads(shown(capsys, "--json"))
    assert (found["reports"], found["aircraft"][0]["callsign"]) == (2, "RYR1427")
    assert found["alarms"][0]["system"] == 1
    assert found["sent"] >= 1


def test_wrong_usage(capsys):
    assert "--count must be" in mav(capsys, "traffic", "sbs://a", "--count", "0", code=2).err
