"""Attacks on a ground station (`mav web`) by its observers and by strangers, with a simulated vehicle.

The delays are those of a pilot's disarm, the worst of several, from the request to the vehicle's answer. They
are times of this machine: look at them beside the delay without an attack, and beside the processor time that
the station used meanwhile, which other programs of the machine hardly change.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from socket import SHUT_RDWR
from time import monotonic, sleep
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.security.tickets import SUBPROTOCOL
from mavstack.wire import Encoder
from tools.attacks.websocket import frame, requested

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Iterator, Mapping

#: Passwords by role.
_PASSWORDS: Final = {"observe": "attacks of observers", "operate": "commands of pilots"}
#: Half requests of one address, streams of one observer, readers of plans, and packets of a flood at a time.
_HALF_REQUESTS: Final = 600
_STREAMS: Final = 530
_READERS: Final = 10
_BURST: Final = 1000
_DISARMS: Final = 5
_START_TIMEOUT: Final = 60.0
#: Definitions that are sent at a time, messages of each, seconds for all, and statuses of answers.
_BOMBS: Final = 3
_BOMB_MESSAGES: Final = 38_000
_GENERATION_TIMEOUT: Final = 45.0
_DONE: Final = 200
_REFUSED: Final = 400
_PLAN: Final = "QGC WPL 110\n" + "".join(
    f"{number}\t0\t3\t16\t0\t0\t0\t0\t47.397\t{8.545 + number / 1e4:.4f}\t20\t1\n" for number in range(50)
)


@dataclass(frozen=True, slots=True)
class Client:
    """A session of a station.

    Attributes:
        port: The port of the station.
        token: The token of the session.
        ticket: A ticket for one WebSocket.
    """

    port: int
    token: str = ""
    ticket: str = ""

    def ask(self, method: str, path: str, body: object = None) -> tuple[int, Any]:
        """Send a request on a new connection; return the status and the value of the answer."""
        connection = HTTPConnection("127.0.0.1", self.port, timeout=20)
        headers = {"Authorization": f"Bearer {self.token}"} if self.token else {}
        try:
            text = body if body is None or isinstance(body, str) else json.dumps(body)
            connection.request(method, path, text, {**headers, "Content-Type": "application/json"})
            answer = connection.getresponse()
            data = answer.read()
            return answer.status, json.loads(data) if data else None
        finally:
            connection.close()

    def open_stream(self) -> socket.socket | None:
        """Open a stream of messages, and return its connection."""
        connection = HTTPConnection("127.0.0.1", self.port, timeout=5)
        path = "/api/vehicles/1/messages/ATTITUDE/stream"
        with suppress(OSError, HTTPException):
            connection.request("GET", path, headers={"Authorization": f"Bearer {self.token}"})
        return connection.sock


class StationRange:
    """A station with a vehicle, a pilot and an observer.

    Args:
        port: The port of the station.
        process: The id of its process.
    """

    def __init__(self, port: int, process: int) -> None:
        self._process = process
        #: The most processor time in milliseconds that the station used for one disarm and all that ran
        #: before it: on a machine without other work this is the delay.
        self.processor_time = 0.0
        self.stranger = Client(port)
        self.pilot, self.observer = self.log_in("operate"), self.log_in("observe")
        self._wait_for_vehicle()

    def log_in(self, role: str) -> Client:
        """Begin a session."""
        status, begun = self.stranger.ask("POST", "/api/session", {"password": _PASSWORDS[role]})
        if status >= 300:
            raise SystemExit(f"mavstack: the station refuses a session: {begun}")
        return Client(self.stranger.port, begun["token"], begun["ticket"])

    def disarm_delay(self) -> float:
        """Return the worst delay of the pilot's disarm in milliseconds."""
        self.processor_time = 0.0
        return max(self._disarm() for _ in range(_DISARMS))

    def _disarm(self) -> float:
        began, used = monotonic(), self._used()
        with suppress(OSError, HTTPException):
            self.pilot.ask("POST", "/api/vehicles/1/disarm", {})
        self.processor_time = max(self.processor_time, round(self._used() - used, 1))
        return round((monotonic() - began) * 1000, 1)

    def _used(self) -> float:
        """Return the processor time of the station so far in milliseconds; 0 where it is not known."""
        threads = Path(f"/proc/{self._process}/task").glob("*/schedstat")
        return sum(int(each.read_text().split()[0]) for each in threads) / 1e6

    def _wait_for_vehicle(self) -> None:
        end = monotonic() + _START_TIMEOUT
        while self.pilot.ask("GET", "/api/vehicles/1")[0] != 200:
            if monotonic() > end:
                raise SystemExit("mavstack: the station does not find its vehicle")
            sleep(0.2)
        self.pilot.ask("POST", "/api/vehicles/1/disarm", {})


