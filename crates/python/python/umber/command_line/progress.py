"""Waits for a render and shows how far it is."""

from __future__ import annotations

import sys

from tqdm import tqdm

from umber import Session

INTERVAL_SECONDS = 0.1


def wait(session: Session) -> None:
    """Waits until the picture is finished; a bar on standard error where that is a terminal."""
    with tqdm(
        total=100.0,
        disable=not sys.stderr.isatty(),
        bar_format="{desc} {percentage:3.0f} %|{bar}| [{elapsed}, {remaining} left]",
        leave=False,
    ) as bar:
        while not session.wait(INTERVAL_SECONDS):
            stats = session.stats()
            samples, target = stats["numCompletedSamples"], stats["targetSamples"]
            bar.set_description_str(f"{samples}/{target} samples", refresh=False)
            bar.n = min(float(stats["percentDone"]), 100.0)
            bar.refresh()
