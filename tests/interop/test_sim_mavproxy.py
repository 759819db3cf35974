"""MAVProxy flies our simulated vehicles, with its usual modules, and has nothing to complain of."""

from __future__ import annotations

from contextlib import asynccontextmanager, closing
from math import degrees

import pytest
from pymavlink import DFReader, mavwp

from mavstack.services.mission import PlanType
from mavstack.sim import Firmware, Simulation
from mavstack.sim.runner import Runner
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.simulated import Flight

pytestmark = [pytest.mark.interop, needs_mavproxy]

#: It reads one datagram at a time, and on a busy machine it would lose some at a higher speed.
SPEED = 6.0
WAYPOINT, TURNS, HOLD_TIME, RETURN, LAND, TAKE_OFF, SPEED_CHANGE = 16, 18, 19, 20, 21, 22, 178
LANDING_BEGINS, INSIDE, OUTSIDE, RALLY = 189, 5001, 5004, 5100
ABOVE_SEA, NO_PLACE, ABOVE_HOME = 0, 2, 3


class Cockpit(Flight):
    """A vehicle, and MAVProxy's console."""

    @property
    def home_first(self) -> bool:
        return self.vehicle.firmware is Firmware.ARDUPILOT

    @property
    def state(self) -> str:
        """With what the console said lately."""
        return f"{super().state}; MAVProxy: {self.ground.printed[-2000:]}"

    async def says(self, line: str, *wanted: str) -> None:
        """Say a line, and hear what comes of it."""
        self.ground.say(line)
        await self.ground.hear(*wanted)

    async def enters(self, name: str) -> None:
        """Change the mode by its name, unless it is another's."""
        self.ground.say(f"mode {name.lower()}")
        await self.until(lambda: self.vehicle.autopilot.mode.name == name)

    async def arms(self) -> None:
        await self.says("arm throttle", "COMPONENT_ARM_DISARM: ACCEPTED", "ARMED")
        assert self.vehicle.autopilot.armed

    async def disarms(self) -> None:
        """Wait until it does so by itself."""
        await self.until(lambda: not self.vehicle.autopilot.armed)
        await self.ground.hear("DISARMED")

    async def receives_parameters(self) -> None:
        """By FTP, as it does at first."""
        count = len(self.vehicle.parameters)
        await self.ground.hear("Detected vehicle 1:1", f"Received {count} parameters (ftp)", "/mav.parm")

    async def loads(self, what: str, *items: tuple) -> None:
        """Write a file with a plan, have it sent, and have it listed."""
        path = self.ground.directory / f"{what}.plan"
        path.write_text("".join(self._lines(items)))
        nouns = {"wp": "waypoints", "fence": "fence items", "rally": "rally items"}
        number = len(items) + (what == "wp" and self.home_first)
        await self.says(f"{what} load {path}", f"Sent all {number} {nouns[what]}", ": ACCEPTED")
        await self.ground.ask(f"{what} list", f"Requesting {number} ", f"Saved {number} {nouns[what]}")

    def _lines(self, items: tuple):
        """The format of waypoint files; ArduPilot's first waypoint is home."""
        yield "QGC WPL 110\n"
        if items[0][0] < INSIDE and self.home_first:
            items = ((WAYPOINT, (), 0, 0, 488, ABOVE_SEA), *items)
        for seq, (command, given, north, east, height, *frame) in enumerate(items):
            latitude, longitude, _ = self.place(north, east)
            params = (*given, 0, 0, 0, 0)[:4]
            values = (seq, 0, *(frame or (ABOVE_HOME,)), command, *params, latitude, longitude, height, 1)
            yield "\t".join(map(str, values)) + "\n"

    async def fetches_the_log(self) -> bytes:
        """By its own protocol, at the pace of the clock."""
        await self.until(lambda: not self.vehicle.storage.logs.writing)  # its last words
        with self.by_the_clock():
            await self.ground.ask("log list", "numLogs 1")
            number = self.vehicle.storage.logs.logs()[0].id
            await self.says(f"log download {number} fetched", "Finished downloading fetched")
        fetched = (self.ground.directory / "fetched").read_bytes()
        store = self.vehicle.storage.logs
        assert fetched == store.read(number, 0, store.logs()[0].size)
        return fetched


@asynccontextmanager
async def cockpit(kind: str, firmware: str, directory, *, speed: float = SPEED, **parameters):
    """A vehicle with some parameters of its own that MAVProxy has found."""
    simulation = Simulation()
    vehicle = simulation.add(kind, firmware)
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    async with Runner(simulation, speed=speed) as runner:
        link = await runner.connect("udpin://127.0.0.1:0", [vehicle])
        running = runner.start()
        async with mavproxy(link.address[1], directory) as console:
            yield Cockpit(vehicle, console, runner, running)
        if running.done():
            running.result()


