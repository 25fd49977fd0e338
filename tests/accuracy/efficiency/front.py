"""The Pareto front of pictures: those that no other is both faster and more exact than."""

from __future__ import annotations


def on_front(points: list[tuple[float, float]]) -> list[bool]:
    """For each of (seconds, error): whether no other is at least as good in both, and better in one."""

    def beaten(by: tuple[float, float], point: tuple[float, float]) -> bool:
        return by[0] <= point[0] and by[1] <= point[1] and by != point

    return [not any(beaten(other, point) for other in points) for point in points]