def no_attack(field: StationRange) -> float:
    """Return the delay without an attack."""
    return field.disarm_delay()


def half_requests(field: StationRange) -> float:
    """Send 600 half requests from one address."""
    import socket

    with ExitStack() as stack:
        for _ in range(_HALF_REQUESTS):
            connection = stack.enter_context(socket.create_connection(("127.0.0.1", field.pilot.port)))
            with suppress(OSError):
                connection.sendall(b"GET /api/vehicles HTTP/1.1\r\nHost: 127.0.0.1\r\n")
        return field.disarm_delay()


def requests_of_observer(field: StationRange) -> float:
    """Ask for all parameters without a pause on a WebSocket of an observer."""
    packet = Encoder(200, 190).encode(common.ParamRequestList(target_system=1, target_component=1))
    burst, end = frame(packet * _BURST), threading.Event()
    protocols = (SUBPROTOCOL, field.observer.ticket, "mavstack.raw.1")
    with requested(field.observer.port, *protocols, path="/ws") as (connection, accepted):
        if not accepted:
            raise SystemExit("mavstack: an observer gets no WebSocket")

        def flood() -> None:
            with suppress(OSError):  # the station closes it, or does not read for 5 s
                while not end.is_set():
                    connection.sendall(burst)

        flooding = threading.Thread(target=flood)
        flooding.start()
        sleep(0.5)
        delay = field.disarm_delay()
        end.set()
        connection.shutdown(SHUT_RDWR)
        flooding.join()
    return delay


def streams_of_observer(field: StationRange) -> float:
    """Open 530 streams of events as one observer."""
    with ExitStack() as stack:
        for _ in range(_STREAMS):
            if (connection := field.observer.open_stream()) is not None:
                stack.callback(connection.close)
        return field.disarm_delay()


def readers_of_plans(field: StationRange) -> float:
    """Read the mission without a pause on 10 connections of an observer."""
    with _readers(field):
        return field.disarm_delay()


def upload_beside_readers(field: StationRange) -> float:
    """Return the duration in milliseconds of an upload of 50 items beside 10 readers of plans."""
    with _readers(field):
        began = monotonic()
        status, answer = field.pilot.ask("PUT", "/api/vehicles/1/mission", _PLAN)
        if status != 200:
            raise SystemExit(f"mavstack: the station refuses a mission: {answer}")
        return round((monotonic() - began) * 1000, 1)


@contextmanager
def _readers(field: StationRange) -> Iterator[None]:
    end = threading.Event()

    def read() -> None:
        while not end.is_set():
            with suppress(OSError, HTTPException):
                field.observer.ask("GET", "/api/vehicles/1/mission")

    threads = [threading.Thread(target=read) for _ in range(_READERS)]
    for thread in threads:
        thread.start()
    try:
        sleep(0.5)
        yield
    finally:
        end.set()
        for thread in threads:
            thread.join()


def generator_bombs(field: StationRange) -> float:
    """Return the delay while three definitions of 2.8 MB are in the generator."""
    with ThreadPoolExecutor(_BOMBS) as pool:
        answers = [pool.submit(_generate, field, _bomb()) for _ in range(_BOMBS)]
        sleep(0.5)
        delay = field.disarm_delay()
        for answer in answers:
            answer.result()
    return delay


def bombs_that_hold(field: StationRange) -> float:
    """Send three such definitions; count those not refused, and a form that is not answered behind them."""
    bomb = _bomb()
    with ThreadPoolExecutor(_BOMBS) as pool:
        answers = [pool.submit(_generate, field, bomb) for _ in range(_BOMBS)]
        held = sum(answer.result() != _REFUSED for answer in answers)
    return held + (_generate(field, None) != _DONE)


