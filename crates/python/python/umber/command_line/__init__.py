"""The command `umber`: its one subcommand so far is `record`."""

from __future__ import annotations

import sys

USAGE = """usage: umber record [-h] … usdFilePath outputImagePath

commands:
  record    generates images from a USD file, as usdrecord does
"""


def main(arguments: list[str] | None = None) -> int:
    """Runs a command line; gives the exit code: 0 done, 1 could not render, 2 bad arguments."""
    given = sys.argv[1:] if arguments is None else arguments
    if given and given[0] == "record":
        from umber.command_line.record import record  # noqa: PLC0415 - usd-core takes a second to load

        return record(given[1:])
    asked = bool(given) and given[0] in ("-h", "--help")
    print(USAGE, file=sys.stdout if asked else sys.stderr)
    return 0 if asked else 2
