# silt - BSD-3-Clause, see LICENSE
"""Particles, bodies and lines of one frame, in the coordinates of a view."""

from __future__ import annotations

import math
from typing import Optional, Sequence, Union

import numpy as np

from ..errors import Error
from ..frame import Frame
from ..names import label, split_unit
from ..series import read
from ..sources import LINES, POINTS, SURFACE
from .view import Cut


def values_of(frame: Frame, colour: Optional[str], more: Optional[Frame] = None) -> tuple[np.ndarray, str]:
    """A field's numbers, of a vector its length, and what stands at the colour bar. `more`: a frame of
    the same particles, by id, for fields that `frame` does not have."""
    if colour is None:
        return np.zeros(len(frame)), ""
    if colour == "rank" and "rank" not in frame and frame.ranks > 1:  # who wrote what, which no file has
        return frame.rank, "rank"
    if more is not None and colour not in ("x", "y", "z") and _base(colour) not in frame \
            and _base(colour) in more and "id" in frame:
        at = more.find(frame.ids)
        values, words = values_of(more, colour)
        if len(at) and at.min() < 0:
            raise Error(f"files '{frame.path}' and '{more.path}' are of different times: particle "
                        f"{frame.ids[at < 0][0]} is in one of them alone")
        return values[at], words
    values = frame[colour]
    base, unit = _base(colour), frame.unit(colour)
    word = "position" if base in ("x", "y", "z") else split_unit(frame.name(base))[0] \
        if base != "position" else base
    if colour in ("x", "y", "z"):
        return values, f"{colour} [m]"
    if colour != base and not colour.startswith("|"):  # a component
        return values, label(f"{word.replace('_', ' ')} {colour[-1]}", unit)
    if values.ndim > 1 and values.shape[-1] in (3, 4, 6, 9) and frame.kind != "grid" or values.ndim > 3:
        values = np.linalg.norm(values, axis=-1)
        return values, label(f"|{word.replace('_', ' ')}|", unit)
    if colour.startswith("|"):
        return values, label(f"|{word.replace('_', ' ')}|", unit)
    return values, label(word, unit)


def _base(colour: str) -> str:
    """The field of 'velocity.z' or '|velocity|'."""
    if len(colour) > 2 and colour[0] == colour[-1] == "|":
        return colour[1:-1]
    return colour[:-2] if colour[-2:] in (".x", ".y", ".z") else colour


