"""Numbers of the protocol that print as their words."""

from __future__ import annotations

from enum import IntEnum, IntFlag

_INTEGER_FORMATS = tuple("bcdoxXn")


class Word(IntEnum):
    """A number with a name: `READY` in print(), str() and f-strings, a number elsewhere."""

    def __str__(self) -> str:
        """Returns the name."""
        return self.name

    def __format__(self, spec: str) -> str:
        """Formats the name; with a format for integers, such as "d", the number."""
        return format(int(self) if spec.endswith(_INTEGER_FORMATS) else self.name, spec)


class WordSet(IntFlag):
    """A set of names: `CURRENT|SLEW`, or `none`."""

    def __str__(self) -> str:
        """Returns the names; bits that have none as a number."""
        names = [str(flag.name) for flag in type(self) if flag in self]
        unknown = int(self)
        for flag in type(self):
            unknown &= ~int(flag)
        return "|".join([*names, *([str(unknown)] if unknown else [])]) or "none"

    def __format__(self, spec: str) -> str:
        """Formats the names; with a format for integers, such as "d", the number."""
        return format(int(self) if spec.endswith(_INTEGER_FORMATS) else str(self), spec)
