# silt - BSD-3-Clause, see LICENSE
"""Directions of view, cuts by planes, edges of walls."""

from __future__ import annotations

import math
import re
from typing import Optional

import numpy as np

from ..errors import Error


NAMED = {"iso": (-35, 25), "front": (0, 0), "back": (180, 0), "side": (90, 0), "left": (-90, 0),
         "top": (0, 90), "bottom": (0, -90)}  # fmt: skip


def view_axes(view: str) -> np.ndarray:
    """Rows: right, up, towards the viewer. `view`: front (x to the right, z up), back, side (y to the
    right), left, top, bottom, iso, or two angles [degrees]: how far the viewer has walked around the
    z axis from the front, anticlockwise from above, and how far up; "-35,25" is iso."""
    try:
        turn, tilt = NAMED[view] if view in NAMED else (float(word) for word in view.split(","))
    except ValueError:
        raise Error(f"--view '{view}' must be one of {', '.join(NAMED)}, or two angles in degrees, such as "
                    "-35,25") from None
    # Exact where it can be: what is seen edge-on must be so.
    c, s, C, S = (round(f(math.radians(angle)), 15) for angle in (turn, tilt) for f in (math.cos, math.sin))
    right, flat = np.array([c, s, 0.0]), np.array([s, -c, 0.0])
    viewer = C * flat + S * np.array([0.0, 0, 1])
    return np.array([right, np.cross(viewer, right), viewer]) + 0.0


class Cut:
    """A plane across an axis. "y=0.05" keeps the half space that is farther from the viewer, the greater
    one if seen edge-on; "y>0.05" and "y<0.05" keep what they say. Places in metres."""

    def __init__(self, words: str, axes: np.ndarray) -> None:
        found = re.fullmatch(r"\s*([xyz])\s*([=<>])\s*(.+)", words)
        try:
            self.value = float(found[3]) if found else math.nan
        except ValueError:
            self.value = math.nan
        if found is None or not math.isfinite(self.value):
            raise Error(f"--cut '{words}' must be an axis and a place in metres, such as y=0.05")
        self.axis = "xyz".index(found[1])
        farther = -1 if axes[2][self.axis] > 1e-9 else 1
        self.sign = {"=": farther, ">": 1, "<": -1}[found[2]]

    def beyond(self, points: np.ndarray) -> np.ndarray:
        """[m] how far inside points (..., 3) lie; negative of those that are left out."""
        return self.sign * (points[..., self.axis] - self.value)

    def clip(self, segments: np.ndarray) -> np.ndarray:
        """The parts of the segments (n, 2, 3) in the half that is kept, and those in the plane: side lines of
        a round wall that is cut along its axis lie there but for rounding."""
        d = self.beyond(segments)
        d[np.abs(d) < 1e-9 * np.abs(segments).max(initial=0)] = 0
        kept = (d >= 0).any(axis=1)
        segments, d = segments[kept].copy(), d[kept]
        for end in (0, 1):
            out = d[:, end] < 0
            part = (d[out, 1 - end] / (d[out, 1 - end] - d[out, end]))[:, None]
            inner = segments[out, 1 - end]
            segments[out, end] = inner + part * (segments[out, end] - inner)
        return segments

    def clip_triangles(self, corners: np.ndarray) -> np.ndarray:
        """The parts of triangles (n, 3, 3) in the half that is kept, as triangles."""
        d = self.beyond(corners)
        inside = (d >= 0).sum(axis=1)
        parts = [corners[inside == 3]]
        for count in (1, 2):  # the corner that is alone on its side first
            some, e = corners[inside == count], d[inside == count]
            lone = np.argmax((e >= 0) if count == 1 else (e < 0), axis=1)
            turned = (lone[:, None] + np.arange(3)) % 3
            some = np.take_along_axis(some, turned[:, :, None], axis=1)
            e = np.take_along_axis(e, turned, axis=1)
            p, q = (some[:, 0] + (e[:, 0] / (e[:, 0] - e[:, k]))[:, None] * (some[:, k] - some[:, 0])
                    for k in (1, 2))
            if count == 1:
                parts.append(np.stack([some[:, 0], p, q], axis=1))
            else:
                parts.append(np.stack([p, some[:, 1], some[:, 2]], axis=1))
                parts.append(np.stack([p, some[:, 2], q], axis=1))
        return np.concatenate(parts)


def wall_edges(points: np.ndarray, triangles: np.ndarray, viewer: np.ndarray,
               eye: Optional[np.ndarray] = None) -> np.ndarray:
    """Segments (n, 2, 3): borders, edges where facets differ by over 20 degrees, and outlines, as seen
    from the direction `viewer`, or in perspective from the place `eye` [m]."""
    if len(triangles) == 0:
        return np.empty((0, 2, 3))
    # Facets from STL files share places but not points: weld them.
    grain = 1e-7 * max(np.ptp(points, axis=0).max(), 1e-30)
    _, first, welded = np.unique(np.round(points / grain).astype(np.int64), axis=0,
                                 return_index=True, return_inverse=True)
    corners, triangles = points[first], welded.reshape(-1)[triangles]
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1)
    normals, triangles = normals[length > 0] / length[length > 0, None], triangles[length > 0]

    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]],
                                    triangles[:, [2, 0]]]), axis=1)
    facet = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, facet = edges[order], facet[order]
    starts = np.flatnonzero(np.r_[True, (edges[1:] != edges[:-1]).any(axis=1)])
    counts = np.diff(np.r_[starts, len(edges)])
    shown = counts != 2
    pair = starts[~shown]
    n0, n1 = normals[facet[pair]], normals[facet[pair + 1]]
    # Facets may be listed with either orientation: compare the planes, not the sides.
    bent = np.abs((n0 * n1).sum(axis=1)) < math.cos(math.radians(20))
    if eye is None:
        facing0, facing1 = n0 @ viewer, n1 @ viewer
    else:
        to_eye = eye - corners[edges[pair, 0]]
        to_eye /= np.maximum(np.linalg.norm(to_eye, axis=1, keepdims=True), 1e-300)
        facing0, facing1 = (n0 * to_eye).sum(axis=1), (n1 * to_eye).sum(axis=1)
    outline = (facing0 * facing1 < 0) & (np.minimum(abs(facing0), abs(facing1)) > 1e-6) & \
        ((n0 * n1).sum(axis=1) > 0)
    shown[~shown] = bent | outline
    return corners[edges[starts[shown]]]
