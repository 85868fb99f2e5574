# silt - BSD-3-Clause, see LICENSE
"""Infinite planes in pictures. A file of walls has the part of each that its own frame shows."""

from __future__ import annotations

import numpy as np
from matplotlib.tri import Triangulation

from ..frame import Frame


class Planes:
    """Draws the planes of walls over all that any frame of a picture or movie shows of them: a floor
    does not grow and shrink with the grains on it. Planes that turn are drawn as their frame has them."""

    def __init__(self) -> None:
        self.seen: set[str] = set()
        self.parts: dict[tuple[int, int], list[np.ndarray]] = {}

    def take(self, frame: Frame) -> None:
        """A frame that is going to be drawn."""
        if frame.path in self.seen:
            return
        self.seen.add(frame.path)
        for key, corners in self._of(frame).items():
            self.parts.setdefault(key, []).append(corners)

    def surface(self, frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """Points [m] and triangles of a frame's walls."""
        points, triangles = frame.points.astype(float), frame.triangles
        planes = self._of(frame)
        if not planes or len(self.seen) < 2:
            return points, triangles
        bounded = triangles[frame["unbounded"][triangles[:, 0]] == 0]
        for key, corners in planes.items():
            whole, parts = self._whole(corners, self.parts.get(key, []))
            bounded = np.concatenate([bounded, parts + len(points)])
            points = np.concatenate([points, whole])
        return points, bounded

    @staticmethod
    def _of(frame: Frame) -> dict[tuple[int, int], np.ndarray]:
        """Corners of each plane, by its wall and its number among the planes of the wall."""
        if "unbounded" not in frame or len(frame.triangles) == 0:
            return {}
        triangles = frame.triangles[frame["unbounded"][frame.triangles[:, 0]] != 0]
        found: dict[tuple[int, int], np.ndarray] = {}
        for first in np.unique(triangles[:, 0]):  # each is a fan about its first corner
            wall, number = int(frame["wall"][first]), 0
            while (wall, number) in found:
                number += 1
            fan = np.unique(triangles[triangles[:, 0] == first])
            found[wall, number] = frame.points[fan].astype(float)
        return found

    @staticmethod
    def _whole(corners: np.ndarray, parts: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """A plane over all parts that are parallel to it: points and triangles."""
        middle = corners.mean(axis=0)
        along, across, normal = np.linalg.svd(corners - middle)[2]
        size = np.ptp(corners, axis=0).max()
        near = [corners]
        for part in parts:
            flat = part - part.mean(axis=0)
            if np.abs(flat @ normal).max() <= 1e-5 * np.ptp(flat, axis=0).max():
                near.append(part)
        places = (np.concatenate(near) - middle) @ np.stack([along, across]).T
        _, first = np.unique(np.round(places / (1e-6 * size)).astype(np.int64), axis=0, return_index=True)
        places = places[first]
        return middle + places @ np.stack([along, across]), Triangulation(*places.T).triangles
