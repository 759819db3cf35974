"""Command lines of simulated firmwares: the program, its options, its folder and its environment.

A program is a path, or a command such as `qemu-arm-static PATH`. Each runs in its own folder, where it keeps
parameters and logs.
"""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.vehicle_types import Home

#: The physics of each kind of vehicle, which is also its default.
VEHICLES: Final = ("copter", "plane", "vtol", "rover", "boat", "sub")
#: PX4's model of each vehicle. Some models belong to PX4's internal simulator; instead of it, this simulator
#: connects over TCP.
_PX4_MODELS: Final = MappingProxyType(
    {
        "copter": "none_iris",
        "plane": "jsbsim_rascal",
        "vtol": "sihsim_standard_vtol",
        "rover": "sihsim_rover_ackermann",
        "boat": "sihsim_rover_ackermann",
    }
)
#: PX4's output functions: 101 is the first motor, 201 the first servo. The order differs between the models
#: and `mavstack.simulators.outputs`; the second servo of the plane is its right aileron, the fourth its
#: rudder.
_PX4_FUNCTIONS: Final = MappingProxyType(
    {"plane": (202, 203, 101, 204, 0, 0, 0, 0, 0), "vtol": (101, 102, 103, 104, 105, 201, 202, 203)}
)
#: PX4 parameters for bodies that fly faster and turn wider than PX4's models.
_PX4_BODIES: Final[Mapping[str, Mapping[str, float]]] = MappingProxyType(
    {
        "jsbsim:c172x": {
            "FW_AIRSPD_MIN": 28,
            "FW_AIRSPD_TRIM": 38,
            "FW_AIRSPD_MAX": 60,
            "FW_AIRSPD_STALL": 25,
            "FW_PR_P": 0.05,
            "FW_P_TC": 0.8,
            "FW_RR_I": 0.03,
            "FW_RR_P": 0.04,
            "FW_R_LIM": 30,
            "FW_R_TC": 0.8,
            "FW_THR_TRIM": 0.7,
            "NAV_LOITER_RAD": 400,
            "RWTO_ROT_AIRSPD": 32,
        },
        "rover": {"RO_MAX_THR_SPEED": 11, "RO_SPEED_LIM": 5},
        "boat": {"RO_MAX_THR_SPEED": 11, "RO_SPEED_LIM": 5},
    }
)
#: Parameters of all ArduPilot vehicles: the steps per second, by default three times as many.
_RATE: Final = MappingProxyType({"SIM_RATE_HZ": 400})
#: Parameters without which ArduPilot does not arm or drive its outputs as the bodies expect. ATC_STR_RAT_FF
#: is the steering at 1 m/s for a turn rate of 1 rad/s; with the default, 0.2, these bodies turn so wide that
#: they pass a place beside it. CRUISE_THROTTLE is the throttle in percent that holds CRUISE_SPEED.
_ARDUPILOT_PARAMETERS: Final[Mapping[str, Mapping[str, float]]] = MappingProxyType(
    {
        "copter": {"FRAME_CLASS": 1, "FRAME_TYPE": 1},
        "vtol": {"Q_ENABLE": 1, "Q_FRAME_CLASS": 1, "Q_FRAME_TYPE": 1},
        "rover": {"ATC_STR_RAT_FF": 1.1, "CRUISE_SPEED": 5, "CRUISE_THROTTLE": 42},
        "boat": {"FRAME_CLASS": 2, "ATC_STR_RAT_FF": 1.4, "CRUISE_SPEED": 2, "CRUISE_THROTTLE": 50},
        "sub": {"FRAME_CONFIG": 1},
    }
)
#: Ports of the first instance: PX4's side of the API, ArduPilot's first serial port and its simulator.
PX4_API_PORT, ARDUPILOT_SERIAL_PORT, ARDUPILOT_WORLD_PORT = 14540, 5760, 9002

#: The speed factor with which ArduPilot runs as fast as possible.
_FASTEST: Final = 100.0


@dataclass(frozen=True, slots=True)
class FirmwareCommand:
    """A program that is ready to start.

    Attributes:
        words: The program and its options.
        files: Files to write into its folder before the start, by name.
        environment: Variables beside those of this process.
        serial_port: The TCP port of its first serial port, which must be connected; 0: none.
    """

    words: tuple[str, ...]
    files: Mapping[str, str] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    serial_port: int = 0


