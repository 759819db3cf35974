"""MAVProxy flies simulated vehicles with its default modules and reports no error.

MAVProxy reads one datagram at a time and loses some on a busy machine, some of them for ever, so these tests
connect by TCP. Its timeouts run in real time, so the vehicles fly faster only while the test waits for them.
"""

from __future__ import annotations

from contextlib import asynccontextmanager, closing, contextmanager
from math import degrees

import pytest
from pymavlink import DFReader, mavwp

from mavstack.services.mission import PlanType
from mavstack.sim import Firmware, Simulation
from mavstack.sim.telemetry.px4 import LinkMode, set_link_mode
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.simulated import MAX_FLIGHT_TIME, Flight
from tests.sim.running import running

pytestmark = [pytest.mark.interop, pytest.mark.timeout(240), needs_mavproxy]

#: Simulated seconds per real second while a vehicle flies.
FLYING_SPEED = 8.0
WAYPOINT, TURNS, HOLD_TIME, RETURN, LAND, TAKE_OFF, SPEED_CHANGE = 16, 18, 19, 20, 21, 22, 178
LAND_START, INSIDE, OUTSIDE, RALLY = 189, 5001, 5004, 5100
ABOVE_SEA, NO_PLACE, ABOVE_HOME = 0, 2, 3


class MavproxyFlight(Flight):
    """A simulated vehicle and the console of MAVProxy."""

    flying_speed = FLYING_SPEED

    @property
    def home_first(self) -> bool:
        return self.vehicle.firmware is Firmware.ARDUPILOT

    @property
    def state(self) -> str:
        """The state of the vehicle and the latest console output."""
        return f"{super().state}; MAVProxy: {self.ground.printed[-2000:]}"

    @contextmanager
    def faster(self):
        """Run faster than real time; not for conversations, whose timeouts are in real time."""
        speed, self.runner.speed = self.runner.speed, self.flying_speed
        yield
        self.runner.speed = speed

    async def wait_until(self, condition, timeout: float = MAX_FLIGHT_TIME) -> None:
        """Wait, at the speed of flights, until a condition holds; `timeout` is in simulated seconds."""
        with self.faster():
            await super().wait_until(condition, timeout)

    async def fly_until_output(self, *expected: str) -> None:
        """Wait, at the speed of flights, for texts in this order."""
        with self.faster():
            await self.ground.wait_for_output(*expected)

    async def send_and_wait(self, line: str, *expected: str) -> None:
        """Send a line and wait for its output."""
        self.ground.send_line(line)
        await self.ground.wait_for_output(*expected)

    async def set_mode(self, name: str) -> None:
        self.ground.send_line(f"mode {name.lower()}")
        await self.wait_until(lambda: self.vehicle.autopilot.mode.name == name)

    async def arm(self) -> None:
        await self.wait_until(lambda: self.can_arm)
        await self.send_and_wait("arm throttle", "COMPONENT_ARM_DISARM: ACCEPTED", "ARMED")
        assert self.vehicle.autopilot.armed

    async def wait_until_disarmed(self) -> None:
        """Wait until the vehicle disarms by itself."""
        await self.wait_until(lambda: not self.vehicle.autopilot.armed)
        await self.fly_until_output("DISARMED")

    async def wait_for_parameters(self) -> None:
        """Wait for the initial parameter download, by FTP."""
        count = len(self.vehicle.parameters)
        await self.ground.wait_for_output(
            "Detected vehicle 1:1", f"Received {count} parameters (ftp)", f"Saved {count} parameters to"
        )

    async def load_plan(self, command: str, *items: tuple) -> None:
        """Write a plan file, upload the plan by a MAVProxy command (wp, fence, rally), and list it."""
        path = self.ground.directory / f"{command}.plan"
        path.write_text("".join(self._lines(items)))
        noun = {"wp": "waypoints", "fence": "fence items", "rally": "rally items"}[command]
        number = len(items) + (command == "wp" and self.home_first)
        await self.send_and_wait(f"{command} load {path}", f"Sent all {number} {noun}", ": ACCEPTED")
        await self.ground.send_until_answered(
            f"{command} list", f"Requesting {number} ", f"Saved {number} {noun}"
        )

    def _lines(self, items: tuple):
        """Yield the lines of a waypoint file; ArduPilot's first waypoint is home."""
        yield "QGC WPL 110\n"
        if items[0][0] < INSIDE and self.home_first:
            items = ((WAYPOINT, (), 0, 0, 488, ABOVE_SEA), *items)
        for seq, (command, leading_params, north, east, height, *frame) in enumerate(items):
            latitude, longitude, _ = self.place(north, east)
            params = (*leading_params, 0, 0, 0, 0)[:4]
            values = (seq, 0, *(frame or (ABOVE_HOME,)), command, *params, latitude, longitude, height, 1)
            yield "\t".join(map(str, values)) + "\n"

    async def download_log(self) -> bytes:
        """Download the log by the log protocol."""
        await self.wait_until(lambda: not self.vehicle.storage.logs.writing)  # until the log is complete
        await self.ground.send_until_answered("log list", "numLogs 1")
        number = self.vehicle.storage.logs.logs()[0].id
        await self.send_and_wait(f"log download {number} fetched", "Finished downloading fetched")
        fetched = (self.ground.directory / "fetched").read_bytes()
        store = self.vehicle.storage.logs
        assert fetched == store.read(number, 0, store.logs()[0].size)
        return fetched


