"""Random actions on one vehicle, in any order: each step of a `RandomActor` is one action."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan, PlanType
from tests.sim.robustness.hostile_peers import ALL, GROUND, UNUSUAL_NUMBERS, TargetVehicle, unusual_number

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message

_CMD = common.MavCmd
COMMANDS = [int(command) for command in ALL.enum_class("MAV_CMD")]
#: Commands of a mission that is flown repeatedly.
FLOWN = [16, 17, 18, 19, 20, 21, 22, 31, 82, 84, 85, 93, 112, 114, 115, 177, 178, 189, 600, 601]
PLACES = [
    (47.4, 8.5),
    (47.41, 8.55),
    (90, 0),
    (-90, 0),
    (0, 180),
    (0, -180),
    (-47, -172),
    (0, 0),
    (91, 8),
    (47, 181),
]
FAULTS = [
    *(
        "gps off",
        "gps on",
        "gps spoof 1e5 -1e9",
        "gps spoof 30 0",
        "compass 180",
        "compass 1e300",
        "baro 1e9",
    ),
    *(
        "baro -50",
        "motor 1 off",
        "motor 1 on",
        "motor 3 off",
        "motor 16 off",
        "battery sag 1e9",
        "battery sag 2",
    ),
    *("battery 0", "battery 8", "battery 100", "radio off", "radio on", "link off", "link on", "reboot"),
]
LINES = [
    *(
        "help",
        "ver all",
        "commander arm",
        "commander takeoff",
        "commander mode",
        "commander disarm -f",
        "listener",
    ),
    *(
        "listener vehicle_status 1e9",
        "listener sensor_combined -n -5",
        "param show *",
        "param set",
        "reboot",
        "\x03",
    ),
    *(
        "param set MPC_XY_VEL_MAX nan",
        "param set SYS_AUTOSTART 99999999999999",
        "param show [",
        "dmesg",
        ";;|&",
        "é",
    ),
    *(
        "commander lat",
        "top once",
        "uorb top",
        "mavlink status",
        "logger on",
        "logger off",
        "\x00" * 9,
        "x" * 400,
    ),
]


def whole_payload(vehicle_system: int, payload: bytes) -> common.FileTransferProtocol:
    return common.FileTransferProtocol(
        target_system=vehicle_system, target_component=1, payload=payload.ljust(251, b"\0")[:251]
    )


class RandomActor(TargetVehicle):
    """A vehicle with methods that execute random actions on it."""

    def run_random_action(self) -> None:
        actions: list[Callable[[], None]] = [
            *(
                self.send_random_message,
                self.send_random_message,
                self.command,
                self.command,
                self.set_random_parameters,
            ),
            *(
                self.change_mode,
                self.inject_fault,
                self.upload,
                self.write_shell,
                self.use_files,
                self.move_sticks,
            ),
            *(self.send_setpoints, self.arm_or_place_in_air, self.change_ports, self.request_logs),
        ]
        self.random.choice(actions)()

    @property
    def system(self) -> int:
        return self.vehicle.address.system

    def send_random_message(self) -> None:
        self.send(self.random_message(), self.random_source())

    def command(self) -> None:
        self.send(self.random_command())

    def random_command(self) -> Message:
        """Send a random COMMAND_LONG or COMMAND_INT, which the vehicle must answer."""
        random = self.random
        params = {f"param{index}": unusual_number(random) for index in range(1, 8)}
        header_fields = {"target_system": self.system, "target_component": 1}
        command = random.choice(COMMANDS)
        if command == _CMD.PREFLIGHT_REBOOT_SHUTDOWN and random.random() < 0.9:
            command = _CMD.DO_REPOSITION
        if random.random() < 0.5:
            return common.CommandLong(
                **header_fields, command=command, confirmation=random.choice([0, 1, 255]), **params
            )
        del params["param5"], params["param6"]
        latitude, longitude = (random.choice([0, 474000000, random.randrange(-(2**31), 2**31)]) for _ in "xy")
        height = params.pop("param7")
        frame = random.choice([0, 3, 6, random.randrange(22), random.randrange(256)])
        return common.CommandInt(
            **header_fields, command=command, frame=frame, x=latitude, y=longitude, z=height, **params
        )

    def set_random_parameters(self) -> None:
        """Set parameters by PARAM_SET in the firmware's encoding, so that they are accepted."""
        random, table = self.random, list(self.vehicle.parameters.table)
        for definition in random.sample(table, random.choice([1, 5, 40])):
            value = random.choice((*UNUSUAL_NUMBERS, 127, -128, 32767, -32768, 2147483520.0, 255))
            self.set_parameter(definition.name, value)

    def set_parameter(self, name: str, value: float) -> None:
        kind = self.vehicle.parameters.table[name].kind
        if self.vehicle.firmware == "px4" and kind != common.MavParamType.REAL32:
            whole = int(min(max(value, -(2.0**31)), 2.0**31 - 1)) if value == value else 2**31 - 1
            value = struct.unpack("<f", struct.pack("<i", whole))[0]
        header_fields = {"target_system": self.system, "target_component": 1}
        self.send(common.ParamSet(**header_fields, param_id=name, param_type=kind, param_value=value))

    def change_mode(self) -> None:
        mode = self.random.choice(self.vehicle.profile.modes)
        self.vehicle.autopilot.enter(mode.number, "test", commanded=True)

    def inject_fault(self) -> None:
        self.vehicle.faults.inject(self.random.choice(FAULTS))

    def arm_or_place_in_air(self) -> None:
        if self.random.random() < 0.5:
            self.place_in_air()
        else:
            self.vehicle.autopilot.arm(force=True)

    def move_sticks(self) -> None:
        random, system = self.random, self.system
        channels = {
            f"chan{n}_raw": random.choice([0, 1, 900, 1000, 1500, 2000, 65534, 65535]) for n in range(1, 19)
        }
        self.send(common.RcChannelsOverride(target_system=system, target_component=1, **channels))
        axes = {axis: random.choice([-32768, -1000, 0, 500, 1000, 32767]) for axis in "xyzr"}
        self.send(common.ManualControl(target=system, buttons=random.randrange(65536), **axes))

    def send_setpoints(self) -> None:
        random = self.random
        if random.random() < 0.5:
            self.vehicle.autopilot.enter(self.vehicle.profile.guided, "test", commanded=True)
        header_fields = {
            "target_system": self.system,
            "target_component": 1,
            "type_mask": random.choice([0, 0xDF8, 0xDC7, 0xE3F, random.randrange(65536)]),
        }
        motion = {
            name: unusual_number(random)
            for name in ("vx", "vy", "vz", "afx", "afy", "afz", "yaw", "yaw_rate")
        }
        frame = random.choice([1, 7, 8, 9, 12, 20, 21])
        local = {axis: unusual_number(random) for axis in "xyz"}
        self.send(
            common.SetPositionTargetLocalNed(**header_fields, coordinate_frame=frame, **local, **motion)
        )
        places = {name: random.randrange(-(2**31), 2**31) for name in ("lat_int", "lon_int")}
        self.send(
            common.SetPositionTargetGlobalInt(
                **header_fields,
                coordinate_frame=random.choice([0, 3, 6, 10]),
                alt=unusual_number(random),
                **places,
                **motion,
            )
        )
        turn = {
            name: unusual_number(random)
            for name in ("body_roll_rate", "body_pitch_rate", "body_yaw_rate", "thrust")
        }
        header_fields["type_mask"] = random.choice([0, 7, 128, random.randrange(256)])
        self.send(
            common.SetAttitudeTarget(**header_fields, q=[unusual_number(random) for _ in range(4)], **turn)
        )

    def write_shell(self) -> None:
        line = self.random.choice(LINES).encode()[:69] + b"\n"
        self.send(
            common.SerialControl(
                device=10, flags=6, timeout=0, baudrate=0, count=len(line), data=line.ljust(70, b"\0")
            )
        )

    def use_files(self) -> None:
        """Open existing files in any way, and read and write at random offsets."""
        random = self.random
        names = [
            "@PARAM/param.pck",
            "@MISSION/mission.dat",
            "@MISSION/fence.dat",
            "@MISSION/rally.dat",
            "@SYS/",
            "/",
            "a",
            "/fs/microsd",
            "@SYS/threads.txt",
            "/APM/LOGS",
            "//..//.",
            "\xff",
        ]
        for _ in range(4):
            opcode = random.choice(
                [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, random.randrange(256)]
            )
            data = random.choice(
                [random.choice(names).encode(), random.randbytes(random.randrange(239)), b"\0" * 4]
            )
            size = random.choice([len(data), 239, 255, 0])
            header = struct.pack(
                "<HBBBBBxI",
                random.randrange(65536),
                random.randrange(3),
                opcode,
                size,
                0,
                0,
                random.choice([0, 0, 4, 2**32 - 1]),
            )
            self.send(whole_payload(self.system, header + data))

    def request_logs(self) -> None:
        random, header_fields = self.random, {"target_system": self.system, "target_component": 1}
        self.send(common.LogRequestList(**header_fields, start=0, end=65535))
        range_fields = {"ofs": random.choice([0, 500, 2**32 - 1]), "count": random.choice([0, 90, 2**32 - 1])}
        self.send(common.LogRequestData(**header_fields, id=random.randrange(4), **range_fields))
        if random.random() < 0.2:
            self.send(common.LogErase(**header_fields))

    def change_ports(self) -> None:
        vehicle, random = self.vehicle, self.random
        if random.random() < 0.3:
            vehicle.close_port(self.port)
            self.port = vehicle.open_port("hostile")
            self._encoders.clear()
        elif len(vehicle.ports) < 4:
            vehicle.open_port("another", bandwidth=random.choice([None, 100.0, 5000.0]))
        else:
            vehicle.close_port(random.choice([port for port in vehicle.ports if port is not self.port]))

    # Plans

    def item(self, kind: int, count: int) -> MissionItem:
        random = self.random
        choices = {
            PlanType.MISSION: random.choice([FLOWN, FLOWN, COMMANDS]),
            PlanType.FENCE: [5001, 5002, 5003, 5004],
        }
        command = random.choice(choices.get(PlanType(kind), [_CMD.NAV_RALLY_POINT]))
        params = [random.choice([unusual_number(random), 0, random.randint(-1, count)]) for _ in range(4)]
        if command == _CMD.DO_JUMP:
            params[:2] = random.randint(0, count), random.choice([-1, 1e9, 5])
        place = random.choice([*PLACES, (47.4, 8.5), (unusual_number(random), unusual_number(random))])
        height = random.choice([0, 10, 50, -10, 1e6, -1e6, unusual_number(random)])
        frame = random.choice([0, 3, 3, 3, 2, 6, 10, random.randrange(22)])
        return MissionItem(command, *params, *place, height, frame=frame)  # type: ignore[call-arg]

    def accepted(self, kind: int, count: int) -> list[MissionItem]:
        """Return items that the vehicle accepts."""
        mission = self.vehicle.autopilot.mission
        tried = (self.item(kind, count) for _ in range(count * 20))
        return [item for seq, item in enumerate(tried) if mission.check(kind, seq, item) == 0][:count]

    def upload(self, kind: int | None = None) -> None:
        random, vehicle = self.random, self.vehicle
        kind = random.choice([0, 0, 1, 2]) if kind is None else kind
        items = self.accepted(kind, random.choice([1, 2, 5, 12]))
        if kind == PlanType.MISSION and vehicle.firmware == "ardupilot":
            items.insert(0, MissionItem(_CMD.NAV_WAYPOINT))
        if kind == PlanType.FENCE and random.random() < 0.7:
            corners = random.choice([3, 4, 6])
            items = [
                MissionItem(random.choice([5001, 5002]), corners, param5=a, param6=b, frame=0)
                for a, b in random.choices(PLACES[:8], k=corners)
            ]
            items = [
                MissionItem(items[0].command, corners, param5=item.param5, param6=item.param6, frame=0)
                for item in items
            ]
        vehicle.mission.accept(Plan.of(items, kind), GROUND)
        vehicle.engine.touch(vehicle.mission)
        if kind == PlanType.MISSION:
            self.place_in_air()
            vehicle.autopilot.enter(vehicle.profile.mission, "test", commanded=True)
