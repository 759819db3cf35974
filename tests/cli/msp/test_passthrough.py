from __future__ import annotations

from argparse import ArgumentTypeError

import pytest

from mavstack.cli.msp.passthrough import port_identifier, port_name
from mavstack.msp import FirmwareInfo


@pytest.mark.parametrize(
    ("name", "new", "old"), [("uart2", 52, 1), ("UART10", 60, 9), ("softserial1", 30, 30), ("vcp", 20, 20)]
)
def test_identifiers_of_ports(name: str, new: int, old: int) -> None:
    assert port_identifier(port_name(name), FirmwareInfo("BTFL", api=(1, 49))) == new
    assert port_identifier(port_name(name), FirmwareInfo("BTFL", api=(1, 46))) == old
    assert port_identifier(port_name(name), FirmwareInfo("INAV", api=(2, 5))) == old


@pytest.mark.parametrize("name", ["", "UART", "UART0", "UART100", "VCP1", "COM1", "1"])
def test_names_that_are_no_ports(name: str) -> None:
    with pytest.raises(ArgumentTypeError, match="is no serial port"):
        port_name(name)