async def test_a_copter(tmp_path) -> None:
    async with cockpit("copter", "ardupilot", tmp_path) as flight:
        await flight.receives_parameters()
        await sets_parameters(flight)
        await lists_plans(flight)
        await flies_its_mission(flight)
        await reads_the_log(flight)
        await flies_as_it_is_told(flight)
        await maintains(flight)
        await reboots(flight)
        assert not flight.ground.complaints(
            "MAV Errors: 0", "AHRS {", "SYS_STATUS {", "COMM_STATUS {", "CONTROLLER_OUTPUT {"
        )


async def sets_parameters(flight: Cockpit) -> None:
    parameters, ground = flight.vehicle.parameters, flight.ground
    ground.say("param set WPNAV_SPEED 700")
    await flight.until(lambda: parameters["WPNAV_SPEED"] == 700)
    await ground.ask("param fetch WPNAV_SPEED", "WPNAV_SPEED = 700.0")
    await flight.says("param show WPNAV_SPEED", "WPNAV_SPEED      700.0")
    ground.say("set param_ftp False")
    await ground.ask("param fetch", f"Received {len(parameters)} parameters\n")
    await flight.says("param save saved.parm", f"Saved {len(parameters)} parameters to saved.parm")
    await flight.says("param load saved.parm", "(changed 0)")


async def lists_plans(flight: Cockpit) -> None:
    await flight.loads(
        "wp",
        (TAKE_OFF, (), 0, 0, 15),
        (WAYPOINT, (), 40, 0, 15),
        (SPEED_CHANGE, (1, 4, -1), 0, 0, 0),
        (WAYPOINT, (2,), 40, 30, 18),
        (TURNS, (1, 0, 8), 40, 30, 18),
        (WAYPOINT, (), 10, 30, 15),
        (RETURN, (), 0, 0, 0),
    )
    await flight.says("wp save saved.txt", "Saved 8 waypoints to saved.txt")
    loader = mavwp.MAVWPLoader()
    assert loader.load(str(flight.ground.directory / "saved.txt")) == 8
    commands = [TAKE_OFF, WAYPOINT, SPEED_CHANGE, WAYPOINT, TURNS, WAYPOINT, RETURN]
    assert [loader.wp(seq).command for seq in range(1, 8)] == commands
    assert loader.wp(2).x == pytest.approx(flight.place(40, 0)[0], abs=1e-6)
    corners = [(-300, -300), (300, -300), (300, 300), (-300, 300)]
    fence = [(INSIDE, (4,), *corner, 0, ABOVE_SEA) for corner in corners]
    await flight.loads("fence", *fence, (OUTSIDE, (20,), 150, 150, 0, ABOVE_SEA))
    await flight.says("fence enable", "DO_FENCE_ENABLE: ACCEPTED", "fence enabled")
    assert flight.vehicle.parameters["FENCE_ENABLE"] == 1 or flight.vehicle.autopilot.fence.enabled
    await flight.loads("rally", (RALLY, (), 5, 20, 20), (RALLY, (), 200, 0, 20))
    latitude, longitude, _ = flight.place(100, 100)
    flight.ground.say(f"click {latitude} {longitude}")
    await flight.says("rally add 25", "TYPE_RALLY: ACCEPTED")
    assert len(flight.vehicle.mission.plan(PlanType.RALLY)) == 3


async def flies_its_mission(flight: Cockpit) -> None:
    await flight.enters("GUIDED")
    await flight.arms()
    await flight.says("mode auto", "DO_SET_MODE: ACCEPTED", "AP: Mission: 1 Takeoff")
    await flight.ground.hear("AP: Mission: 2 WP", "Reached command #2", "waypoint 4")
    await flight.ground.hear("Mission: 5 LoitTurns", "Mission: 7 RTL", "Disarming motors")
    await flight.disarms()
    assert flight.texts.count("Mission: 1 Takeoff") == 1
    assert flight.distance(5, 20) < 2  # the nearest rally point


async def reads_the_log(flight: Cockpit) -> None:
    fetched = await flight.fetches_the_log()
    with closing(DFReader.DFReader_binary(str(flight.ground.directory / "fetched"))) as log:
        assert log.recv_match(type="PARM", condition="PARM.Name=='WPNAV_SPEED'").Value == 700
        log.rewind()
        heights = [entry.RelHomeAlt for entry in iter(lambda: log.recv_match(type="POS"), None)]
    assert max(heights) == pytest.approx(18, abs=1)
    with flight.by_the_clock():
        await flight.ground.ask("ftp list /APM/LOGS", "00000001.BIN", "Total size")
        await flight.says("ftp get /APM/LOGS/00000001.BIN", f"Wrote {len(fetched)} bytes")
        copied = flight.ground.directory / "00000001.BIN"
        await flight.until(lambda: copied.read_bytes() == fetched)  # it says so before it closes the file


