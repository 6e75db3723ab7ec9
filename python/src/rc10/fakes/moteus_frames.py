"""Frames of a moteus: subframes to bytes and back, with the scale of each register."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

NAN = math.nan
NOP = 0x50
WRITE_ERROR, READ_ERROR = 0x30, 0x31
UNKNOWN_REGISTER, READ_ONLY = 1, 2
_FD_LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)

# Wire types by bits 2 and 3 of a subframe's first byte; the lowest integer means NaN.
_INTS = (struct.Struct("<b"), struct.Struct("<h"), struct.Struct("<i"))
_FLOAT = struct.Struct("<f")
_MOST = (127, 32767, 2147483647)

# One count of an 8, 16 and 32 bit integer.
_PLAIN = (1.0, 1.0, 1.0)
_AMPERE = (1.0, 0.1, 0.001)
_TORQUE = (0.5, 0.01, 0.001)
_VOLT = (0.5, 0.1, 0.001)
_CELSIUS = (1.0, 0.1, 0.001)
_SECOND = (0.01, 0.001, 1e-6)
_REV = (0.01, 1e-4, 1e-5)
_REV_S = (0.1, 2.5e-4, 1e-5)
_REV_S2 = (0.05, 1e-3, 1e-5)
_SHARE = (1 / 127, 1 / 32767, 1 / 2147483647)
_SCALES: dict[int, tuple[float, float, float]] = {
    0x001: _REV,
    0x002: _REV_S,
    0x003: _TORQUE,
    0x004: _AMPERE,
    0x005: _AMPERE,
    0x006: _REV,
    0x00A: _CELSIUS,
    0x007: (10.0, 0.05, 1e-4),
    **dict.fromkeys((0x10, 0x11, 0x12, 0x18), _SHARE),
    **dict.fromkeys((0x14, 0x15, 0x16, 0x19, 0x1A, 0x1B), _VOLT),
    0x01C: _AMPERE,
    0x01D: _AMPERE,
    0x01E: _REV_S,
    0x00D: _VOLT,
    0x00E: _CELSIUS,
    0x020: _REV,
    0x021: _REV_S,
    0x022: _TORQUE,
    0x023: _SHARE,
    0x024: _SHARE,
    0x025: _TORQUE,
    0x026: _REV,
    0x027: _SECOND,
    0x028: _REV_S,
    0x029: _REV_S2,
    0x02A: _VOLT,
    0x02B: _SHARE,
    0x02C: _AMPERE,
    0x040: _REV,
    0x041: _REV,
    0x042: _TORQUE,
    0x043: _SHARE,
    0x044: _SHARE,
    0x045: _TORQUE,
    0x046: _SECOND,
    0x047: _SHARE,
}


class ProtocolError(ValueError):
    """A payload that is no row of subframes."""


@dataclass(frozen=True)
class Subframe:
    """Some registers in a row: kind is "write", "read", "reply" or "error". No values in a read."""

    kind: str
    wire_type: int
    start: int
    count: int
    values: tuple[float, ...] = ()


def _varuint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while at < len(data) and shift < 35:
        value |= (data[at] & 0x7F) << shift
        at += 1
        if data[at - 1] < 0x80:
            return value, at
        shift += 7
    raise ProtocolError("a number that does not end")


def _put_varuint(value: int) -> bytes:
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def _single(value: float) -> float:
    (number,) = _FLOAT.unpack(_FLOAT.pack(value))
    return float(number)


def _encode(value: float, wire_type: int, register: int) -> bytes:
    """Encodes as the firmware does: in single precision, truncated. 0.063 s are 62 ms."""
    if wire_type == 3:
        return _FLOAT.pack(value)
    most = _MOST[wire_type]
    if not math.isfinite(value):
        return _INTS[wire_type].pack(-most - 1)
    scale = _SCALES.get(register, _PLAIN)[wire_type]
    counts = int(_single(_single(value) / _single(scale)))
    return _INTS[wire_type].pack(max(-most, min(most, counts)))


def _decode(data: bytes, wire_type: int, register: int, by_drive: bool) -> float:
    if wire_type == 3:
        (number,) = _FLOAT.unpack(data)
        return float(number)
    (counts,) = _INTS[wire_type].unpack(data)
    if counts == -_MOST[wire_type] - 1:
        return NAN
    scale = _SCALES.get(register, _PLAIN)[wire_type]
    return _single(_single(counts) * _single(scale)) if by_drive else float(counts) * scale


def parse(data: bytes) -> list[Subframe]:
    """Takes a payload apart.

    Raises:
        ProtocolError: it is cut off, or has something that is not known.
    """
    result = []
    at = 0
    while at < len(data):
        head = data[at]
        at += 1
        if head == NOP:
            continue
        if head in (WRITE_ERROR, READ_ERROR):
            start, at = _varuint(data, at)
            code, at = _varuint(data, at)
            result.append(Subframe("error", 0, start, 1, (float(code),)))
            continue
        if head >= 0x30:
            raise ProtocolError(f"subframe 0x{head:02X}")
        kind = ("write", "read", "reply")[head >> 4]
        wire_type = head >> 2 & 3
        count = head & 3
        if count == 0:
            count, at = _varuint(data, at)
        start, at = _varuint(data, at)
        values = []
        if kind != "read":
            size = (1, 2, 4, 4)[wire_type]
            if at + size * count > len(data):
                raise ProtocolError("cut off")
            for i in range(count):
                values.append(_decode(data[at : at + size], wire_type, start + i, kind == "write"))
                at += size
        result.append(Subframe(kind, wire_type, start, count, tuple(values)))
    return result


def reply(wire_type: int, start: int, values: list[float]) -> bytes:
    """Returns a reply subframe."""
    head = 0x20 | wire_type << 2
    count = len(values)
    first = bytes([head | count]) if 1 <= count <= 3 else bytes([head]) + _put_varuint(count)
    body = b"".join(_encode(v, wire_type, start + i) for i, v in enumerate(values))
    return first + _put_varuint(start) + body


def error(subframe: int, register: int, code: int) -> bytes:
    """Returns an error subframe."""
    return bytes([subframe]) + _put_varuint(register) + _put_varuint(code)


def pad(data: bytes) -> bytes:
    """Returns the payload with NOPs, as long as a CAN FD frame can be."""
    length = next(n for n in _FD_LENGTHS if n >= len(data))
    return data + bytes([NOP]) * (length - len(data))
