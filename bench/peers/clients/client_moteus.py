"""The maker's own client with a moteus: a command and its answer in each millisecond."""

import asyncio
import math

import moteus  # type: ignore[import-not-found]
from pair import arguments, run

options = arguments()
loop = asyncio.new_event_loop()
asyncio.set_event_loop(loop)


async def begin() -> moteus.Controller:
    """The drive, stopped."""
    transport = moteus.PythonCan(interface="socketcan", channel=options.channel, fd=True)
    drive = moteus.Controller(id=1, transport=transport)
    await drive.set_stop()
    return drive


controller = loop.run_until_complete(begin())


def cycle() -> None:
    """One millisecond."""
    loop.run_until_complete(
        controller.set_position(position=math.nan, velocity=0.0, watchdog_timeout=0.2, query=True)
    )


run(options.seconds, cycle)
