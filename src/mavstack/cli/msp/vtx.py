"""`mav msp vtx`: the video transmitter of a flight controller."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.msp.connection import run_on_controller
from mavstack.cli.msp.settings import NOT_SAVED, apply, report
from mavstack.errors import MspDenied
from mavstack.msp.messages.vtx import (
    GetVtxTableBand,
    GetVtxTablePowerLevel,
    VtxConfig,
    VtxTableBand,
    VtxTablePowerLevel,
    VtxType,
)

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.bridges.msp.flight_controller import FlightController

#: The flight controller's parameter for each option of the video transmitter.
SETTINGS = {
    "band": "BF_VTX_BAND",
    "channel": "BF_VTX_CHANNEL",
    "power": "BF_VTX_POWER",
    "frequency": "BF_VTX_FREQ",
    "pit": "BF_VTX_PIT",
}


def add_arguments(action: ArgumentParser) -> None:
    """Declare the values."""
    action.add_argument("--band", type=int, metavar="N", help="band, from 1; 0: by its frequency")
    action.add_argument("--channel", type=int, metavar="N", help="channel of the band, from 1")
    action.add_argument("--power", type=int, metavar="N", help="power level, from 1")
    action.add_argument("--frequency", type=int, metavar="MHZ", help="frequency, with --band 0")
    action.add_argument("--pit", choices=("on", "off"), help="pit mode: very low power")
    action.add_argument("--save", action="store_true", help="save all settings")


def vtx(arguments: Namespace) -> int:
    """Run `mav msp vtx`."""
    values = {name: getattr(arguments, name) for name in SETTINGS}
    wanted = {SETTINGS[name]: value for name, value in values.items() if value is not None}
    if arguments.pit is not None:
        wanted[SETTINGS["pit"]] = int(arguments.pit == "on")

    async def work(controller: FlightController) -> int:
        if wanted:
            report(arguments, await apply(controller, wanted))
            if arguments.save:
                await controller.save()
            else:
                echo(NOT_SAVED, error=True)
            return 0
        document = await _document(controller)
        if arguments.json:
            echo_json(document)
        else:
            echo(*align_columns([(name.replace("_", " "), _text(value)) for name, value in document.items()]))
        return 0

    return run_on_controller(arguments, work)


async def _document(controller: FlightController) -> dict[str, object]:
    """Return the values that the controller sends, with the names of its table."""
    config = VtxConfig(VtxType.UNSUPPORTED)
    with suppress(MspDenied):
        config = await controller.get(VtxConfig)
    if config.band is None:
        raise CommandError(f"{controller.name} has no video transmitter")
    document: dict[str, object] = {"type": getattr(config.vtx_type, "name", str(config.vtx_type))}
    document |= {"band": config.band, "channel": config.channel, "frequency_mhz": config.frequency}
    document |= {"power": config.power, "pit_mode": config.pit_mode, "ready": config.is_ready}
    with suppress(MspDenied):
        if config.band and (config.table_bands or 0) >= config.band:
            band = await controller.get(VtxTableBand, GetVtxTableBand(config.band))
            document["band_name"] = band.name
        if config.power and (config.table_powers or 0) >= config.power:
            level = await controller.get(VtxTablePowerLevel, GetVtxTablePowerLevel(config.power))
            document["power_label"] = level.label
    return {name: value for name, value in document.items() if value is not None}


def _text(value: object) -> str:
    return ("yes" if value else "no") if isinstance(value, bool) else str(value)