class Bed:
    """The spheres of one frame, or its surfaces, in view coordinates [m].

    `places` (n, 3), `radii` (n,) (0 of surfaces), `ids` (n,) of spheres, or None, `values` (n,) of the colour's field and its
    `label`; of surfaces `triangles` (m, 3) that face the viewer, and `normals` (m, 3, 3) of their
    corners. `cuts`: half spaces that are kept, whole bodies by their middles.
    `eye`: of the viewer [m], in perspective. `radius` [m]: of points without one, see radii_of().
    """

    def __init__(self, frame: Union[Frame, str], colour: Optional[str], axes: np.ndarray,
                 cuts: Union[Cut, Sequence[Cut], None] = None, more: Optional[Frame] = None,
                 eye: Optional[np.ndarray] = None, radius: Optional[float] = None) -> None:
        frame = read(frame) if isinstance(frame, str) else frame
        self.cuts = [] if cuts is None else [cuts] if isinstance(cuts, Cut) else list(cuts)
        if frame.kind not in (POINTS, SURFACE):
            raise Error(f"file '{frame.path}' has {'contacts or bonds' if frame.kind == LINES else 'cells'}, no "
                        "particles or bodies")
        self.has_surfaces = frame.kind == SURFACE and len(frame.triangles) > 0
        self.axes, points = axes, frame.points.astype(float)
        self.is_liquid = frame.kind == POINTS and "radius" not in frame
        self.ids: Optional[np.ndarray] = None
        self.values, self.label = values_of(frame, colour, more)
        if self.has_surfaces:
            if len(self.values) != len(points):  # a value a triangle: its corners are points of their own
                points, self.triangles = frame.corners.reshape(-1, 3), np.arange(3 * len(frame)).reshape(-1, 3)
                self.values = np.repeat(self.values, 3)
            else:
                self.triangles = frame.triangles
            self._take_surfaces(points, frame, eye)
            return
        radii = radii_of(frame, radius)
        kept = np.isfinite(points).all(axis=1) & (radii > 0)
        for cut in self.cuts:
            kept &= cut.beyond(points) >= 0
        self.places, self.radii = points[kept] @ axes.T, radii[kept]
        self.ids = frame.ids[kept] if "id" in frame else None
        self.values, self.triangles = self.values[kept], np.empty((0, 3), int)

    def _take_surfaces(self, points: np.ndarray, frame: Frame, eye: Optional[np.ndarray]) -> None:
        if self.cuts and "id" in frame:
            body = np.unique(frame.ids, return_inverse=True)[1].reshape(-1)
            count = np.bincount(body)
            middle = np.stack([np.bincount(body, points[:, k]) / count for k in range(3)], axis=1)
            for cut in self.cuts:
                self.triangles = self.triangles[(cut.beyond(middle) >= 0)[body[self.triangles[:, 0]]]]
        elif self.cuts:
            for cut in self.cuts:
                middle = points[self.triangles].mean(axis=1)
                self.triangles = self.triangles[cut.beyond(middle) >= 0]
        places = points @ self.axes.T
        a, b, c = (places[self.triangles[:, k]] for k in range(3))
        flat = np.cross(b - a, c - a)
        around = np.stack([sum(np.bincount(self.triangles[:, k], flat[:, axis], len(points))
                               for k in range(3)) for axis in range(3)], axis=1)
        facing = flat[:, 2] if eye is None else (flat * (eye - a)).sum(axis=1)
        if "id" in frame:  # closed bodies: what is turned away is behind the rest
            self.triangles, flat = self.triangles[facing > 0], flat[facing > 0]
        else:  # sheets are seen from both sides
            side = np.where(facing < 0, -1, 1)[:, None]
            flat = flat * side
        smooth = around[self.triangles]
        length = [np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-300)
                  for v in (flat, smooth)]
        flat, smooth = flat / length[0], smooth / length[1]
        # A corner where facets meet at an edge has each facet's own normal.
        edge = (smooth * flat[:, None, :]).sum(axis=2) < math.cos(math.radians(25))
        self.normals = np.where(edge[:, :, None], flat[:, None, :], smooth)
        self.places, self.radii = places, np.zeros(len(points))

    def corners(self) -> np.ndarray:
        """View coordinates (n, 3) that the picture must hold."""
        if self.has_surfaces:
            return self.places[np.unique(self.triangles)]
        r = self.radii[:, None] * [1, 1, 0]
        return np.concatenate([self.places - r, self.places + r])


def radii_of(frame: Frame, radius: Optional[float] = None) -> np.ndarray:
    """(n,) [m]: the field radius; of points without one (a liquid of Sph) `radius`, or half of the median
    distance of a point to the nearest other."""
    if radius is None and ("radius" in frame or len(frame) == 0):
        return frame["radius"].astype(float) if "radius" in frame else np.empty(0)
    if radius is None:
        points = frame.points[np.isfinite(frame.points).all(axis=1)].astype(float)
        nearest = []
        for k in range(0, len(points), max(1, len(points) // 100)):
            away = ((points - points[k]) ** 2).sum(axis=1)
            nearest.append(away[away > 0].min(initial=np.inf))
        radius = 0.5 * float(np.sqrt(np.median(nearest))) if len(nearest) else 0.0
        if not math.isfinite(radius):
            raise Error(f"file '{frame.path}' has no field 'radius'; say how large its points are by --radius")
    return np.full(len(frame), radius)


def in_cuts(points: np.ndarray, cuts: Sequence[Cut]) -> np.ndarray:
    """Which of the points (n, 3) all cuts keep."""
    kept = np.ones(len(points), bool)
    for cut in cuts:
        kept &= cut.beyond(points) >= 0
    return kept


def pressing(frame: Frame, cuts: Sequence[Cut] = ()) -> tuple[np.ndarray, np.ndarray]:
    """The lines (n, 2, 3) [m] of contacts that press, with their middles in the cuts, weakest first,
    and their normal forces [N]."""
    force = frame["normal_force"].astype(float)
    keep = (force > 0) & in_cuts(frame.position, cuts)
    order = np.argsort(force[keep], kind="stable")
    return frame.lines[keep][order], force[keep][order]


def tubes(lines: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Balls (n, 3) along lines (m, 2, 3), close enough to look like rods, and which line each is of."""
    from .canvas import expand

    length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    counts = np.ceil(length / (0.25 * radius)).astype(int) + 1
    which, place = expand(counts)
    part = (place / np.maximum(counts[which] - 1, 1))[:, None]
    return lines[which, 0] + part * (lines[which, 1] - lines[which, 0]), which
