"""The cells of the guide to notebooks run in a kernel of Jupyter, one after the other."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest

from tests.docs.blocks import BLOCKS

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

manager = pytest.importorskip("jupyter_client.manager")
pytest.importorskip("ipykernel")
CELLS = [block for block in BLOCKS if block.directive == "cell"]
#: Seconds for a cell, on a busy machine too.
TIME_LIMIT = 90.0


@pytest.fixture
async def kernel() -> AsyncIterator[Any]:
    found, client = await manager.start_new_async_kernel(kernel_name="python3", startup_timeout=TIME_LIMIT)
    try:
        yield client
    finally:
        client.stop_channels()
        await found.shutdown_kernel(now=True)


@pytest.mark.filterwarnings("ignore")  # of Jupyter's own libraries
async def test_cells_run_in_a_kernel(kernel: Any) -> None:
    results: list[str] = []

    def keep(message: dict[str, Any]) -> None:
        content = message["content"]
        results.append(content.get("text") or content.get("data", {}).get("text/plain", ""))

    async with asyncio.timeout(TIME_LIMIT):
        for cell in CELLS:
            reply = await kernel.execute_interactive(cell.text, output_hook=keep, stop_on_error=True)
            assert reply["content"]["status"] == "ok", "".join(reply["content"].get("traceback", []))
    shown = "".join(results)
    assert shown.count("STABILIZE") == 2, shown
