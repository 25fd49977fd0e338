"""`--traceToFile` and `--memstats`: USD's own diagnostics."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pxr import Tf, Trace


@contextmanager
def traced(arguments: argparse.Namespace) -> Iterator[None]:
    """Collects what the arguments ask for while the body runs, and writes it afterwards."""
    if arguments.memstats and not Tf.MallocTag.Initialize():
        print("Unable to accumulate memory usage: the MallocTag system is not supported here", file=sys.stderr)
    collector = Trace.Collector() if arguments.traceToFile else None
    if collector:
        collector.enabled = True
    try:
        yield
    finally:
        if collector:
            collector.enabled = False
            report = Trace.Reporter.globalReporter
            chrome = arguments.traceFormat == "chrome"
            (report.ReportChromeTracingToFile if chrome else report.Report)(arguments.traceToFile)
        if arguments.memstats and Tf.MallocTag.IsInitialized():
            name = f"{Path(arguments.usdFilePath).name}.mallocTag"
            Tf.MallocTag.GetCallTree().Report(name)
            print(f"Memory consumption: {Tf.MallocTag.GetTotalBytes() >> 20} MiB; for details see {name}")
