"""A router that runs until a signal ends it: its control API, its file, its picture."""

from __future__ import annotations

import asyncio
import signal
import sys
from contextlib import AsyncExitStack, suppress
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from mavstack.cli.common.ending_signals import calling_on_signals
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.output import echo, echo_json
from mavstack.links.registry import resolve_url
from mavstack.router.router import Router

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable, Coroutine

    from mavstack.links.url import LinkURL
    from mavstack.router.config import RouterConfig
    from mavstack.router.reloading import ConfigFile


class _Opened(NamedTuple):
    """A link of the router."""

    url: LinkURL


#: Seconds between two lines of `--json`.
JSON_INTERVAL: Final = 1.0


async def run_router(
    config: RouterConfig, arguments: Namespace, path: str, load: Callable[[str], RouterConfig]
) -> int:
    """Run a router until SIGINT or SIGTERM; return the exit code.

    Args:
        config: The configuration.
        arguments: The arguments of the command.
        path: The configuration file that is watched; empty: none.
        load: Reads the file again.
    """
    end = asyncio.Event()
    async with AsyncExitStack() as stack:
        router = await stack.enter_async_context(Router(config))
        tasks = _Tasks(end)
        stack.push_async_callback(tasks.cancel)
        tasks.start(router.serve_forever())
        file = _watched(path, router, load) if path else None
        if config.control:
            await _serve_control(stack, router, file)
        if file is not None and config.watch:
            tasks.start(file.watch())
        announce_exposure("route", [_Opened(resolve_url(each.url)) for each in config.endpoints if each.url])
        reload = file.try_to_reload if file is not None else None
        with calling_on_signals(
            _callbacks(end, reload, tasks)
        ):  # set the handlers before the first output: the reader of the output may end the router
            _show(router, arguments, tasks, stack)
            with suppress(asyncio.CancelledError):  # Ctrl-C: asyncio cancels the main task
                await end.wait()
        if tasks.error is not None:
            raise tasks.error
    return 0


def _watched(path: str, router: Router, load: Callable[[str], RouterConfig]) -> ConfigFile:
    from mavstack.router.reloading import ConfigFile

    return ConfigFile(path, router, load)


async def _serve_control(stack: AsyncExitStack, router: Router, file: ConfigFile | None) -> None:
    from mavstack.http.server import serving
    from mavstack.router.control.app import ControlApi

    config = router.config
    api = ControlApi(
        router,
        token=config.control_token,
        reload=file.reload if file is not None else None,
        metrics=config.metrics,
    )
    host, port = await stack.enter_async_context(serving(api.app, config.control, name="the control API"))
    echo(f"mav route: control API on http://{host}:{port}", error=True)


class _Tasks:
    """The tasks beside a router; they end with it, and an error in one of them ends the router."""

    def __init__(self, end: asyncio.Event) -> None:
        self._tasks: set[asyncio.Task[Any]] = set()
        self._end = end
        self.error: BaseException | None = None

    def start(self, work: Coroutine[Any, Any, Any]) -> None:
        """Run a coroutine until it ends, or the router does."""
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._task_done)

    async def cancel(self) -> None:
        """Cancel all tasks, and wait for them."""
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _task_done(self, task: asyncio.Task[Any]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()):
            self.error = error
            self._end.set()


def _show(router: Router, arguments: Namespace, tasks: _Tasks, stack: AsyncExitStack) -> None:
    """Start the live picture on a terminal, or the JSON; otherwise print the endpoints once."""
    if arguments.json:
        tasks.start(_print_json(router))
    elif sys.stdout.isatty() and not arguments.once:
        from mavstack.cli.route.display import RouterDisplay

        display = stack.enter_context(RouterDisplay(router))
        tasks.start(display.run())
    else:
        for each in router.config.endpoints:
            endpoint = router.endpoints.get(each.name)
            address = f" on {endpoint.listens_on}" if endpoint and endpoint.listens_on else ""
            echo(f"{each.name}: {endpoint.state if endpoint else 'failed'}{address} ({each.location})")


async def _print_json(router: Router) -> None:
    from mavstack.router.snapshot import snapshot_values, take_snapshot

    while True:
        echo_json(snapshot_values(take_snapshot(router)))
        await asyncio.sleep(JSON_INTERVAL)


def _callbacks(
    end: asyncio.Event, reload: Callable[[], Awaitable[None]] | None, tasks: _Tasks
) -> dict[signal.Signals, Callable[[], object]]:
    """Return the callbacks of SIGTERM, which ends the router, and SIGHUP, which loads its file again."""
    callbacks: dict[signal.Signals, Callable[[], object]] = {signal.SIGTERM: end.set}
    if reload is not None and hasattr(signal, "SIGHUP"):
        callbacks[signal.SIGHUP] = lambda: tasks.start(_call(reload))
    return callbacks


async def _call(work: Callable[[], Awaitable[None]]) -> None:
    await work()
