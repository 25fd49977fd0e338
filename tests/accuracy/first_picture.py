"""How soon a picture stands after an edit, and how busy the threads are.

    python tests/accuracy/first_picture.py [--edits 9]

Chess at 1280 x 720: the seed of the samples is changed, which compiles nothing anew; the time is that until the whole
film shows a coarse picture, then until every pixel has a sample. Then one final frame of 64 samples on two threads:
processor time over the time that two threads have.
"""

from __future__ import annotations

import argparse
import statistics
import time

from adaptive_gain import load, render
from umber import Session

WIDTH, HEIGHT = 1280, 720


def until(session: Session, samples: float) -> None:
    """Waits until a pass has ended that brought the pixels to so many samples on average."""
    while session.stats()["meanSamples"] < samples:
        time.sleep(0.0005)


def main() -> None:
    """Prints the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=9)
    arguments = parser.parse_args()
    session = load("chess")
    session.set_film(WIDTH, HEIGHT, ["color", "depth", "primId"])
    session.set("enableInteractive", "true")
    first, whole = [], []
    for seed in range(arguments.edits + 1):
        session.set("umber:seed", str(seed))
        started = time.perf_counter()
        session.start()
        while session.stats()["meanSamples"] > 0.0:  # the old picture's
            time.sleep(0.0002)
        until(session, 1e-9)
        first.append(time.perf_counter() - started)
        until(session, 1.0)
        whole.append(time.perf_counter() - started)
        session.stop()
    # the first one compiled the scene
    print(f"coarse picture after {1000 * statistics.median(first[1:]):.1f} ms (slowest {1000 * max(first[1:]):.1f} ms)")
    print(f"a sample in every pixel after {1000 * statistics.median(whole[1:]):.0f} ms")
    session.set("enableInteractive", "false")
    session.set("umber:threads", "2")
    session.set_film(WIDTH // 4, HEIGHT // 4, ["color"])
    render(session, 0, 1, -1.0)
    before = time.process_time()
    _, stats = render(session, 1, 64, -1.0)
    busy = (time.process_time() - before) / (2.0 * float(stats["renderSeconds"]))
    print(f"two threads are busy {100 * busy:.1f} % of the time")


if __name__ == "__main__":
    main()
