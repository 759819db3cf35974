"""rotorpy's own vehicles for PX4 and ArduPilot fly Mavstack's simulated ones."""

from __future__ import annotations

import asyncio
import json
import socket
import struct
import sys
import threading
from types import ModuleType

import numpy as np
import pytest

from tests.simulators.firmwares import free_port
from tests.simulators.foreign.worlds import flown

pytest.importorskip("rotorpy")
pytestmark = pytest.mark.interop

#: Seconds that rotorpy waits for outputs; its own 10 ms lose steps on a busy machine.
PATIENT = 5.0


class Plugin:
    """The module that rotorpy's ArduPilot vehicle needs and no registry has: JSON over UDP, in lockstep."""

    port = 0

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", Plugin.port))
        self.socket.settimeout(PATIENT)
        self.peer, self.number = None, None

    def drain_unread_packets(self):
        """Begin: there is nothing to discard."""

    def pre_update(self, now):
        data, self.peer = self.socket.recvfrom(256)
        values = struct.unpack("<HHI16H", data)
        return True, values[3:]

    def post_update(self, data, now):
        east, north, up = data.sim_position
        v_east, v_north, v_up = data.sim_velocity_inertial
        answer = {
            "timestamp": now,
            "imu": {
                "gyro": [data.xgyro, data.ygyro, data.zgyro],
                "accel_body": [data.xacc, data.yacc, data.zacc],
            },
            "position": [north, east, -up],
            "quaternion": list(data.sim_attitude),
            "velocity": [v_north, v_east, -v_up],
        }
        line = "\n" + json.dumps(answer, separators=(",", ":")) + "\n"
        self.socket.sendto(line.encode(), self.peer)


class Simulation(threading.Thread):
    """Steps of a vehicle of rotorpy in a thread."""

    def __init__(self, make, step):
        super().__init__(daemon=True)
        self._step = step
        self._make, self._stop_event = make, threading.Event()
        self.position = np.zeros(3)

    def run(self):
        vehicle = self._make()
        state = vehicle.initial_state
        while not self._stop_event.is_set():
            try:
                state = vehicle.step(state, {"cmd_motor_speeds": np.zeros(4)}, self._step)
            except (OSError, TimeoutError):
                break
            self.position = state["x"]
        link = getattr(vehicle, "conn", None)
        if link is not None:
            link.close()
            link.listen.close()
        else:
            vehicle.ap_link.socket.close()

    def end(self):
        self._stop_event.set()


async def fly(firmware, port, simulation):
    """Take off, move and land."""
    simulation.start()
    try:
        async with flown(firmware, "copter", port) as (_, vehicle):
            await vehicle.arm()
            await vehicle.takeoff(5)
            assert simulation.position[2] == pytest.approx(5.0, abs=0.8)
            await vehicle.goto(vehicle.position.latitude + 0.0001, vehicle.position.longitude)
            assert simulation.position[1] == pytest.approx(11.1, abs=2.5)
            await vehicle.land()
            assert simulation.position[2] == pytest.approx(0.0, abs=0.1)
            simulation.end()
    finally:
        simulation.end()
        await asyncio.to_thread(simulation.join, 2 * PATIENT)


@pytest.mark.nightly
async def test_rotorpys_px4_vehicle_flies_a_simulated_px4(capsys):
    from rotorpy.vehicles.px4_multirotor import PX4Multirotor
    from rotorpy.vehicles.px4_sihsim_quadx_params import quad_params

    class Vehicle(PX4Multirotor):
        def _fetch_latest_px4_control(self, blocking=True):
            message = self.conn.recv_match(type="HIL_ACTUATOR_CONTROLS", blocking=True, timeout=PATIENT)
            if message is None:
                raise TimeoutError
            return {"cmd_motor_speeds": [each * self.rotor_speed_max for each in message.controls[:4]]}

    port = free_port()
    url = f"tcpin:127.0.0.1:{port}"
    await fly(
        "px4",
        port,
        Simulation(lambda: Vehicle(quad_params, mavlink_url=url, integrator_kwargs={"method": "RK23"}), 0.01),
    )


@pytest.mark.nightly
async def test_rotorpys_ardupilot_vehicle_flies_a_simulated_ardupilot(monkeypatch, capsys):
    module = ModuleType("ArduPilotPlugin")
    module.ArduPilotPlugin = Plugin
    monkeypatch.setitem(sys.modules, "ArduPilotPlugin", module)
    monkeypatch.delitem(sys.modules, "rotorpy.vehicles.ardupilot_multirotor", raising=False)
    from rotorpy.vehicles.ardupilot_multirotor import Ardupilot, x0
    from rotorpy.vehicles.hummingbird_params import quad_params

    monkeypatch.setattr(Plugin, "port", port := free_port())
    start = {name: np.array(value, dtype=float) for name, value in x0.items()}
    await fly(
        "ardupilot",
        port,
        Simulation(
            lambda: Ardupilot(quad_params, start, ardupilot_control=True, enable_ground=True),
            0.004,  # its motors are strong and fast, so that longer steps are too slow for its rates
        ),
    )
