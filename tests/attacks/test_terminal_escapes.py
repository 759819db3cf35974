"""Attack: control sequences for the terminal in every text that a vehicle, a file or a packet can carry."""

from __future__ import annotations

import ast
import json
import re
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from mavstack import cli
from mavstack.cli.registry import COMMANDS, actions_of, command_parser
from mavstack.dialects import Dialect, common
from mavstack.links.memory import MemoryChannel
from mavstack.security import key_store
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.wire import Parser, encode
from tests.cli.conftest import stamped

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: Clears the screen, sets the title, asks for a report, colours, erases the line, turns the text around.
ATTACK = "\x1b[2J\x1b]0;x\x07\x9b5n\x1b[35m\r\x1b[1K\u202e\x7f"
#: The sequences that the command line itself sends to a terminal: colours, and the end of a progress line.
OWN_SEQUENCE = re.compile(r"\x1b\[(0|1|1;31|31|32|33|36|90)m|\r\x1b\[K")
COPTER, PX4_COPTER = (VehicleType.COPTER, Firmware.ARDUPILOT), (VehicleType.COPTER, Firmware.PX4)
#: Commands that show an attacked text, so that its replacement is seen.
REACHED = {
    "vehicle arm --system 1",
    "vehicle mode NOSUCH", "vehicle modes", "vehicle health", "vehicle info", "param list",
    "param save - --format mavproxy", "ftp ls /bad", "shell --command modes",
    "shell --command 'arm throttle'", "shell --command 'ftp list /bad'", "watch hostile.tlog",
    "watch hostile.tlog --once", "dialect show hostile.xml", "dialect show hostile.xml BAD_MESSAGE",
    "camera info", "key list",
}  # fmt: skip
#: Commands that are attacked by another test, which has the devices for that: tests/cli/radio,
#: tests/cli/msp, tests/cli/firmware.
#: Bridges and maps print no text of a vehicle.
ATTACKED_ELSEWHERE = {"bridge", "firmware", "map", "msp", "radio"}
#: The only modules that may write to the terminal.
WRITERS = {"common/output.py", "common/live_display.py"}

