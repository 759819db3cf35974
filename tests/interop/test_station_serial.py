"""A flight controller at a serial port of the page: flown, unplugged, plugged in, at a wrong baud rate.

Chromium has no serial port here: `navigator.serial` is a stand-in with the streams of a browser, and a
WebSocket carries their bytes to a simulated vehicle that sends nothing but heartbeats until it is asked.
"""

from __future__ import annotations

import socket
import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from mavstack.sim import BackgroundSimulator
from tests.interop.station import DESKTOP, PATIENT, StationPage, station_page, web_server
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from mavstack.sim.vehicle import SimulatedVehicle

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

BAUD_RATE = 57600
#: Defines `navigator.serial` with one port at a WebSocket, whose streams are locked and fail as in Chromium.
SERIAL = """(() => {
  class Port {
    readable = null
    writable = null
    getInfo() { return { usbVendorId: 0x26ac, usbProductId: 0x11 } }
    async open({ baudRate }) {
      if (this.readable) throw new DOMException('The port is already open.', 'InvalidStateError')
      const socket = new WebSocket(`ws://127.0.0.1:PORT/${baudRate}`)
      socket.binaryType = 'arraybuffer'
      await new Promise((resolve, reject) => {
        socket.onmessage = resolve
        socket.onclose = () => reject(new DOMException('Failed to open serial port.', 'NetworkError'))
      })
      this.socket = socket
      this.readable = new ReadableStream({
        start: (source) => {
          socket.onmessage = ({ data }) => source.enqueue(new Uint8Array(data))
          socket.onclose = () => {
            if (this.socket !== socket) return
            this.readable = null
            source.error(new DOMException('The device has been lost.', 'NetworkError'))
          }
        },
      })
      this.writable = new WritableStream({ write: (data) => socket.send(data) })
    }
    async close() {
      if (this.readable?.locked || this.writable?.locked) throw new TypeError('Cannot close a locked stream')
      const { socket } = this
      this.socket = this.readable = this.writable = null
      socket?.close()
    }
  }
  const port = new Port()
  const serial = { requestPort: async () => port, getPorts: async () => (window.isUnplugged ? [] : [port]) }
  Object.defineProperty(navigator, 'serial', { value: serial })
})()"""


@dataclass
class SerialCable:
    """The end of the cable at the vehicle: one program at a time has it."""

    #: Of the vehicle, by UDP.
    port: int
    #: Of the WebSockets.
    end: int = 0
    clients: list[ServerConnection] = field(default_factory=list)

    def handle(self, client: ServerConnection) -> None:
        """Carry bytes in both directions; at a wrong baud rate they are others."""
        if self.clients:
            return
        self.clients.append(client)
        is_right = client.request is not None and client.request.path == f"/{BAUD_RATE}"
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            vehicle.connect(("127.0.0.1", self.port))
            receiver = threading.Thread(target=self._receive, args=(vehicle, client, is_right))
            client.send(b"")
            receiver.start()
            try:
                for data in client:
                    assert isinstance(data, bytes)
                    vehicle.send(data if is_right else bytes(len(data)))
            except ConnectionClosed:
                pass
            finally:
                self.clients.remove(client)
                receiver.join()

    def _receive(self, vehicle: socket.socket, client: ServerConnection, is_right: bool) -> None:
        vehicle.settimeout(0.1)
        while client in self.clients:
            try:
                data = vehicle.recv(2048)
                client.send(data if is_right else bytes(len(data)))
            except TimeoutError:
                continue
            except ConnectionClosed:
                return

    def unplug(self) -> None:
        for client in list(self.clients):
            client.close()


def send_heartbeats_only(vehicle: SimulatedVehicle) -> None:
    """Send as ArduPilot does over USB, where all its stream rates are zero."""
    for stream in ("RAW_SENS", "EXT_STAT", "RC_CHAN", "RAW_CTRL", "POSITION", "EXTRA1", "EXTRA2", "EXTRA3"):
        vehicle.parameters.set(f"SR0_{stream}", 0)


@pytest.fixture
def cable() -> Iterator[SerialCable]:
    simulator = BackgroundSimulator(speed=3)
    send_heartbeats_only(simulator.vehicle)
    make_ready(simulator.simulation)
    with simulator:
        running = SerialCable(simulator.port)
        server = serve(running.handle, "127.0.0.1", 0)
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        running.end = server.socket.getsockname()[1]
        yield running
        running.unplug()
        server.shutdown()
        thread.join()


def connect(shown: StationPage, baud_rate: int) -> None:
    shown.page.get_by_label("Baud rate").select_option(label=f"{baud_rate} baud")
    shown.button("Connect over USB").click(timeout=PATIENT)


def fly(shown: StationPage) -> None:
    """Fly the vehicle by commands of the page itself."""
    page = shown.page
    shown.wait_for("Ready to arm")
    page.get_by_label("Flight mode").select_option("GUIDED")
    shown.button("Set").click()
    page.locator("header .mode").get_by_text("GUIDED").wait_for(timeout=PATIENT)
    shown.hold("Arm")
    page.locator("header").get_by_text("Armed").wait_for(timeout=PATIENT)
    shown.hold("Take off")
    shown.wait_for("Take off: accepted")
    page.locator(".column").get_by_text("in the air").wait_for(timeout=PATIENT)


def refuse_orbit(shown: StationPage) -> None:
    """Try to circle a place: in CIRCLE the copter would sink by its throttle stick."""
    shown.page.mouse.click(720, 380)
    shown.hold("Orbit here")
    shown.wait_for("center the stick")


def read_parameters(shown: StationPage) -> None:
    """Read all parameters of the vehicle, and find one."""
    shown.page.evaluate("location.hash = '#/setup'")
    shown.button("Parameters").click(timeout=PATIENT)
    search = shown.page.get_by_role("searchbox").first
    search.wait_for(timeout=PATIENT)
    search.fill("RTL_ALT")
    shown.page.get_by_text("RTL_ALT", exact=True).first.wait_for(timeout=PATIENT)
    shown.page.evaluate("location.hash = '#/fly'")


@pytest.mark.nightly
def test_a_vehicle_at_a_serial_port_is_flown_and_comes_back(
    cable: SerialCable, browser: Any, tmp_path: Path
) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        page.add_init_script(SERIAL.replace("PORT", str(cable.end)))
        page.reload()
        connect(shown, 115200)
        shown.wait_for("Bytes arrive, but no MAVLink")
        connect(shown, BAUD_RATE)
        fly(shown)
        refuse_orbit(shown)
        read_parameters(shown)
        page.evaluate("window.isUnplugged = true")
        cable.unplug()
        shown.wait_for("Link lost, retrying")
        shown.wait_for("these are the last values")
        page.evaluate("window.isUnplugged = false")
        shown.wait_for("Connected")
        page.get_by_text("these are the last values").wait_for(state="detached", timeout=PATIENT)
        shown.hold("Land")
        page.locator("header").get_by_text("Disarmed").wait_for(timeout=PATIENT)


def test_a_port_that_another_page_has_is_refused(cable: SerialCable, browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as first:
        with station_page(browser, server.url, DESKTOP) as second:
            for shown in (first, second):
                shown.page.add_init_script(SERIAL.replace("PORT", str(cable.end)))
                shown.page.reload()
            connect(first, BAUD_RATE)
            first.wait_for("Ready to arm")
            connect(second, BAUD_RATE)
            second.wait_for("another page or program may have it open")
            second.expect_problems("WebSocket")
            assert second.page.get_by_text("Connected").count() == 1  # still with the station
        first.page.close()
        first.problems.clear()
