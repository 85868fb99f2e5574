# silt - BSD-3-Clause, see LICENSE
"""One time step of a series: particles, surfaces, lines, or cells, with their fields."""

from __future__ import annotations

import math
from typing import Iterator, Optional

import numpy as np

from .errors import Error
from .names import AXES, find_name, same, split_unit, unit_of
from .sources import GRID, LINES, MESH, POINTS, SURFACE, Grid, Source

__all__ = ["Frame", "Grid", "POINTS", "SURFACE", "LINES", "GRID", "MESH"]
ATTRIBUTES = ("points", "triangles", "corners", "lines", "ids", "rank", "ranks", "grid", "time", "step",
              "kind", "fields", "units", "path")  # fmt: skip
OF_KIND = {POINTS: "particles", SURFACE: "points of a surface", LINES: "lines", GRID: "cells",
           MESH: "cells of a mesh"}  # fmt: skip


class Frame:
    """What one file of a series has; arrays are read when they are first asked for, and kept.

    `kind` is "points" (particles), "surface" (walls, bodies: triangles with a field value a point),
    "lines" (contacts, bonds: a value a line), "grid" (a flow: equal cells) or "mesh" (.vtu).
    `time` [s] (nan where no series tells it), `step` (None where the file's name has none).

        frame["velocity"]        (n, 3), with or without the unit: "velocity [m/s]" is the same
        frame["velocity.z"]      (n,), one component; frame["|velocity|"] its length
        frame["position"]        (n, 3) [m]: centres of particles, points of surfaces, middles of
                                 lines; of a grid (nx, ny, nz, 3), middles of cells
        frame.unit("velocity")   "m/s"

    Fields of a grid have the shape (nx, ny, nz), of vectors (nx, ny, nz, 3).
    Errors: silt.Error, which names the fields that there are.
    """

    def __init__(self, source: Source, time: float = math.nan, step: Optional[int] = None) -> None:
        self._source, self.time, self.step = source, time, step
        self._kept: dict[str, np.ndarray] = {}
        self._places: Optional[tuple[np.ndarray, np.ndarray]] = None

    @property
    def path(self) -> str:
        return self._source.path

    @property
    def kind(self) -> str:
        return self._source.kind

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of fields as the file has them, units included."""
        return tuple(self._source.names)

    @property
    def units(self) -> dict[str, str]:
        """Units by name; "" where neither the file nor silt's own names tell."""
        return {name: unit_of(name) for name in self.fields}

    @property
    def ranks(self) -> int:
        """How many processes wrote it."""
        return self._source.ranks

    @property
    def grid(self) -> Grid:
        """Of a grid: number of cells, origin and spacing [m]."""
        if self._source.grid is None:
            raise Error(f"file '{self.path}' has {OF_KIND[self.kind]}, no grid of cells")
        return self._source.grid

    def __len__(self) -> int:
        """Values of a field: particles, points, lines or cells."""
        return self._source.count()

    def __repr__(self) -> str:
        return f"<silt.Frame of {len(self)} {OF_KIND[self.kind]}, t = {self.time:g} s, '{self.path}'>"

    def __iter__(self) -> Iterator[str]:
        return iter(self.fields)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (name == "position" or any(same(name, f) for f in self.fields))

    def name(self, wanted: str) -> str:
        """The full name of a field. Errors: names those there are."""
        try:
            return find_name(wanted, self.fields, "field", self.path)
        except Error as error:
            if wanted in ATTRIBUTES:
                raise Error(f"{error}; '{wanted}' is no field: write frame.{wanted}") from None
            raise

    def unit(self, wanted: str) -> str:
        """The unit of a field, of a component or of a length; "" if unknown."""
        base = self._parts(wanted)[0]
        return "m" if base == "position" else unit_of(self.name(base))

    def __getitem__(self, wanted: str) -> np.ndarray:
        base, component = self._parts(wanted)
        values = self._whole(base)
        if component is None:
            return values
        if values.ndim < 2 or values.shape[-1] != 3 or self.kind == GRID and values.ndim < 4:
            raise Error(f"file '{self.path}': field '{base}' is no vector; ask for '{base}' alone")
        return np.linalg.norm(values, axis=-1) if component == 3 else values[..., component]

    def _parts(self, wanted: str) -> tuple[str, Optional[int]]:
        """'velocity.z' -> ('velocity', 2), '|velocity|' -> ('velocity', 3), else (wanted, None)."""
        if wanted == "position" or any(same(wanted, name) for name in self.fields):
            return wanted, None
        if wanted in AXES:
            return "position", AXES.index(wanted)
        if len(wanted) > 2 and wanted[0] == wanted[-1] == "|":
            return wanted[1:-1], 3
        if wanted[-2:-1] == "." and wanted[-1] in AXES:
            return wanted[:-2], AXES.index(wanted[-1])
        return wanted, None

    def _whole(self, wanted: str) -> np.ndarray:
        if wanted == "position" and not any(split_unit(f)[0] == "position" for f in self.fields):
            return self.position
        name = self.name(wanted)
        return self._keep(name, lambda: self._shaped(self._source.field(name)))

    def _keep(self, key: str, read) -> np.ndarray:
        if key not in self._kept:
            values = read()
            values.flags.writeable = False  # what is kept must stay what the file has
            self._kept[key] = values
        return self._kept[key]

    def _shaped(self, values: np.ndarray) -> np.ndarray:
        if self.kind != GRID:
            return values
        nx, ny, nz = self.grid.cells
        return np.moveaxis(values.reshape((nz, ny, nx) + values.shape[1:]), (0, 1, 2), (2, 1, 0))

    # ---------------------------------------------------------------------------- geometry

    @property
    def points(self) -> np.ndarray:
        """(n, 3) [m]: particles, or what triangles and lines number."""
        return self._keep("/points", lambda: self._source.geometry("points"))

    @property
    def position(self) -> np.ndarray:
        """[m] where each value of a field stands: see the class."""
        if self.kind == GRID:
            axes = np.meshgrid(*(self.grid.centres(a) for a in range(3)), indexing="ij")
            return self._keep("/position", lambda: np.stack(axes, axis=-1))
        if self.kind == LINES:
            return self._keep("/position", lambda: self.lines.mean(axis=1))
        if self.kind == MESH:
            ends = self._source.geometry("offsets").reshape(-1).astype(np.int64)
            cells = self._source.geometry("cells").reshape(-1)
            starts = np.r_[0, ends[:-1]].astype(np.int64)
            return self._keep("/position", lambda: np.add.reduceat(self.points[cells], starts, axis=0)
                              / (ends - starts)[:, None] if len(ends) else np.empty((0, 3)))
        if self.kind == SURFACE and self._source.count() != len(self.points):
            return self._keep("/position", lambda: self.corners.mean(axis=1))
        return self.points

    @property
    def triangles(self) -> np.ndarray:
        """(m, 3) of a surface: numbers of points, anticlockwise as seen from outside of a body."""
        return self._keep("/triangles", lambda: self._source.geometry("triangles"))

    @property
    def corners(self) -> np.ndarray:
        """(m, 3, 3) [m]: the corners of each triangle."""
        return self.points[self.triangles]

    @property
    def lines(self) -> np.ndarray:
        """(m, 2, 3) [m]: the ends of each line, of a contact from its partner b to a."""
        return self.points[self._source.geometry("lines")].astype(float)

    # --------------------------------------------------------------------------- particles

    @property
    def ids(self) -> np.ndarray:
        """(n,) numbers that particles keep; of bodies' parts and surfaces those of their body."""
        if "id" not in self:
            raise Error(f"file '{self.path}' has no ids: it has {OF_KIND[self.kind]} with the fields "
                        f"{', '.join(self.fields) or 'none'}")
        return self["id"]

    @property
    def rank(self) -> np.ndarray:
        """(n,) which process wrote each value, from 0."""
        return self._keep("/rank", self._source.rank)

    def find(self, ids) -> np.ndarray:
        """Where particles with these ids stand, -1 for those that are not there; the same shape."""
        if self._places is None:
            order = np.argsort(self.ids, kind="stable")
            self._places = order, self.ids[order]
        order, known = self._places
        wanted = np.asarray(ids)
        if len(known) == 0:
            return np.full(wanted.shape, -1)
        at = np.minimum(np.searchsorted(known, wanted.astype(known.dtype)), len(known) - 1)
        return np.where(known[at] == wanted, order[at], -1)

    def wall(self, number: int) -> np.ndarray:
        """(m, 3) triangles of one wall of a file of walls."""
        return self.triangles[self["wall"][self.triangles[:, 0]] == number]
