"""Send the data of the dashboards that the browser ground station shows as examples, as lines of values.

Two drones circle near Zermatt (ports 5781 and 5782), and a CanSat falls on its parachute (port 5790).
Choose a dashboard with CSV in `mav web`, and add its sources there. Ctrl-C ends the program.
"""

import asyncio
import math
import os
import time
from collections.abc import Callable

Values = Callable[[float], list[float]]

HOST = "127.0.0.1"
#: Degrees of latitude in a metre, and degrees of longitude in a metre at Zermatt.
LATITUDE, LONGITUDE = 1 / 111_200, 1 / (111_200 * math.cos(math.radians(46.0)))
INTERVAL = 0.1  # seconds
DESCENT = 180.0  # seconds of one flight of the CanSat


def drone(seconds: float, *, east: float, radius: float, speed: float, altitude: float) -> list[float]:
    """Return the columns of a drone on a circle: place, attitude in degrees, speed and voltage."""
    angle = seconds * speed / radius
    bank = math.degrees(math.atan2(speed**2, radius * 9.81))
    heading = -math.degrees(angle) % 360
    return [
        seconds,
        46.0037 + radius * math.sin(angle) * LATITUDE,
        7.7466 + (east + radius * math.cos(angle)) * LONGITUDE,
        altitude + 15 * math.sin(seconds / 20),
        -bank,
        3 * math.sin(seconds / 3),
        heading,
        speed,
        16.8 - 0.002 * (seconds % 900),
    ]


def cansat(seconds: float) -> list[float]:
    """Return the columns of a CanSat below its parachute, which swings and spins."""
    flown = seconds % DESCENT
    altitude = 1620 + 1000 * (1 - flown / DESCENT)
    swing = math.sin(2 * math.pi * 0.8 * seconds)
    return [
        seconds,
        46.0100 + flown * 2 * LATITUDE,
        7.7400 + flown * 3 * LONGITUDE,
        altitude,
        15 - 0.0065 * altitude,
        1013.25 * (1 - 2.25577e-5 * altitude) ** 5.25588,
        2 * swing,
        1.2 * math.sin(2 * math.pi * 1.1 * seconds),
        -9.81 + 0.6 * math.sin(2 * math.pi * 3.2 * seconds),
        18 * swing,
        12 * math.sin(2 * math.pi * 0.5 * seconds),
        (seconds * 40) % 360,
    ]


def north(seconds: float) -> list[float]:
    """Return the columns of the first drone."""
    return drone(seconds, east=0, radius=150, speed=12, altitude=1850)


def south(seconds: float) -> list[float]:
    """Return the columns of the second drone."""
    return drone(seconds, east=400, radius=90, speed=8, altitude=1790)


SENDERS: dict[int, Values] = {5781: north, 5782: south, 5790: cansat}


async def send(values: Values, writer: asyncio.StreamWriter) -> None:
    """Send a line every `INTERVAL` until the receiver leaves."""
    begun = time.monotonic()
    try:
        while not writer.is_closing():
            line = ",".join(
                f"{value:.7g}" if abs(value) < 1 else f"{value:.7f}"
                for value in values(time.monotonic() - begun)
            )
            writer.write(f"{line}\n".encode())
            await writer.drain()
            await asyncio.sleep(INTERVAL)
    except ConnectionError:
        pass
    finally:
        writer.close()


async def serve(values: Values, port: int) -> asyncio.Server:
    """Serve the lines of a sender to each receiver on a TCP port."""
    try:
        return await asyncio.start_server(lambda _, writer: send(values, writer), HOST, port)
    except OSError as error:
        raise SystemExit(f"cannot listen on port {port}: {os.strerror(error.errno or 0)}") from None


async def main() -> None:
    """Serve all senders."""
    servers = [await serve(values, port) for port, values in SENDERS.items()]
    print("sending on the ports", ", ".join(map(str, SENDERS)))
    await asyncio.gather(*(server.serve_forever() for server in servers))


if __name__ == "__main__":
    try:
        asyncio.run(main())
    except KeyboardInterrupt:
        print("ended")
