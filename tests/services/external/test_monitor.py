from __future__ import annotations

import pytest

from mavstack.services.external import PoseEstimate, StreamMonitor


def test_rate_and_delay_of_the_last_seconds():
    monitor = StreamMonitor()
    assert (monitor.rate(0.0), monitor.delay(0.0), monitor.sent) == (0.0, None, 0)
    estimate = PoseEstimate((0, 0, 0), quality=40)
    for number in range(100):
        now = 100 + number / 20
        monitor.add(now - 0.03, now, estimate)
    now = 100 + 99 / 20
    assert monitor.rate(now) == pytest.approx(20)
    assert monitor.delay(now) == pytest.approx(0.03)
    assert (monitor.sent, monitor.quality, monitor.parts) == (100, 40, {"position"})
    assert monitor.rate(now + 10) == 0.0
