"""Command lines whose misspelt words are told with the word that was meant."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from rc10.spelling import did_you_mean

if TYPE_CHECKING:
    from typing import NoReturn


class Parser(argparse.ArgumentParser):
    """The parser of a tool: it parses sys.argv."""

    def error(self, message: str) -> NoReturn:
        """Ends the program with status 2; an option that does not exist is told before all else."""
        known = self._option_string_actions
        for word in sys.argv[1:]:
            name = word.partition("=")[0]
            # argparse takes the beginning of an option for the option.
            if name.startswith("--") and not any(option.startswith(name) for option in known):
                message = f"there is no option '{name}'{did_you_mean(name, known)}"
                break
        super().error(message)

    def _check_value(self, action: argparse.Action, value: object) -> None:
        choices = [str(choice) for choice in action.choices or ()]
        if choices and str(value) not in choices:
            raise argparse.ArgumentError(
                action,
                f"'{value}' is not one of {', '.join(choices)}{did_you_mean(str(value), choices)}",
            )
