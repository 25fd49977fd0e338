"""The end of a process that has rendered through OpenUSD's imaging."""

from __future__ import annotations

import os
import sys
from typing import NoReturn


def leave(code: int) -> NoReturn:
    """Ends the process with `code`, without taking Python down first.

    UsdImaging throws its caches away on background threads, and lets nobody wait for them. Where they hold prims that
    Python knows of, they ask for the interpreter's lock; a Python before 3.14 that is being taken down ends such a
    thread by unwinding it, and C++ answers with std::terminate. Let engines and stages go before: what is still there
    is not destroyed, and so not tested. Blender's hosts end as Python does.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