async def flies_as_it_is_told(flight: Cockpit) -> None:
    truth = lambda: flight.vehicle.body.truth  # noqa: E731
    await flight.enters("GUIDED")
    await flight.arms()
    await flight.says("takeoff 12", "NAV_TAKEOFF: ACCEPTED")
    await flight.until(lambda: flight.height > 11)
    latitude, longitude, _ = flight.place(30, 20)
    await flight.says(f"guided {latitude} {longitude} 16", "DO_REPOSITION: ACCEPTED")
    await flight.until(lambda: flight.distance(30, 20) < 1.5 and abs(flight.height - 16) < 1)
    flight.ground.say("setyaw 90 30 0")
    await flight.until(lambda: abs(degrees(truth().yaw) - 90) < 5)
    await flight.says("setspeed 3", "DO_CHANGE_SPEED: ACCEPTED")
    flight.ground.say("position 12 0 0")
    await flight.until(lambda: flight.distance(30, 32) < 1.5)
    flight.ground.say("velocity 0 2 0")
    await flight.until(lambda: truth().velocity_north < -1.5)
    flight.ground.say("rc 3 1500")
    await flight.until(lambda: flight.vehicle.autopilot.radio.channels[2] == 1500)
    await flight.enters("LOITER")
    await flight.until(lambda: flight.speed < 0.5)
    flight.ground.say("rc 1 1700")
    await flight.until(lambda: truth().velocity_north < -1.5)
    flight.ground.say("rc 1 1500")
    await flight.says("rtl", "DO_SET_MODE: ACCEPTED", "Mode RTL")
    await flight.enters("LAND")
    await flight.disarms()
    flight.ground.say("rc clear")
    await flight.until(lambda: flight.vehicle.autopilot.radio.channels[2] == 1000)


async def maintains(flight: Cockpit) -> None:
    vehicle = flight.vehicle
    await flight.enters("STABILIZE")
    await flight.says("switch 2", "PWM=1295")
    await flight.until(lambda: vehicle.autopilot.mode.number == vehicle.parameters["FLTMODE2"])
    await flight.says("switch 0", "Disabled RC switch override")
    for command in ("calpress", "gyrocal", "ahrstrim"):
        await flight.says(command, "PREFLIGHT_CALIBRATION: ACCEPTED", "Calibrated")
    await flight.says("servo set 9 1700", "DO_SET_SERVO: ACCEPTED")
    await flight.says("long MAV_CMD_DO_SET_SERVO 10 1600", "DO_SET_SERVO: ACCEPTED")
    await flight.fly(3)
    await flight.says("status SERVO_OUTPUT_RAW", "servo9_raw : 1700, servo10_raw : 1600")
    await flight.says("relay set 0 1", "DO_SET_RELAY: ACCEPTED")
    await flight.says("motortest 1 0 20 2", "DO_MOTOR_TEST: ACCEPTED")
    await flight.says("batreset", "BATTERY_RESET: ACCEPTED")
    await flight.fly(3)
    await flight.says("arm prearms", "RUN_PREARM_CHECKS: ACCEPTED")
    await flight.says("arm safetystatus", "Safety is OFF")
    await flight.says("version")
    await flight.fly(3)
    await flight.says("status AUTOPILOT_VERSION", "AUTOPILOT_VERSION {capabilities")
    for what in ("fence", "rally", "wp"):
        await flight.says(f"{what} clear", ": ACCEPTED")
    assert not any(len(vehicle.mission.plan(kind)) for kind in PlanType)
    for query in ("status", "module list", "bat", "alt", "time", "terrain status", "devid", "arm list"):
        flight.ground.say(query)


async def reboots(flight: Cockpit) -> None:
    await flight.says("reboot", "PREFLIGHT_REBOOT_SHUTDOWN: ACCEPTED", "AP: ArduPilot Ready", "is using GPS")
    await flight.enters("GUIDED")
    assert flight.vehicle.boots == 2


