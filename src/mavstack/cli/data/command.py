"""`mav data`: logs on disk, whatever their format: facts, tables, conversion, queries, reports."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.data import convert, decode, files, info, query, report
from mavstack.cli.data.remote import LocalCopies

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

EXAMPLES: Final = """\
examples:
  mav data info flight.tlog                 # vehicle, times, messages, damage
  mav data info flight.tlog --json
  mav data info s3://bucket/flight.ulg      # a log can be a file or a URL
  mav data messages flight.tlog             # the messages with their rates
  mav data messages flight.tlog ATTITUDE    # the columns of one, with units and enums
  mav data convert flight.tlog --to parquet -o dataset/
  mav data convert flight.tlog --to csv -o columns/ --only ATTITUDE,VFR_HUD
  mav data convert flight.tlog --to kml     # the track, into flight.kml
  mav data convert capture.pcap --to tlog   # for ground stations, without signatures and keys
  mav data convert logs/*.tlog --to parquet -o dataset/ --jobs 4
  mav data convert 's3://bucket/*.ulg' --to parquet -o s3://bucket/dataset --dask tcp://10.0.0.1:8786
  mav data convert logs/*.BIN --to parquet -o dataset/ --resume done.txt
  mav data query flight.tlog "ATTITUDE.roll"
  mav data query flight.tlog "ATTITUDE.roll where armed"
  mav data query flight.tlog "ATTITUDE.roll, ATTITUDE.pitch where abs(roll) > 0.1 and mode = 'LOITER'"
  mav data query flight.tlog "SELECT max(alt) / 1000 FROM GLOBAL_POSITION_INT"
  mav data query flight.tlog "SELECT * FROM VFR_HUD" --csv | head
  mav data report flight.tlog               # findings, and the page flight.html
  mav data report flight.tlog --json
  mav data diff before.tlog after.tlog      # parameters and missions
  mav data merge flight.tlog 00000042.BIN   # how far their clocks are apart
  mav data merge flight.tlog 00000042.BIN --to parquet -o dataset/
  mav data repair damaged.tlog -o sound.tlog        # also .BIN and .ulg
  mav data replay flight.tlog --to udpout://127.0.0.1:14550 --speed 5
  mav data decode bench.json capture.bin    # frames of other protocols, by a decoder of dashboards
  mav data decode bench.json --hex "aa 55 04 01 06 ff 01 c0 4f" --json
  mav data book logs/                       # a table of all flights, kept in logs/flights.duckdb
  mav data book logs/ --csv flights.csv --incident 2026/flight.tlog "propeller lost"
  mav data plot flight.tlog attitude vibration            # on the terminal
  mav data plot flight.tlog power link -o power.png
  mav data plot flight.tlog VFR_HUD.alt ATTITUDE.roll -o charts.html
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "data", EXAMPLES, _with_copies)
    for module in (info, convert, query, report, files, decode):
        module.add_actions(actions)


def _with_copies(run: Callable[[Namespace], int], arguments: Namespace) -> int:
    with LocalCopies() as arguments.copies:
        return run(arguments)