@asynccontextmanager
async def mavproxy_flight(kind: str, firmware: str, directory, **parameters):
    """Yield a simulated vehicle with these parameters and MAVProxy connected to it."""
    simulation = Simulation()
    vehicle = simulation.add(kind, firmware)
    if vehicle.firmware is Firmware.PX4:
        set_link_mode(vehicle, LinkMode.NORMAL)  # MAVProxy takes long for the messages of a fast link
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    async with (
        running(simulation, "tcpin://127.0.0.1:0") as simulated,
        mavproxy(simulated.link.address[1], directory, transport="tcp") as console,
    ):
        yield MavproxyFlight(vehicle, console, simulated)


async def test_a_copter(tmp_path) -> None:
    async with mavproxy_flight("copter", "ardupilot", tmp_path) as flight:
        await flight.wait_for_parameters()
        await check_parameters(flight)
        await check_plans(flight)
        await fly_mission(flight)
        await check_log(flight)
        await fly_guided(flight)
        await check_maintenance_commands(flight)
        await check_reboot(flight)
        assert not flight.ground.errors(
            "MAV Errors: 0", "AHRS {", "SYS_STATUS {", "COMM_STATUS {", "CONTROLLER_OUTPUT {"
        )


async def check_parameters(flight: MavproxyFlight) -> None:
    parameters, ground = flight.vehicle.parameters, flight.ground
    ground.send_line("param set WPNAV_SPEED 700")
    await flight.wait_until(lambda: parameters["WPNAV_SPEED"] == 700)
    await ground.send_until_answered("param fetch WPNAV_SPEED", "WPNAV_SPEED = 700.0")
    await flight.send_and_wait("param show WPNAV_SPEED", "WPNAV_SPEED      700.0")
    ground.send_line("set param_ftp False")
    await flight.send_and_wait("param fetch", f"Received {len(parameters)} parameters\n")
    await flight.send_and_wait("param save saved.parm", f"Saved {len(parameters)} parameters to saved.parm")
    await flight.send_and_wait("param load saved.parm", "(changed 0)")


async def check_plans(flight: MavproxyFlight) -> None:
    await flight.load_plan(
        "wp",
        (TAKE_OFF, (), 0, 0, 15),
        (WAYPOINT, (), 40, 0, 15),
        (SPEED_CHANGE, (1, 4, -1), 0, 0, 0),
        (WAYPOINT, (2,), 40, 30, 18),
        (TURNS, (1, 0, 8), 40, 30, 18),
        (WAYPOINT, (), 10, 30, 15),
        (RETURN, (), 0, 0, 0),
    )
    await flight.send_and_wait("wp save saved.txt", "Saved 8 waypoints to saved.txt")
    loader = mavwp.MAVWPLoader()
    assert loader.load(str(flight.ground.directory / "saved.txt")) == 8
    commands = [TAKE_OFF, WAYPOINT, SPEED_CHANGE, WAYPOINT, TURNS, WAYPOINT, RETURN]
    assert [loader.wp(seq).command for seq in range(1, 8)] == commands
    assert loader.wp(2).x == pytest.approx(flight.place(40, 0)[0], abs=1e-6)
    corners = [(-300, -300), (300, -300), (300, 300), (-300, 300)]
    fence = [(INSIDE, (4,), *corner, 0, ABOVE_SEA) for corner in corners]
    await flight.load_plan("fence", *fence, (OUTSIDE, (20,), 150, 150, 0, ABOVE_SEA))
    await flight.send_and_wait("fence enable", "DO_FENCE_ENABLE: ACCEPTED", "fence enabled")
    assert flight.vehicle.parameters["FENCE_ENABLE"] == 1 or flight.vehicle.autopilot.fence.enabled
    await flight.load_plan("rally", (RALLY, (), 5, 20, 20), (RALLY, (), 200, 0, 20))
    latitude, longitude, _ = flight.place(100, 100)
    flight.ground.send_line(f"click {latitude} {longitude}")
    await flight.send_and_wait("rally add 25", "TYPE_RALLY: ACCEPTED")
    assert len(flight.vehicle.mission.plan(PlanType.RALLY)) == 3


