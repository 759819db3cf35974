"""`mav msp`: flight controllers with Betaflight or iNav, over MSP.

The command line interface (CLI) of these firmwares ends with a restart of the controller, so the actions
that use it wait until the controller answers again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.msp import bridging, console, identity, osd, passthrough, settings, transfer, vtx
from mavstack.cli.msp.connection import add_connection

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

EXAMPLES: Final = """\
examples:
  mav msp info /dev/ttyACM0                         # firmware, board, name
  mav msp info msp+tcp://127.0.0.1:5761 --json      # of a simulated controller
  mav msp get /dev/ttyACM0                          # all settings
  mav msp get /dev/ttyACM0 "BF_PID_ROLL_*" --json
  mav msp set /dev/ttyACM0 BF_PID_ROLL_P=50 BF_PID_ROLL_D=32 --save
  mav msp osd /dev/ttyACM0 --draw                   # a picture of the on-screen display
  mav msp osd /dev/ttyACM0 MAIN_BATT_VOLTAGE=2,14 CROSSHAIRS=off --save
  mav msp vtx /dev/ttyACM0
  mav msp vtx /dev/ttyACM0 --band 5 --channel 3 --power 1 --save
  mav msp cli /dev/ttyACM0                          # interactive, until exit or save
  mav msp cli /dev/ttyACM0 -c "get gyro" -c status  # these lines, without saving
  mav msp cli /dev/ttyACM0 -c "set gyro_lpf1_static_hz = 250" --save
  mav msp dump /dev/ttyACM0 -o quad.txt             # all settings that differ from the defaults
  mav msp dump /dev/ttyACM0 --full                  # all settings, on standard output
  mav msp restore /dev/ttyACM0 quad.txt
  mav msp passthrough /dev/ttyACM0 --port UART2     # a GPS receiver, for its own program
  mav msp passthrough /dev/ttyACM0 --esc --out tcpin://127.0.0.1:5770
  mav msp bridge /dev/ttyACM0 udpout://127.0.0.1:14550   # a MAVLink vehicle for ground stations
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "msp", EXAMPLES)
    _add(actions, "info", "show firmware, board and name", identity.info)
    action = _add(actions, "get", "show settings", settings.get)
    action.add_argument("names", nargs="*", metavar="NAME", help="names, or patterns such as BF_PID_*")
    action = _add(actions, "set", "change settings, and read them back", settings.set_values)
    action.add_argument("words", nargs="+", metavar="NAME=VALUE", help="name and value of a setting")
    action.add_argument("--save", action="store_true", help="save all settings")
    action = _add(actions, "osd", "show or move the items of the on-screen display", osd.osd)
    action.add_argument("words", nargs="*", metavar="ITEM=COLUMN,ROW", help="item and place, or ITEM=off")
    action.add_argument("--profile", type=int, choices=(1, 2, 3), default=1, help="profile (default: 1)")
    action.add_argument("--draw", action="store_true", help="draw the display")
    action.add_argument("--save", action="store_true", help="save all settings")
    vtx.add_arguments(_add(actions, "vtx", "show or set the video transmitter", vtx.vtx))
    action = _add(actions, "cli", "use the command line interface of the controller", console.cli)
    action.add_argument(
        "-c",
        "--command",
        dest="lines",
        action="append",
        default=[],
        metavar="LINE",
        help="send a line, and end; any number of them (default: lines of standard input)",
    )
    action.add_argument("--save", action="store_true", help="save all settings at the end")
    action = _add(actions, "dump", "save the settings as text", transfer.dump)
    action.add_argument(
        "-o", "--output", dest="file", metavar="FILE", help="the file (default: standard output)"
    )
    action.add_argument("--full", action="store_true", help="all settings, also those with default values")
    action = _add(actions, "restore", "apply and save the settings of a dump", transfer.restore)
    action.add_argument("file", metavar="FILE", help="a file of `mav msp dump`, or - for standard input")
    action = _add(
        actions, "passthrough", "connect a link with the ESCs or a serial port", passthrough.passthrough
    )
    where = action.add_mutually_exclusive_group(required=True)
    where.add_argument("--esc", action="store_true", help="the ESCs, by the 4-way interface")
    where.add_argument(
        "--port", type=passthrough.port_name, metavar="NAME", help="a serial port: UART2, SOFTSERIAL1, VCP"
    )
    action.add_argument(
        "--out",
        default=passthrough.DEFAULT_OUT,
        metavar="URL",
        help=f"link for the other program (default: {passthrough.DEFAULT_OUT})",
    )
    action = _add(actions, "bridge", "make the controller a MAVLink vehicle", bridging.bridge)
    action.add_argument("links", nargs="+", metavar="MAVLINK_URL", help="links on which the vehicle appears")
    action.add_argument(
        "--system", type=int, default=1, metavar="ID", help="system id of the vehicle (default: 1)"
    )


def _add(actions: Actions, name: str, summary: str, work: Callable[[Namespace], int]) -> ArgumentParser:
    parser = actions.add(name, summary, work)
    add_connection(parser)
    return parser
