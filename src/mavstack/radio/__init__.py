"""SiK telemetry radios: AT sessions, parameters by name, changes that keep both ends of a pair together.

    async with SikModem("/dev/ttyUSB0") as modem:
        near, far = SikRadio(modem), SikRadio(modem, remote=True)
        print((await near.get_parameters())["NETID"].value, (await far.get_rssi()).fade_margin)
        await change_both(modem, {"NETID": 42}, {"NETID": 42})

`session.py` is the sans-IO AT session, `modem.py` its asyncio driver, `pair.py` the changes of both ends, and
`simulator.py` a simulated pair for tests and for trying things.
"""

from mavstack.radio.modem import SikModem, radio_url
from mavstack.radio.pair import Change, change_both, change_one, shared_differences, talks
from mavstack.radio.parameter_file import load_values, parse_values, save_values
from mavstack.radio.parameters import PARAMETERS, SHARED, RadioParameter, check_value
from mavstack.radio.pseudo_terminals import RadioTerminals
from mavstack.radio.replies import (
    RssiReport,
    StoredParameter,
    parse_number,
    parse_parameters,
    parse_rssi,
    parse_timing,
    signal_dbm,
)
from mavstack.radio.session import AtCommand, AtSession, Mode, Reply
from mavstack.radio.sik_radio import RadioIdentity, SikRadio
from mavstack.radio.simulator import RadioPair, SimulatedRadio

__all__ = [
    "PARAMETERS",
    "SHARED",
    "AtCommand",
    "AtSession",
    "Change",
    "Mode",
    "RadioIdentity",
    "RadioPair",
    "RadioParameter",
    "RadioTerminals",
    "Reply",
    "RssiReport",
    "SikModem",
    "SikRadio",
    "SimulatedRadio",
    "StoredParameter",
    "change_both",
    "change_one",
    "check_value",
    "load_values",
    "parse_number",
    "parse_parameters",
    "parse_rssi",
    "parse_timing",
    "parse_values",
    "radio_url",
    "save_values",
    "shared_differences",
    "signal_dbm",
    "talks",
]