async def fly_mission(flight: MavproxyFlight) -> None:
    await flight.set_mode("GUIDED")
    await flight.arm()
    await flight.send_and_wait("mode auto", "DO_SET_MODE: ACCEPTED", "AP: Mission: 1 Takeoff")
    await flight.wait_until_disarmed()  # MAVProxy prints most status texts of the mission, and loses some
    for text in (
        "Mission: 1 Takeoff",
        "Mission: 2 WP",
        "Reached command #2",
        "Mission: 5 LoitTurns",
        "Mission: 7 RTL",
    ):
        assert flight.texts.count(text) == 1, text
    assert flight.distance(5, 20) < 2  # the nearest rally point


async def check_log(flight: MavproxyFlight) -> None:
    fetched = await flight.download_log()
    with closing(DFReader.DFReader_binary(str(flight.ground.directory / "fetched"))) as log:
        assert log.recv_match(type="PARM", condition="PARM.Name=='WPNAV_SPEED'").Value == 700
        log.rewind()
        heights = [entry.RelHomeAlt for entry in iter(lambda: log.recv_match(type="POS"), None)]
    assert max(heights) == pytest.approx(18, abs=1)
    await flight.ground.send_until_answered("ftp list /APM/LOGS", "00000001.BIN", "Total size")
    await flight.send_and_wait("ftp get /APM/LOGS/00000001.BIN", f"Wrote {len(fetched)} bytes")
    copied = flight.ground.directory / "00000001.BIN"
    await flight.wait_until(lambda: copied.read_bytes() == fetched)  # printed before the file is closed


async def fly_guided(flight: MavproxyFlight) -> None:
    truth = lambda: flight.vehicle.body.truth  # noqa: E731
    await flight.set_mode("GUIDED")
    await flight.arm()
    await flight.send_and_wait("takeoff 12", "NAV_TAKEOFF: ACCEPTED")
    await flight.wait_until(lambda: flight.height > 11)
    latitude, longitude, _ = flight.place(30, 20)
    await flight.send_and_wait(f"guided {latitude} {longitude} 16", "DO_REPOSITION: ACCEPTED")
    await flight.wait_until(lambda: flight.distance(30, 20) < 1.5 and abs(flight.height - 16) < 1)
    flight.ground.send_line("setyaw 90 30 0")
    await flight.wait_until(lambda: abs(degrees(truth().yaw) - 90) < 5)
    await flight.send_and_wait("setspeed 3", "DO_CHANGE_SPEED: ACCEPTED")
    flight.ground.send_line("position 12 0 0")
    await flight.wait_until(lambda: flight.distance(30, 32) < 1.5)
    flight.ground.send_line("velocity 0 2 0")
    await flight.wait_until(lambda: truth().velocity_north < -1.5)
    flight.ground.send_line("rc 3 1500")
    await flight.wait_until(lambda: flight.vehicle.autopilot.radio.channels[2] == 1500)
    await flight.set_mode("LOITER")
    await flight.wait_until(lambda: flight.speed < 0.5)
    flight.ground.send_line("rc 1 1700")
    await flight.wait_until(lambda: truth().velocity_north < -1.5)
    flight.ground.send_line("rc 1 1500")
    await flight.send_and_wait("rtl", "DO_SET_MODE: ACCEPTED", "Mode RTL")
    await flight.set_mode("LAND")
    await flight.wait_until_disarmed()
    flight.ground.send_line("rc clear")
    await flight.wait_until(lambda: flight.vehicle.autopilot.radio.channels[2] == 1000)