def program_words(program: str) -> list[str]:
    """Return the words of a program: a path, or a command with a path.

    Raises:
        InvalidArgumentError: It names no file.
    """
    if Path(program).is_file():
        return [str(Path(program).resolve())]
    words = shlex.split(program)
    if len(words) > 1 and Path(words[-1]).is_file():
        return [*words[:-1], str(Path(words[-1]).resolve())]
    raise InvalidArgumentError(f"the program {program!r} is not a file")


def px4_command(
    program: str,
    *,
    vehicle: str = "copter",
    physics: str | None = None,
    instance: int = 0,
    speed: float = 1.0,
    model: str | None = None,
    parameters: Mapping[str, float] = MappingProxyType({}),
) -> FirmwareCommand:
    """Return the command line of PX4's SITL, in `build/px4_sitl…/bin`.

    Args:
        program: The path of `bin/px4`, with the folder `etc` beside `bin`.
        vehicle: The vehicle, for its default model.
        physics: The name of the body, for the parameters that it needs.
        instance: The number of the instance; its port is 4560 plus this number.
        speed: Simulated seconds in a real second, by which PX4 lengthens its timeouts; 0: not known.
        model: PX4's model; None: the one of the vehicle.
        parameters: Parameters of this start, beside those of vehicle and body.

    Raises:
        InvalidArgumentError: There is no such program, no folder `etc`, or no model of the vehicle.
    """
    words = program_words(program)
    etc = Path(words[-1]).parent.parent / "etc"
    if not etc.is_dir():
        raise InvalidArgumentError(f"the program {program!r} has no folder etc beside its folder")
    model = model or _PX4_MODELS.get(vehicle)
    if model is None:
        raise InvalidArgumentError(f"PX4 has no model of a {vehicle}: give one (--model)")
    environment = {"PX4_SIM_MODEL": model, "PX4_SIM_HOSTNAME": "127.0.0.1", "PX4_SIMULATOR": "mavlink"}
    values: dict[str, float] = dict(_PX4_BODIES.get(physics or vehicle, {}))
    if model == _PX4_MODELS.get(vehicle):
        functions = enumerate(_PX4_FUNCTIONS.get(vehicle, ()), 1)
        values |= {f"PWM_MAIN_FUNC{number}": function for number, function in functions}
    environment |= {f"PX4_PARAM_{name}": f"{value:g}" for name, value in {**values, **parameters}.items()}
    if speed not in (0.0, 1.0):
        environment["PX4_SIM_SPEED_FACTOR"] = f"{speed:g}"
    return FirmwareCommand((*words, "-i", str(instance), "-d", str(etc)), environment=environment)


def ardupilot_command(
    program: str,
    *,
    home: Home,
    vehicle: str = "copter",
    instance: int = 0,
    speed: float = 1.0,
    port: int | None = None,
    parameters: Mapping[str, float] = MappingProxyType({}),
) -> FirmwareCommand:
    """Return the command line of an ArduPilot SITL.

    Args:
        program: The path of `arduplane`, `arducopter`, `ardurover` or `ardusub`.
        home: Where it starts.
        vehicle: The vehicle, for the parameters that its body needs.
        instance: The number of the instance: its ports are ten times this number higher.
        speed: Simulated seconds in a real second; 0: as fast as possible.
        port: The port of the simulator; None: 9002 and ten more for each instance.
        parameters: Parameters of the first start, beside those of the vehicle.

    Raises:
        InvalidArgumentError: There is no such program.
    """
    words = program_words(program)
    values = {**_RATE, **_ARDUPILOT_PARAMETERS.get(vehicle, {}), **parameters}
    usual = ARDUPILOT_WORLD_PORT + 10 * instance
    options = ["--model", "JSON:127.0.0.1", "-I", str(instance), "-w"]
    options += ["--home", f"{home.latitude},{home.longitude},{home.altitude},{home.heading}"]
    options += ["--speedup", f"{speed or _FASTEST:g}"]
    options += ["--defaults", "defaults.parm"]
    files = {"defaults.parm": "".join(f"{name} {value:g}\n" for name, value in values.items())}
    if port is not None and port != usual:
        options += ["--sim-port-out", str(port)]
    return FirmwareCommand((*words, *options), files, serial_port=ARDUPILOT_SERIAL_PORT + 10 * instance)


def betaflight_command(program: str) -> FirmwareCommand:
    """Return the command line of Betaflight's SITL, which keeps its settings in `eeprom.bin`.

    Raises:
        InvalidArgumentError: There is no such program.
    """
    return FirmwareCommand(tuple(program_words(program)))
