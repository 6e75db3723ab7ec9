"""Sends signals to other programs: `python -m rc10.stream --vofa udp://HOST:PORT SIGNAL...`."""

from rc10.stream.justfloat import JUSTFLOAT_TAIL, justfloat

__all__ = ["JUSTFLOAT_TAIL", "justfloat"]