async def check_maintenance_commands(flight: MavproxyFlight) -> None:
    vehicle = flight.vehicle
    await flight.set_mode("STABILIZE")
    await flight.send_and_wait("switch 2", "PWM=1295")
    await flight.wait_until(lambda: vehicle.autopilot.mode.number == vehicle.parameters["FLTMODE2"])
    await flight.send_and_wait("switch 0", "Disabled RC switch override")
    for command in ("calpress", "gyrocal", "ahrstrim"):
        await flight.send_and_wait(command, "PREFLIGHT_CALIBRATION: ACCEPTED", "Calibrated")
    await flight.send_and_wait("servo set 9 1700", "DO_SET_SERVO: ACCEPTED")
    await flight.send_and_wait("long MAV_CMD_DO_SET_SERVO 10 1600", "DO_SET_SERVO: ACCEPTED")
    await flight.fly(3)
    await flight.send_and_wait("status SERVO_OUTPUT_RAW", "servo9_raw : 1700, servo10_raw : 1600")
    await flight.send_and_wait("relay set 0 1", "DO_SET_RELAY: ACCEPTED")
    await flight.send_and_wait("motortest 1 0 20 2", "DO_MOTOR_TEST: ACCEPTED")
    await flight.send_and_wait("batreset", "BATTERY_RESET: ACCEPTED")
    await flight.fly(3)
    await flight.send_and_wait("arm prearms", "RUN_PREARM_CHECKS: ACCEPTED")
    await flight.send_and_wait("arm safetystatus", "Safety is OFF")
    await flight.send_and_wait("version")
    await flight.fly(3)
    await flight.send_and_wait("status AUTOPILOT_VERSION", "AUTOPILOT_VERSION {capabilities")
    for command in ("fence", "rally", "wp"):
        await flight.send_and_wait(f"{command} clear", ": ACCEPTED")
    assert not any(len(vehicle.mission.plan(kind)) for kind in PlanType)
    for query in ("status", "module list", "bat", "alt", "time", "terrain status", "devid", "arm list"):
        flight.ground.send_line(query)


async def check_reboot(flight: MavproxyFlight) -> None:
    await flight.send_and_wait("reboot", "PREFLIGHT_REBOOT_SHUTDOWN: ACCEPTED")
    await flight.fly_until_output("AP: ArduPilot Ready", "is using GPS")
    await flight.set_mode("GUIDED")
    assert flight.vehicle.boots == 2


async def test_a_plane(tmp_path) -> None:
    async with mavproxy_flight("plane", "ardupilot", tmp_path) as flight:
        await flight.wait_for_parameters()
        await flight.load_plan(
            "wp",
            (TAKE_OFF, (10,), 0, 0, 40),
            (WAYPOINT, (), 400, 0, 60),
            (TURNS, (1, 0, 60), 400, 300, 60),
            (LAND_START, (), 0, 0, 0, ABOVE_SEA),
            (WAYPOINT, (), -450, 0, 25),
            (LAND, (), 0, 0, 0),
        )
        await flight.set_mode("AUTO")
        await flight.arm()
        await flight.wait_until(lambda: "Mission: 1 Takeoff" in flight.texts)
        await flight.fly_until_output("waypoint 2", "Reached waypoint #2", "AP: Mission: 3 LoitTurns")
        for name in ("LOITER", "FBWA", "CRUISE", "CIRCLE"):
            await flight.set_mode(name)
        latitude, longitude, _ = flight.place(200, 200)
        await flight.send_and_wait(f"guided {latitude} {longitude} 70", "DO_REPOSITION: ACCEPTED")
        await flight.send_and_wait("setspeed 17", "DO_CHANGE_SPEED: ACCEPTED")
        await flight.wait_until(lambda: abs(flight.distance(200, 200) - 80) < 25)
        await flight.send_and_wait("rtl", "Mode RTL")
        await flight.set_mode("AUTO")
        await flight.send_and_wait("wp set 2", "DO_SET_MISSION_CURRENT: ACCEPTED", "Mission: 2 WP")
        await flight.send_and_wait("land", "DO_LAND_START: ACCEPTED")
        await flight.fly_until_output("Mission: 6 Land", "Throttle disarmed")
        await flight.wait_until_disarmed()
        assert flight.distance() < 150
        assert not flight.ground.errors()


async def test_a_rover(tmp_path) -> None:
    async with mavproxy_flight("rover", "ardupilot", tmp_path) as flight:
        await flight.wait_for_parameters()
        await flight.load_plan(
            "wp", (WAYPOINT, (), 25, 0, 15), (WAYPOINT, (1,), 25, 20, 0), (RETURN, (), 0, 0, 0)
        )
        await flight.set_mode("AUTO")
        await flight.arm()
        await flight.fly_until_output("Reached waypoint #1", "Reached waypoint #2", "Mission: 3 RTL")
        await flight.wait_until(lambda: flight.distance() < 3)
        for name in ("HOLD", "STEERING", "LOITER", "MANUAL", "GUIDED"):
            await flight.set_mode(name)
        flight.ground.send_line("velocity 2 0 0")
        await flight.wait_until(lambda: flight.speed > 1.5)
        await flight.send_and_wait("disarm", "COMPONENT_ARM_DISARM: ACCEPTED", "DISARMED")
        assert not flight.ground.errors()