WITH_VEHICLE = [
    "rid status", "rid send --operator 47,8 --for 1", "external check", "external odometry --for 1",
    "vehicle arm --system 1",
    "vehicle check", "vehicle airframe", "vehicle ports",
    "vehicle disarm", "vehicle takeoff 10", "vehicle land --no-wait", "vehicle rtl --no-wait",
    "vehicle hold", "vehicle goto 47.3 8.5 10", "vehicle orbit 47.3 8.5 10", "vehicle mode LOITER",
    "vehicle mode NOSUCH", "vehicle modes", "vehicle speed 5", "vehicle yaw 90 --no-wait", "vehicle home",
    "vehicle reboot --no-wait", "vehicle info", "vehicle health", "vehicle statustext hello",
    "vehicle events --for 2",
    "vehicle servo 9 1500", "vehicle relay 1 on", "vehicle actuator 1 0.5", "vehicle motor-test 1 --yes",
    "vehicle gripper grip", "vehicle winch relax", "vehicle roi none", "vehicle transition multicopter",
    "vehicle ekf-source 1", "vehicle transponder --action-timeout 1",
    "vehicle failure gps --yes",
    "vehicle renumber 7", "vehicle calibrate gyroscope", "vehicle terminate --yes",
    "param list", "param get RALLY_LIMIT_KM NOSUCH", "param set NOSUCH 1", "param set LOG_BACKEND_TYPE 2",
    "param save - --format mavproxy", "param load hostile.param", "param diff hostile.param",
    "terrain check 47.3985 8.546", "terrain serve --height 488 --for 0.5",
    "param watch --for 2", "vehicle events --for 2",
    "mission upload hostile.waypoints", "mission upload hostile.waypoints --force", "mission download",
    "mission clear", "mission start", "mission show", "mission search square --center 47.3985,8.546",
    "ftp ls /", "ftp ls /bad", "ftp get -r /bad here",
    "ftp put hostile.param /bad/x.param", "ftp mkdir /bad/y",
    "ftp rename /bad/y /bad/z", "ftp crc /none", "ftp rm /none",
    "log list", "log get all", "log erase --yes", "log stream -o new.ulg --for 1",
    "rate ATTITUDE", "rate ATTITUDE 20",
    "key install hostile.hex udpin://:14550 --yes", "key off udpin://:14550 --key hostile.hex",
    "key rotate hostile udpin://:14550",
    "camera info", "camera list", "camera photo", "camera stop", "camera video start", "camera mode video",
    "camera stream stop 1", "camera zoom 50", "camera focus auto", "camera settings",
    "camera settings CAM_WBMODE Nosuch", "camera track off", "camera format --yes", "camera reset",
    "gimbal info", "gimbal point -45", "gimbal turn 0 15", "gimbal center", "gimbal retract",
    "gimbal roi off", "gimbal follow 2", "gimbal watch --for 2", "gimbal take", "gimbal release",
    "swarm takeoff 10", "swarm formation wedge", "swarm move 1 0", "swarm goto 47.3985 8.546",
    "swarm rotate 9", "swarm follow 9 --timeout 0.5", "swarm land", "swarm stop",
    "swarm search square --center 47.3985,8.546",
    "shell --command 'arm throttle'", "shell --command 'takeoff 10'", "shell --command modes",
    "shell --command 'nsh ver all'", "shell --command 'status STATUSTEXT'", "shell --command info",
    "shell --command 'ftp list /bad'", "shell --command 'watch STATUSTEXT 3'",
]  # fmt: skip
WITHOUT_VEHICLE = [
    "relay revoke room1.\x1b[2J --list new.txt",
    "relay serve --tickets none.key --for 0.01", "relay invite hostile ws://127.0.0.1:9 --tickets none.key",
    "rtk ntrip://127.0.0.1:9 --list", "traffic sbs://127.0.0.1:9 --count 0",
    "serial --nmea --out udpout://127.0.0.1:9 --rate 99",
    "swarm list", "swarm show hostile.skyc --check",
    "simulator list", "simulator hardware udpout://127.0.0.1:9 --for 0.01",
    "simulator betaflight --listen udpin://127.0.0.1:0 --for 0.01",
    "simulator vehicle ardupilot --to udpout://127.0.0.1:9 --for 0.01",
    "simulator px4 --listen tcpin://127.0.0.1:0 --for 0.01",
    "simulator ardupilot --listen udpin://127.0.0.1:0 --for 0.01",
    "watch hostile.tlog --once", "watch hostile.tlog --json", "watch hostile.tlog",
    "watch hostile.tlog --once --json", "record udpin://127.0.0.1:0 new.tlog --for 0.1",
    "data info hostile.tlog", "data info hostile.tlog --json", "data messages hostile.tlog STATUSTEXT",
    "data diff hostile.tlog hostile.tlog", "data repair hostile.tlog -o new.tlog", "data book .",
    "data merge hostile.tlog hostile.tlog",
    "data replay hostile.tlog --to udpout://127.0.0.1:9 --speed max", "data report hostile.tlog",
    "data report hostile.tlog --json",
    "data plot hostile.tlog STATUSTEXT.severity",
    "data decode hostile.json --hex 1b5b324a", "data decode hostile.json hostile.tlog",
    "data convert hostile.tlog --to csv -o out", "data query hostile.tlog STATUSTEXT.text",
    "data query hostile.tlog 'SELECT text AS nothing FROM STATUSTEXT' --json",
    "mission survey --area hostile.plan --dry-run",
    "mission show hostile.waypoints", "mission show hostile.plan", "mission convert hostile.plan -",
    "mission convert hostile.waypoints - --force", "param diff hostile.param hostile.param",
    "param diff hostile.param other.param",
    "dialect list", "dialect show hostile.xml", "dialect show hostile.xml BAD_MESSAGE",
    "dialect show hostile.xml NOSUCH", "dialect check hostile.xml", "dialect diff common hostile.xml --prose",
    "key new hostile", "key list", "key remove hostile --yes", "key ticket hostile.key", "key public hostile",
    "key identity hostile", "key offer hostile.hex --identity hostile --to hostile.pub -o new.offer",
    "key accept hostile.offer hostile --identity hostile --from hostile.pub",
    "route check hostile.toml", "route hostile.toml", "route --from hostile.conf --print",
    "route learn hostile.tlog", "route -e udpin://\x1b[2J:1",
    "web udpin://\x1b[2J:1 --no-browser",
    "dialect import hostile.xml -o facts.xml", "dialect stubs hostile.xml -o stubs",
    "gen c hostile.xml -o generated", "gen python hostile.xml -o generated --only NOSUCH",
    "doctor", "sim --for 1 --speed max --out udpout://127.0.0.1:9",
    "demo --for 1 --once", "completion bash",
]  # fmt: skip


