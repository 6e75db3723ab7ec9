"""`python -m rc10.export LOG`."""

from __future__ import annotations

import argparse
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from rc10.arguments import Parser
from rc10.command_line import run
from rc10.errors import Rc10Error
from rc10.export.log import LogReader
from rc10.export.table import Tables
from rc10.printable import printable

if TYPE_CHECKING:
    from rc10.export.log import Logged

_EPILOG = """\
Record with lcm-logger (Debian: liblcm-bin), which writes what it hears until Ctrl-C:

  lcm-logger --channel='hero\\.v1\\..*' match.lcmlog
  python -m rc10.export match.lcmlog

MCAP opens in Foxglove and PlotJuggler; the table has a row for each state.
"""


class _Sink(Protocol):
    def add(self, logged: Logged) -> None: ...


def main() -> None:
    """Runs the tool."""
    parser = Parser(
        prog="python -m rc10.export",
        description="Turns a log of lcm-logger into MCAP and CSV.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("log", type=Path, help="written by lcm-logger")
    parser.add_argument("--mcap", type=Path, metavar="FILE", help="default: LOG.mcap")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="default: LOG.csv")
    parser.add_argument("--only", choices=("mcap", "csv"), help="write one of them only")
    options = parser.parse_args()

    def export() -> None:
        reader = LogReader(options.log)
        messages = 0
        with ExitStack() as files:
            sinks: list[_Sink] = []
            tables = mcap = None
            if options.only != "mcap":
                tables = files.enter_context(Tables(options.csv or _beside(options.log, ".csv")))
                sinks.append(tables)
            if options.only != "csv":
                from rc10.export.mcap_file import McapFile

                path = options.mcap or _beside(options.log, ".mcap")
                mcap = files.enter_context(McapFile(path))
                sinks.append(mcap)
            for logged in reader:
                messages += 1
                for sink in sinks:
                    sink.add(logged)
        for channel, count in reader.foreign.items():
            print(
                f"export: {printable(channel)}: {count} messages of other types than this rc10's, "
                "left out",
                file=sys.stderr,
            )
        if not messages:
            raise Rc10Error(f"{options.log} has no message of rc10")
        if mcap is not None:
            print(f"wrote {printable(path)}: {mcap.messages} messages")
        if tables is not None:
            for robot, (file, rows) in tables.written().items():
                print(f"wrote {printable(file)}: {rows} states of robot '{printable(robot)}'")

    run("export", export)


def _beside(log: Path, extension: str) -> Path:
    return log.with_name(log.name + extension)


main()
