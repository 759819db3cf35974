"""`mav radio`: the parameters of SiK telemetry radios, at both ends of the link.

Shared parameters are set at both ends, the others at this one, unless an option says otherwise. The radio
passes bytes again when a command ends, also after Ctrl-C.
"""

from __future__ import annotations

import asyncio
from argparse import ArgumentTypeError
from contextlib import aclosing, asynccontextmanager
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.radio.simulation import add_simulation_options, run_simulation
from mavstack.errors import InvalidArgumentError
from mavstack.radio.modem import SikModem, radio_url
from mavstack.radio.pair import change_both, change_one, plan_change, shared_differences
from mavstack.radio.parameter_file import load_values, save_values
from mavstack.radio.parameters import PARAMETERS, SHARED, check_value
from mavstack.radio.sik_radio import SikRadio, require_known

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator, Callable, Mapping

    from mavstack.radio.pair import Change
    from mavstack.radio.replies import RssiReport, StoredParameter
    from mavstack.radio.sik_radio import RadioIdentity

EXAMPLES: Final = """\
examples:
  mav radio show /dev/ttyUSB0                       # firmware and parameters of this radio
  mav radio show /dev/ttyUSB0 --both                # of both ends, and where they differ
  mav radio show tcpout://192.168.1.20:4001 --json  # over a serial server
  mav radio get /dev/ttyUSB0 NETID AIR_SPEED
  mav radio get /dev/ttyUSB0 TXPOWER --remote
  mav radio set /dev/ttyUSB0 NETID=42 AIR_SPEED=96  # at both ends, the remote one first
  mav radio set /dev/ttyUSB0 TXPOWER=11 --remote
  mav radio set /dev/ttyUSB0 NETID=42 --local       # the other radio has its own cable
  mav radio reset /dev/ttyUSB0 --both --dry-run     # how they differ from the values of the factory
  mav radio save /dev/ttyUSB0 boat.radio
  mav radio load /dev/ttyUSB0 boat.radio
  mav radio load /dev/ttyUSB0 boat.radio --dry-run
  mav radio rssi /dev/ttyUSB0                       # each second, until Ctrl-C
  mav radio rssi /dev/ttyUSB0 --count 1 --json
  mav radio sim --near near --far far               # a simulated pair on two terminals, to try this
  mav radio sim --profile acoustic --near near --far far           # modems under water
  mav radio sim --profile sbd --near modem --gateway udpout://127.0.0.1:14550    # an Iridium modem
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "radio", EXAMPLES)
    action = _add(actions, "show", "show firmware and parameters", show)
    _add_end(action, both="both radios, and the shared parameters that differ")
    action.add_argument("--timing", action="store_true", help="the timing of transmissions too (ATI6)")
    action = _add(actions, "get", "print parameters", get)
    action.add_argument("names", nargs="+", metavar="NAME", help="name of a parameter")
    _add_end(action)
    action = _add(actions, "set", "set, store and apply parameters; the radios restart", set_values)
    action.add_argument("words", nargs="+", metavar="NAME=VALUE", help="name and value of a parameter")
    _add_ends(action)
    action = _add(actions, "reset", "set, store and apply the values of the factory", reset)
    action.add_argument("--dry-run", action="store_true", help="show the changes, and change nothing")
    _add_ends(action)
    action = _add(actions, "save", "save the parameters to a file", save)
    action.add_argument("file", metavar="FILE", help="the file")
    _add_end(action)
    action = _add(actions, "load", "set, store and apply the parameters of a file", load)
    action.add_argument("file", metavar="FILE", help="the file, of `mav radio save` or a reply to ATI5")
    action.add_argument("--dry-run", action="store_true", help="show the changes, and change nothing")
    _add_ends(action)
    action = _add(actions, "rssi", "show signal and noise of both ends each second", rssi)
    action.add_argument("--count", type=_count, metavar="N", help="end after N reports (default: at Ctrl-C)")
    action = actions.add("sim", "simulate radios or modems on pseudo terminals", simulate)
    add_simulation_options(action)


def show(arguments: Namespace) -> int:
    """Run `mav radio show`."""
    return run_until_signal(_show(arguments))


def get(arguments: Namespace) -> int:
    """Run `mav radio get`."""
    return run_until_signal(_get(arguments))


def set_values(arguments: Namespace) -> int:
    """Run `mav radio set`."""
    return run_until_signal(_apply(arguments, _parse_words(arguments.words)))


def reset(arguments: Namespace) -> int:
    """Run `mav radio reset`."""
    return run_until_signal(_apply(arguments, None))


def save(arguments: Namespace) -> int:
    """Run `mav radio save`."""
    return run_until_signal(_save(arguments))


def load(arguments: Namespace) -> int:
    """Run `mav radio load`."""
    return run_until_signal(_apply(arguments, load_values(arguments.file)))


def rssi(arguments: Namespace) -> int:
    """Run `mav radio rssi`."""
    return run_until_signal(_rssi(arguments))


def simulate(arguments: Namespace) -> int:
    """Run `mav radio sim`."""
    return run_until_signal(run_simulation(arguments))


async def _show(arguments: Namespace) -> int:
    async with _open(arguments) as modem:
        ends = (False, True) if arguments.both else (arguments.remote,)
        radios = [SikRadio(modem, remote=remote) for remote in ends]
        found = [(each, await each.get_identity(), await each.get_parameters()) for each in radios]
        timing = {each.name: await each.get_timing() for each in radios} if arguments.timing else {}
    differences = shared_differences(found[0][2], found[-1][2])
    if arguments.json:
        document: dict[str, object] = {each.name: _document(who, known) for each, who, known in found}
        if arguments.both:
            document["differences"] = sorted(differences)
        if arguments.timing:
            document["timing"] = timing
        echo_json(document)
        return 0
    for each, who, _ in found:
        band = f", {who.band} MHz" if who.band else ""
        echo(f"{each.name}: {who.banner}{band}")
    echo(*align_columns(_rows([known for _, _, known in found])))
    for name, numbers in timing.items():
        echo(f"timing of the {name} radio: " + ", ".join(f"{key} {value}" for key, value in numbers.items()))
    if differences:
        echo(
            f"the ends differ in {', '.join(differences)}: they lose each other at the next restart",
            error=True,
        )
    return 0


def _rows(ends: list[dict[str, StoredParameter]]) -> list[tuple[str, ...]]:
    names = dict.fromkeys(name for known in ends for name in known)
    titles = ("VALUE",) if len(ends) == 1 else ("LOCAL", "REMOTE")
    rows = [("", "NAME", *titles, "UNIT", "MEANING")]
    for name in names:
        known = PARAMETERS.get(name)
        number = next(end[name].number for end in ends if name in end)
        values = (str(end[name].value) if name in end else "-" for end in ends)
        summary = known.summary + ("; the same at both ends" if known.shared else "") if known else ""
        rows.append((f"S{number}", name, *values, known.unit if known else "", summary))
    return rows


def _document(who: RadioIdentity, known: Mapping[str, StoredParameter]) -> dict[str, object]:
    return {
        "firmware": who.banner,
        "board": who.board,
        "band_mhz": who.band,
        "bootloader": who.bootloader,
        "parameters": {name: each.value for name, each in known.items()},
    }


async def _get(arguments: Namespace) -> int:
    names = [name.upper() for name in arguments.names]
    async with _open(arguments) as modem:
        radio = SikRadio(modem, remote=arguments.remote)
        if all(name in PARAMETERS for name in names):
            values = {name: await radio.get_value(PARAMETERS[name].number) for name in names}
        else:
            known = await radio.get_parameters()
            require_known(names, known, radio)
            values = {name: known[name].value for name in names}
    if arguments.json:
        echo_json(values)
    else:
        echo(*(f"{name}={value}" for name, value in values.items()))
    return 0


async def _save(arguments: Namespace) -> int:
    async with _open(arguments) as modem:
        radio = SikRadio(modem, remote=arguments.remote)
        who, known = await radio.get_identity(), await radio.get_parameters()
    values = {name: each.value for name, each in known.items() if name != "FORMAT"}
    save_values(arguments.file, values, f"{who.banner}, {radio.name} radio")
    if arguments.json:
        echo_json({"file": arguments.file, "parameters": values})
    else:
        echo(f"{len(values)} parameters of the {radio.name} radio saved to {arguments.file}")
    return 0


async def _apply(arguments: Namespace, values: Mapping[str, int] | None) -> int:
    """Change one radio or both; None: to the values of the factory."""
    async with _open(arguments) as modem:
        near, far = SikRadio(modem), SikRadio(modem, remote=True)
        if values is None:
            values = await (far if arguments.remote else near).get_factory_values()
        local = {} if arguments.remote else dict(values)
        remote = {name: value for name, value in values.items() if _goes_to_remote(name, arguments)}
        if getattr(arguments, "dry_run", False):
            parts = ((near, local), (far, remote))
            changes = [await plan_change(radio, wanted) for radio, wanted in parts if wanted]
        elif local and remote:
            changes = await _change_both(modem, local, remote)
        else:
            changes = [await change_one(near, local) if local else await change_one(far, remote)]
    _report(arguments, changes)
    return 0


async def _change_both(modem: SikModem, local: Mapping[str, int], remote: Mapping[str, int]) -> list[Change]:
    """Change both ends; Ctrl-C waits for the end, because half a change separates the radios."""
    change = asyncio.ensure_future(change_both(modem, local, remote, _report_step))
    try:
        return list(await asyncio.shield(change))
    except asyncio.CancelledError:
        echo("interrupted: finishing the change first, so that the radios stay together …", error=True)
        await change
        raise


def _report_step(step: str) -> None:
    echo(f"{step} …", error=True)


def _goes_to_remote(name: str, arguments: Namespace) -> bool:
    if arguments.local:
        return False
    return arguments.remote or arguments.both or name in SHARED


def _report(arguments: Namespace, changes: list[Change]) -> None:
    if arguments.json:
        echo_json({each.radio.name: dict(each.values) for each in changes})
        return
    lines = [
        f"{each.radio.name}: {name}: {each.old[name]} → {value}"
        for each in changes
        for name, value in each.values.items()
    ]
    echo(*(lines or ["nothing to change"]))
    if any(each.radio.remote for each in changes) and len(changes) == 1 and lines:
        lost = sorted(set(changes[0].values) & SHARED)
        if lost:
            echo(
                f"this radio has other values of {', '.join(lost)} and hears the remote one no more",
                error=True,
            )


async def _rssi(arguments: Namespace) -> int:
    async with _open(arguments) as modem, aclosing(SikRadio(modem).stream_rssi()) as reports:
        number = 0
        async for report in reports:
            if arguments.json:
                echo_json({**_signal(report), "fade_margin_db": round(report.fade_margin, 1)})
            else:
                echo(_signal_text(report))
            number += 1
            if number == arguments.count:
                break
    return 0


def _signal(report: RssiReport) -> dict[str, int | None]:
    return {name: getattr(report, name) for name in type(report).__dataclass_fields__}


def _signal_text(report: RssiReport) -> str:
    errors = report.receive_errors + report.transmit_errors
    return (
        f"local {report.local_rssi} (noise {report.local_noise})  remote {report.remote_rssi} "
        f"(noise {report.remote_noise})  margin {report.fade_margin:.0f} dB  packets {report.packets}  "
        f"errors {errors}  corrected {report.corrected_packets}"
    )


@asynccontextmanager
async def _open(arguments: Namespace) -> AsyncIterator[SikModem]:
    """Open the radio; it passes bytes again at the end."""
    async with SikModem(radio_url(arguments.url, arguments.baud)) as modem:
        yield modem


def _parse_words(words: list[str]) -> dict[str, int]:
    values: dict[str, int] = {}
    for word in words:
        name, mark, value = word.partition("=")
        if not mark or not name or not value.isdecimal():
            raise UsageError(f"{word!r} is no parameter and value, such as NETID=25")
        if name.upper() in values:
            raise UsageError(f"{name.upper()} is given twice")
        values[name.upper()] = int(value)
        try:
            check_value(name.upper(), int(value))
        except InvalidArgumentError as error:
            raise UsageError(str(error)) from None
    return values


def _add(actions: Actions, name: str, summary: str, work: Callable[[Namespace], int]) -> ArgumentParser:
    parser = actions.add(name, summary, work)
    parser.add_argument("url", metavar="URL", help="serial device of the radio, or a URL")
    parser.add_argument(
        "--baud", type=_count, metavar="N", help="baud rate of the serial port (default: 57600)"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    return parser


def _add_end(parser: ArgumentParser, both: str = "") -> None:
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--remote", action="store_true", help="the radio at the other end")
    if both:
        group.add_argument("--both", action="store_true", help=both)


def _add_ends(parser: ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--local", action="store_true", help="only this radio, also for shared parameters")
    group.add_argument("--remote", action="store_true", help="only the radio at the other end")
    group.add_argument(
        "--both", action="store_true", help="both radios (default: shared parameters both, others this one)"
    )


def _count(text: str) -> int:
    if not (text.isdecimal() and int(text) > 0):
        raise ArgumentTypeError(f"{text!r} is not a number above 0")
    return int(text)