async def test_a_plane(tmp_path) -> None:
    async with cockpit("plane", "ardupilot", tmp_path, speed=8.0) as flight:
        await flight.receives_parameters()
        await flight.loads(
            "wp",
            (TAKE_OFF, (10,), 0, 0, 40),
            (WAYPOINT, (), 400, 0, 60),
            (TURNS, (1, 0, 60), 400, 300, 60),
            (LANDING_BEGINS, (), 0, 0, 0, ABOVE_SEA),
            (WAYPOINT, (), -450, 0, 25),
            (LAND, (), 0, 0, 0),
        )
        await flight.enters("AUTO")
        await flight.arms()
        await flight.until(lambda: "Mission: 1 Takeoff" in flight.texts)
        await flight.ground.hear("waypoint 2", "Reached waypoint #2")
        await flight.ground.hear("AP: Mission: 3 LoitTurns")
        for name in ("LOITER", "FBWA", "CRUISE", "CIRCLE"):
            await flight.enters(name)
        latitude, longitude, _ = flight.place(200, 200)
        await flight.says(f"guided {latitude} {longitude} 70", "DO_REPOSITION: ACCEPTED")
        await flight.says("setspeed 17", "DO_CHANGE_SPEED: ACCEPTED")
        await flight.until(lambda: abs(flight.distance(200, 200) - 80) < 25)
        await flight.says("rtl", "Mode RTL")
        await flight.enters("AUTO")
        await flight.says("wp set 2", "DO_SET_MISSION_CURRENT: ACCEPTED", "Mission: 2 WP")
        await flight.says("land", "DO_LAND_START: ACCEPTED", "Mission: 6 Land", "Throttle disarmed")
        await flight.disarms()
        assert flight.distance() < 150
        assert not flight.ground.complaints()


async def test_a_rover(tmp_path) -> None:
    async with cockpit("rover", "ardupilot", tmp_path) as flight:
        await flight.receives_parameters()
        await flight.loads(
            "wp", (WAYPOINT, (), 25, 0, 15), (WAYPOINT, (1,), 25, 20, 0), (RETURN, (), 0, 0, 0)
        )
        await flight.enters("AUTO")
        await flight.arms()
        await flight.ground.hear("Reached waypoint #1", "Reached waypoint #2", "Mission: 3 RTL")
        await flight.until(lambda: flight.distance() < 3)
        for name in ("HOLD", "STEERING", "LOITER", "MANUAL", "GUIDED"):
            await flight.enters(name)
        flight.ground.say("velocity 2 0 0")
        await flight.until(lambda: flight.speed > 1.5)
        await flight.says("disarm", "COMPONENT_ARM_DISARM: ACCEPTED", "DISARMED")
        assert not flight.ground.complaints()


async def test_a_sub(tmp_path) -> None:
    async with cockpit("sub", "ardupilot", tmp_path, FS_GCS_ENABLE=0, FS_PILOT_INPUT=0) as flight:
        await flight.receives_parameters()
        await flight.loads("wp", (WAYPOINT, (), 8, 0, -4), (WAYPOINT, (), 8, 6, -6))
        await flight.enters("ALT_HOLD")
        await flight.arms()
        await flight.says("mode auto", "Mission: 1 WP", "Mission: 2 WP")
        await flight.until(lambda: flight.height < -5 and flight.distance(8, 6) < 2)
        await flight.enters("POSHOLD")
        await flight.enters("SURFACE")
        await flight.until(lambda: flight.height > -0.5)
        await flight.enters("MANUAL")
        await flight.says("disarm", "COMPONENT_ARM_DISARM: ACCEPTED", "DISARMED")
        assert not flight.ground.complaints()


async def test_a_copter_of_the_other_firmware(tmp_path) -> None:
    """Its `mode` cannot set a mode of PX4: it hands pymavlink three numbers as one."""
    async with cockpit("copter", "px4", tmp_path, COM_DL_LOSS_T=60) as flight:
        await flight.ground.hear(
            "Detected vehicle 1:1", f"Received {len(flight.vehicle.parameters)} parameters"
        )
        flight.ground.say("param set MIS_TAKEOFF_ALT 8")
        await flight.until(lambda: flight.vehicle.parameters["MIS_TAKEOFF_ALT"] == 8)
        await flight.loads(
            "wp",
            (TAKE_OFF, (), 0, 0, 10),
            (WAYPOINT, (), 30, 0, 10),
            (HOLD_TIME, (2,), 30, 20, 12),
            (RETURN, (), 0, 0, 0, NO_PLACE),
        )
        corners = [(-200, -200), (200, -200), (200, 200), (-200, 200)]
        await flight.loads("fence", *((INSIDE, (4,), *corner, 0, ABOVE_SEA) for corner in corners))
        await flight.loads("rally", (RALLY, (), 5, -5, 20))
        await flight.says("mode", "Available modes:", "OFFBOARD")
        await flight.says("long DO_SET_MODE 157 4 4", "DO_SET_MODE: ACCEPTED", "Mode MISSION")
        await flight.arms()
        await flight.ground.hear("waypoint 1", "waypoint 2", "waypoint 3", "DISARMED")
        await flight.fetches_the_log()
        await flight.ground.ask("ftp list /fs/microsd/log", "2026-01-01")
        await flight.says("module load nsh", "Loaded module nsh")
        flight.ground.say("nsh start")
        await flight.ground.ask("ver hw", "HW arch", "nsh>")
        assert not flight.ground.complaints()
