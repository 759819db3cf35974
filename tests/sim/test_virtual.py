from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

from mavstack.sim.virtual import VirtualLoop


class SlowToShutDown(ThreadPoolExecutor):
    """An executor whose threads end when the loop has asked for data once."""

    def __init__(self):
        super().__init__()
        self.loop_waits = threading.Event()

    def shutdown(self, wait=True, *, cancel_futures=False):
        self.loop_waits.wait()
        super().shutdown(wait=wait, cancel_futures=cancel_futures)


def test_the_clock_stays_while_threads_end(monkeypatch):
    """Otherwise the limit that Python 3.12 and later set to the end of threads is over at once."""
    loop, executor = VirtualLoop(), SlowToShutDown()
    select = loop._jumping.select

    def observed_select(timeout=None):
        if timeout is None:
            executor.loop_waits.set()
            return select(timeout)
        ready = select(timeout)
        if timeout > 0:
            executor.loop_waits.set()
        return ready

    monkeypatch.setattr(loop._jumping, "select", observed_select)
    loop.set_default_executor(executor)
    loop.run_until_complete(loop.shutdown_default_executor(300))
    assert loop.time() == 0
    loop.close()
