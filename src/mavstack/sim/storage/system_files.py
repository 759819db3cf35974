"""ArduPilot's `@SYS` files: serial ports, tasks, threads, memory, timers.

A simulated vehicle has none of these; the numbers are invented and depend only on the time since boot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.ftp import VirtualFile

if TYPE_CHECKING:
    from collections.abc import Callable

#: Serial ports: name, and bytes per second sent and received.
_PORTS = (("SERIAL0", 2900, 240), ("SERIAL1", 5400, 310), ("SERIAL2", 0, 0), ("SERIAL3", 110, 4600))
#: Tasks of the scheduler: name, microseconds per run, runs per second.
_TASKS = (
    ("rc_loop", 6, 250),
    ("throttle_loop", 4, 50),
    ("update_GPS", 21, 50),
    ("update_batt_compass", 38, 10),
    ("read_aux_all", 5, 10),
    ("arm_motors_check", 2, 10),
    ("update_altitude", 9, 10),
    ("run_nav_updates", 7, 50),
    ("three_hz_loop", 3, 3),
    ("one_hz_loop", 12, 1),
    ("gcs_update_receive", 24, 400),
    ("gcs_update_send", 61, 400),
    ("logger_periodic", 11, 400),
)
#: Threads: name, priority, stack size, unused stack.
_THREADS = (("main", 182, 12288, 6112), ("timer", 181, 1536, 704), ("rcin", 177, 1024, 412),
            ("io", 58, 2048, 888), ("storage", 59, 1024, 540), ("log_io", 58, 1580, 660))  # fmt: skip
_MEMORY = (("DTCM", 131072, 24512), ("SRAM1", 262144, 61440), ("AXI", 524288, 187904))


def system_files(uptime: Callable[[], float]) -> dict[str, VirtualFile]:
    """Return the files of `@SYS`; `uptime` returns the seconds since boot."""
    makers = {
        "uarts.txt": _uarts,
        "tasks.txt": _tasks,
        "threads.txt": _threads,
        "memory.txt": _memory,
        "timers.txt": _timers,
    }
    return {f"@SYS/{name}": _file(make, uptime) for name, make in makers.items()}


def _file(make: Callable[[float], list[str]], uptime: Callable[[], float]) -> VirtualFile:
    """Return a virtual file whose lines `make` generates."""
    return VirtualFile(lambda query: ("\n".join(make(max(uptime(), 0.0))) + "\n").encode())


def _uarts(seconds: float) -> list[str]:
    """Return the lines of uarts.txt."""
    ports = [
        f"{name} TX={int(sent * seconds)} RX={int(received * seconds)} TXBD={sent * 10} RXBD={received * 10}"
        for name, sent, received in _PORTS
    ]
    return ["UARTV1", *ports]


def _tasks(seconds: float) -> list[str]:
    """Return the lines of tasks.txt."""
    tasks = [
        f"{name:<24} MIN={cost // 2:3} MAX={cost * 3:4} AVG={cost:3} OVR={0:2} SLP={0:2},"
        f" TOT={min(cost * rate / 1e4, 99.9):4.1f}%"
        for name, cost, rate in _TASKS
    ]
    return ["TasksV2", *tasks]


def _threads(seconds: float) -> list[str]:
    """Return the lines of threads.txt."""
    threads = [f"{name:<12} PRI={level:3} STACK={free}/{size}" for name, level, size, free in _THREADS]
    return ["ThreadsV1", *threads]


def _memory(seconds: float) -> list[str]:
    """Return the lines of memory.txt."""
    return ["MemInfoV1", *(f"{name:<6} FREE={free:7} OF={size:7}" for name, size, free in _MEMORY)]


def _timers(seconds: float) -> list[str]:
    """Return the lines of timers.txt."""
    return ["TIMERV1", f"TIM1 CLK=400MHz TICKS={int(seconds * 1000)}", "TIM3 CLK=200MHz PWM=400Hz"]
