"""Logs of packets, compared with the log reader of pymavlink."""

from __future__ import annotations

import random
import warnings

import numpy as np

from mavstack.dialects import Dialect
from mavstack.logs import open_log
from tests.logs.files import encoded, stamped
from tests.wire.values import random_message


def test_pymavlink_finds_the_same_packets(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from pymavlink import mavutil
    rng = random.Random(3)
    names = ("ATTITUDE", "HEARTBEAT", "PARAM_VALUE", "GLOBAL_POSITION_INT", "STATUSTEXT", "BATTERY_STATUS")
    messages = [
        random_message(Dialect.load("common")[rng.choice(names)], "random", number) for number in range(300)
    ]
    path = tmp_path / "log.tlog"
    path.write_bytes(stamped(encoded(messages[:200]) + encoded(messages[200:], version=1)))
    log = open_log(path)
    reader = mavutil.mavlogfile(str(path), notimestamps=False)
    found = {}
    while (message := reader.recv_msg()) is not None:
        found.setdefault(message.get_type(), []).append(message)
    reader.close()
    assert {name: len(messages) for name, messages in found.items()} == log.counts
    for name, field in (("ATTITUDE", "roll"), ("GLOBAL_POSITION_INT", "lat"), ("PARAM_VALUE", "param_index")):
        theirs = np.array([getattr(message, field) for message in found[name]])
        np.testing.assert_array_equal(log[name][field].astype(theirs.dtype), theirs)
        times = [message._timestamp for message in found[name]]
        np.testing.assert_allclose(log[name]["_time"].astype("i8") / 1e6, times, rtol=0, atol=1e-6)
        assert log[name]["_sequence"].tolist() == [message.get_seq() for message in found[name]]