def fitting(text: str, size: int) -> str:
    """Return as much of a text as fits into a field."""
    return text.encode()[:size].decode(errors="ignore")


def hostile_texts(packet: Packet) -> bytes:
    """Return a packet of a vehicle with the attack in its texts."""
    message = packet.message
    match message:
        case common.Statustext(text=text):
            changed = {"text": fitting(f"{text[:10]}{ATTACK}", 50)}
        case common.AvailableModes(mode_name=name):
            changed = {"mode_name": fitting(f"{name}{ATTACK}", 35)}
        case common.ParamValue(param_id=name) if name == "COM_RC_IN_MODE":
            changed = {"param_id": "COM_\x1b[2J\x9bA"}
        case common.AutopilotVersion():
            changed = {"flight_custom_version": b"\x1b[2J\x9b5n!"}
        case common.CameraInformation():
            changed = {"vendor_name": b"\x1b[2J\x9b5n", "model_name": b"\x1bc\x9b!"}
        case common.VideoStreamInformation():
            changed = {"name": fitting(f"a{ATTACK}", 32), "uri": fitting(f"rtsp://{ATTACK}", 160)}
        case common.SerialControl(data=data) if any(data):
            return packet.raw.replace(b"ver", b"\x1bc\x9b")
        case _:
            return packet.raw
    values = {name: getattr(message, name) for name in message.__match_args__} | changed
    return encode(
        type(message)(**values), system=packet.system, component=packet.component, sequence=packet.sequence
    )


@pytest.fixture
def hostile_link(monkeypatch):
    """Rewrite the texts in all packets of vehicles."""
    send = MemoryChannel.send_bytes

    def rewritten(self, data):
        packets = Parser(Dialect.load("all")).feed(bytes(data))
        return send(
            self, b"".join(each.raw if each.system == 255 else hostile_texts(each) for each in packets)
        )

    monkeypatch.setattr(MemoryChannel, "send_bytes", rewritten)


@pytest.fixture
def files(tmp_path, monkeypatch) -> None:
    """Write hostile files into the current directory."""
    monkeypatch.chdir(tmp_path)
    decoder = {
        "type": "mavstack-decoder",
        "messages": [{"fields": [{"name": "a", "type": "text", "size": 4}]}],
    }
    Path("hostile.json").write_text(json.dumps(decoder), "utf-8")
    head, name = "QGC WPL 110\n", ATTACK.replace("\r", "")
    Path("hostile.waypoints").write_text(
        f"{head}0 1 0 16 0 0 0 0 47 8 488 1\n1 0 3 {name} 0 0 0 0 47 8 10 1\n", "utf-8"
    )
    Path("hostile.plan").write_text('{"fileType": "\\u001b[2J", "\\u009b5n": {"\\u001b[2J": 1}}', "utf-8")
    Path("hostile.skyc").write_text(f"{name},{name}\n", "utf-8")
    Path("hostile.param").write_text(f"LOG_{name} 1\nRALLY_LIMIT_KM 3\n", "utf-8")
    Path("other.param").write_text("RALLY_LIMIT_KM 4\n", "utf-8")
    Path("hostile.hex").write_text("ab" * 32, "utf-8")
    for file in ("hostile.key", "hostile.pub", "hostile.offer"):
        Path(file).write_text(ATTACK, "utf-8")
    Path("hostile.toml").write_text('[endpoint."\\u001b[2J"]\nurl = "\\u009b5n"\n', "utf-8")
    Path("hostile.conf").write_text(
        f"[UdpEndpoint {name}]\nMode = {name}\n[{name}]\n{name} = {name}\n", "utf-8"
    )
    keys = tmp_path / "keys"
    keys.mkdir()
    (keys / f"{ATTACK.replace('/', '')}.key").write_text(ATTACK, "utf-8")
    monkeypatch.setattr(key_store, "key_directory", lambda: keys)
    escape = "\x9b5n\x7f\u202e&#10;"
    Path("hostile.xml").write_text(
        '<mavlink><enums><enum name="E"><entry value="1" name="E_X"/></enum></enums>'
        f'<messages><message id="150" name="BAD_MESSAGE"><description>{escape}</description>'
        f'<field type="uint8_t" name="a" units="{escape}" enum="E">{escape}</field>'
        "</message></messages></mavlink>",
        "utf-8",
    )
    texts = [f"{ATTACK}{number}" for number in range(3)]
    packets = [encode(common.Statustext(severity=4, text=text), system=1, component=1) for text in texts]
    packets.append(encode(common.NamedValueFloat(name="\x1b[2J\x9bA", value=1), system=1, component=1))
    Path("hostile.tlog").write_bytes(stamped(packets))