def _bomb() -> str:
    """Return a definition of 2.8 MB: many small messages, each of which would become many lines of code."""
    each = '<message id="{0}" name="M{0}"><field type="uint8_t" name="a"/></message>'
    listed = "".join(each.format(number) for number in range(1, _BOMB_MESSAGES))
    return f"<mavlink><messages>{listed}</messages></mavlink>"


def _generate(field: StationRange, definition: str | None) -> int:
    """Have a library generated; return the status of the answer, 0 if it takes too long."""
    connection = HTTPConnection("127.0.0.1", field.pilot.port, timeout=_GENERATION_TIMEOUT)
    headers = {"Authorization": f"Bearer {field.pilot.token}", "Content-Type": "application/xml"}
    try:
        connection.request("POST", "/api/generator?languages=c&dialect=minimal", definition, headers)
        return connection.getresponse().status
    except OSError:
        return 0
    finally:
        connection.close()


def files_by_errors(field: StationRange) -> float:
    """Ask for links with keys and certificates; count the options whose error says whether a file exists."""
    options = ("signing_key", "ca", "cert")
    answers = [
        {_error(field, option, path) for path in ("/etc/passwd", "/no/such/file")} for option in options
    ]
    return sum(len(each) - 1 for each in answers)


def _error(field: StationRange, option: str, path: str) -> str:
    _, answer = field.pilot.ask("POST", "/api/sources", {"url": f"tlsin://127.0.0.1:0?{option}={path}"})
    return json.dumps(answer).replace(path, "PATH")


#: Attacks whose figure is the worst delay of a disarm in milliseconds.
DELAYS: Final[Mapping[str, Callable[[StationRange], float]]] = MappingProxyType(
    {
        "disarm by a station, no attack": no_attack,
        "600 half requests of one address": half_requests,
        "requests of an observer without a pause": requests_of_observer,
        "530 streams of one observer": streams_of_observer,
        "10 readers of plans": readers_of_plans,
        "10 readers of plans: upload of 50 items": upload_beside_readers,
        "3 definitions of 2.8 MB in the generator": generator_bombs,
    }
)
#: The end of the names of figures of processor time.
PROCESSOR_TIME: Final = ", processor time"
#: Attacks that count what passed.
STATION: Final[Mapping[str, Callable[[StationRange], float]]] = MappingProxyType(
    {
        "files that exist, by errors of a station": files_by_errors,
        "3 definitions of 2.8 MB: not refused, or in the way": bombs_that_hold,
    }
)


def delays(field: StationRange) -> dict[str, float]:
    """Run the attacks on the delay of a disarm; return delays, and the station's processor time for each."""
    results: dict[str, float] = {}
    for name, scenario in DELAYS.items():
        field.processor_time = 0.0
        results[name] = scenario(field)
        if field.processor_time:
            results[name + PROCESSOR_TIME] = field.processor_time
    return results


@contextmanager
def opened_station() -> Iterator[StationRange]:
    """Run a station with a simulated vehicle.

    Yields:
        The range.
    """
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        passwords = Path(folder) / "passwords.txt"
        passwords.write_text("".join(f"{role} {text}\n" for role, text in _PASSWORDS.items()))
        passwords.chmod(0o600)
        link = Path(folder) / "vehicle"
        stack.enter_context(running_program("sim", "--out", f"unixin://{link}", "--json"))
        end = monotonic() + _START_TIMEOUT
        while not link.exists() and monotonic() < end:
            sleep(0.05)
        options = ("--no-browser", "--port", "0", "--json", "--folder", folder, "--password", str(passwords))
        process = stack.enter_context(running_program("web", f"unix://{link}", *options))
        address = json.loads(process.stdout.readline()) if process.stdout is not None else {}
        yield StationRange(int(address["port"]), process.pid)


@contextmanager
def running_program(*words: str) -> Iterator[subprocess.Popen[str]]:
    """Run `mav` with some words; yield the process."""
    command = [sys.executable, "-m", "mavstack", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True) as process:  # noqa: S603
        try:
            yield process
        finally:
            process.terminate()
