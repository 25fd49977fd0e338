"""Prints how many collections of lights the import of a stage looks through, object by object.

    blender_default_links.py STAGE

Runs where blender_render.py does.
"""

from __future__ import annotations

import sys

import blender_render as driver


def main(stage: str) -> int:
    """Counts; the exit code."""
    driver.add_on()
    from pxr import Usd  # noqa: PLC0415 (only there once the add-on is)

    look_through, count = Usd.CollectionAPI.ComputeMembershipQuery, 0

    def counted(*arguments: object) -> object:
        nonlocal count
        count += 1
        return look_through(*arguments)

    Usd.CollectionAPI.ComputeMembershipQuery = counted
    driver.import_stage(stage)
    print(f"collections: {count}")
    return driver.DONE


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