def controls(text: str, *, terminal: bool) -> set[str]:
    """Return the control characters in the output of a command, but for those of the command line itself."""
    rest = OWN_SEQUENCE.sub("", text) if terminal else text
    return {letter for letter in rest if not letter.isprintable() and letter not in "\n\t"}


def run(mav, line: str, monkeypatch, *, terminal: bool) -> None:
    if terminal:
        for stream in (sys.stdout, sys.stderr):
            monkeypatch.setattr(stream, "isatty", lambda: True)
    result = mav(*shlex.split(line))
    assert result.code in (0, 1, 2)
    assert controls(result.out + result.err, terminal=terminal) == set()
    assert "\N{REPLACEMENT CHARACTER}" in result.out + result.err or line not in REACHED


@pytest.mark.flight_cases(60)
@pytest.mark.fast_cases(40)
@pytest.mark.parametrize("terminal", [False, True], ids=["pipe", "terminal"])
@pytest.mark.parametrize("line", WITH_VEHICLE)
def test_texts_of_a_vehicle_do_not_control_the_terminal(
    mav, simulate, hostile_link, files, monkeypatch, line, terminal
):
    px4 = any(word in line for word in ("nsh", "modes", "NOSUCH", "param list", "param save"))
    payloads = line.startswith(("camera", "gimbal"))
    vehicles = simulate(PX4_COPTER if px4 else COPTER, ready=False, payloads=payloads)
    vehicles.put(f"/bad/{ATTACK.replace('/', '')}", b"content")
    monkeypatch.setattr("sys.stdin", None)
    run(mav, line, monkeypatch, terminal=terminal)


@pytest.mark.parametrize("line", WITHOUT_VEHICLE)
def test_texts_of_files_do_not_control_the_terminal(mav, files, monkeypatch, line):
    run(mav, line, monkeypatch, terminal=False)


def test_every_command_is_attacked():
    attacked = {tuple(line.split()[:2]) for line in WITH_VEHICLE + WITHOUT_VEHICLE}
    for name in COMMANDS.keys() - ATTACKED_ELSEWHERE:
        actions = [action for action, *_ in actions_of(command_parser(name))]
        assert any(words[0] == name for words in attacked), name
        assert [action for action in actions if (name, action) not in attacked] == []


def test_only_the_output_module_writes_to_the_terminal():
    top = Path(cli.__file__).parent
    found = []
    for path in top.rglob("*.py"):
        if path.relative_to(top).as_posix() in WRITERS:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            printed = (
                isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
            )
            written = isinstance(node, ast.Attribute) and ast.unparse(node) in (
                "sys.stdout.write",
                "sys.stderr.write",
            )
            found += [f"{path.name}:{node.lineno}"] if printed or written else []
    assert found == []