async def test_a_sub(tmp_path) -> None:
    async with mavproxy_flight("sub", "ardupilot", tmp_path, FS_GCS_ENABLE=0, FS_PILOT_INPUT=0) as flight:
        await flight.wait_for_parameters()
        await flight.load_plan("wp", (WAYPOINT, (), 8, 0, -4), (WAYPOINT, (), 8, 6, -6))
        await flight.set_mode("ALT_HOLD")
        await flight.arm()
        await flight.send_and_wait("mode auto", "Mission: 1 WP")
        await flight.fly_until_output("Mission: 2 WP")
        await flight.wait_until(lambda: flight.height < -5 and flight.distance(8, 6) < 2)
        await flight.set_mode("POSHOLD")
        await flight.set_mode("SURFACE")
        await flight.wait_until(lambda: flight.height > -0.5)
        await flight.set_mode("MANUAL")
        await flight.send_and_wait("disarm", "COMPONENT_ARM_DISARM: ACCEPTED", "DISARMED")
        assert not flight.ground.errors()


async def test_a_px4_copter(tmp_path) -> None:
    """MAVProxy's `mode` cannot set a PX4 mode: it passes pymavlink three numbers as one."""
    async with mavproxy_flight("copter", "px4", tmp_path, COM_DL_LOSS_T=60) as flight:
        await flight.ground.wait_for_output(
            "Detected vehicle 1:1", f"Received {len(flight.vehicle.parameters)} parameters"
        )
        flight.ground.send_line("param set MIS_TAKEOFF_ALT 8")
        await flight.wait_until(lambda: flight.vehicle.parameters["MIS_TAKEOFF_ALT"] == 8)
        await flight.load_plan(
            "wp",
            (TAKE_OFF, (), 0, 0, 10),
            (WAYPOINT, (), 30, 0, 10),
            (HOLD_TIME, (2,), 30, 20, 12),
            (RETURN, (), 0, 0, 0, NO_PLACE),
        )
        corners = [(-200, -200), (200, -200), (200, 200), (-200, 200)]
        await flight.load_plan("fence", *((INSIDE, (4,), *corner, 0, ABOVE_SEA) for corner in corners))
        await flight.load_plan("rally", (RALLY, (), 5, -5, 20))
        await flight.send_and_wait("mode", "Available modes:", "OFFBOARD")
        await flight.send_and_wait("long DO_SET_MODE 157 4 4", "DO_SET_MODE: ACCEPTED", "Mode MISSION")
        await flight.arm()
        await flight.fly_until_output("waypoint 1", "waypoint 2", "waypoint 3", "DISARMED")
        await flight.download_log()
        await flight.ground.send_until_answered("ftp list /fs/microsd/log", "2026-01-01")
        await flight.send_and_wait("module load nsh", "Loaded module nsh")
        flight.ground.send_line("nsh start")
        await flight.ground.send_until_answered("ver hw", "HW arch", "nsh>")
        assert not flight.ground.errors()


async def test_calibrations(tmp_path) -> None:
    """MAVProxy confirms the poses of the accelerometers by COMMAND_ACK, in answer to the status texts."""
    async with mavproxy_flight("copter", "ardupilot", tmp_path) as flight:
        ground, texts = flight.ground, flight.texts
        await flight.wait_for_parameters()
        for command, kind in (("gyrocal", "gyros"), ("ahrstrim", "Trim OK"), ("calpress", "Barometer")):
            await flight.send_and_wait(command, "PREFLIGHT_CALIBRATION: ACCEPTED")
            assert any(kind in text for text in texts), kind
        await flight.send_and_wait("accelcal", "Place vehicle level and press any key.")
        for pose in ("on its LEFT side", "on its RIGHT side", "nose DOWN", "nose UP", "on its BACK"):
            # MAVProxy prints a text before it waits for the key: one that comes between does not count.
            await ground.send_until_answered("", f"Place vehicle {pose} and press any key.")
        await ground.send_until_answered("", "Calibration successful")
        ground.send_line("magcal start")
        await ground.wait_for_output("DO_START_MAG_CAL: ACCEPTED", "Calibration of compass 0 SUCCESS")
        assert not ground.errors()
