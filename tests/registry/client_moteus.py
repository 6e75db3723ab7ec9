"""The maker's own client turns a simulated moteus, and prints what it has read as JSON."""

import asyncio
import json
import math

import moteus  # type: ignore[import-not-found]


async def main() -> None:
    transport = moteus.PythonCan(interface="socketcan", channel="vcan1", fd=True)
    controller = moteus.Controller(id=1, transport=transport)
    await controller.set_stop()
    begun = (await controller.query()).values
    for _ in range(100):
        turning = (
            await controller.set_position(
                position=math.nan, velocity=0.5, watchdog_timeout=0.2, query=True
            )
        ).values
        await asyncio.sleep(0.01)
    await controller.set_stop()
    await asyncio.sleep(0.5)
    stopped = (await controller.query()).values
    of = moteus.Register
    print(
        json.dumps(
            {
                "modes": [int(seen[of.MODE]) for seen in (begun, turning, stopped)],
                "faults": [int(seen[of.FAULT]) for seen in (begun, turning, stopped)],
                "rev_s": turning[of.VELOCITY],
                "turned_rev": turning[of.POSITION] - begun[of.POSITION],
                "volts": turning[of.VOLTAGE],
                "torque_at_rest_nm": stopped[of.TORQUE],
            }
        )
    )


asyncio.run(main())
