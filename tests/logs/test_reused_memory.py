"""Memory that large tables use one after the other."""

from __future__ import annotations

from threading import Thread
from typing import TYPE_CHECKING

from mavstack.logs.reused_memory import ReusedMemory

if TYPE_CHECKING:
    import numpy as np

SIZE = 1 << 20


def address(memory: np.ndarray) -> int:
    return memory.ctypes.data


def test_memory_is_used_again_when_no_array_uses_it_any_more():
    reused = ReusedMemory(4 * SIZE)
    memory = reused.take(SIZE)
    first, view = address(memory), memory[100:200].view("<i4")
    view[:] = 7
    del memory
    assert reused.waiting == 0, "a view uses it"
    other = reused.take(SIZE)
    other[:] = 0
    assert address(other) != first
    assert (view == 7).all()
    del view
    assert reused.waiting == SIZE
    again = reused.take(SIZE - 1000)
    assert address(again) == first
    assert len(again) == SIZE - 1000
    assert reused.waiting == 0


def test_a_block_that_is_much_larger_is_left_for_others():
    reused = ReusedMemory(4 * SIZE)
    del_me = reused.take(2 * SIZE)
    del del_me
    small = reused.take(SIZE)
    assert reused.waiting == 2 * SIZE
    assert len(small) == SIZE


def test_waiting_memory_is_limited():
    reused = ReusedMemory(4 * SIZE)
    blocks = [reused.take(SIZE) for _ in range(6)]
    blocks.clear()
    assert reused.waiting == 4 * SIZE
    large = reused.take(3 * SIZE)
    assert reused.waiting == SIZE, "blocks that do not fit make room"
    del large
    assert reused.waiting == 4 * SIZE


def test_several_threads_never_get_the_same_memory():
    reused = ReusedMemory(4 * SIZE)
    wrong: list[int] = []

    def use(number: int) -> None:
        for _ in range(200):
            memory = reused.take(4096)
            memory[:] = number
            if not (memory == number).all():
                wrong.append(number)

    threads = [Thread(target=use, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []
    assert 4096 <= reused.waiting <= 8 * 4096, "each thread has two blocks at most"
