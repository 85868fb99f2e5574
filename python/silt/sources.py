# silt - BSD-3-Clause, see LICENSE
"""Where a Frame has its arrays from: a VTK file, several as pieces of ranks, or a .npz file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Mapping, Optional

import numpy as np

from .errors import Error
from .vtk import VtkFile, read_extent

POINTS, SURFACE, LINES, GRID, MESH = "points", "surface", "lines", "grid", "mesh"


@dataclass(frozen=True)
class Grid:
    """Equal cells of a box: `cells` along x, y, z, its lower corner `origin` [m], `spacing` [m]."""

    cells: tuple[int, int, int]
    origin: tuple[float, float, float]
    spacing: tuple[float, float, float]

    def centres(self, axis: int) -> np.ndarray:
        """Coordinates [m] of the middles of cells along axis 0, 1 or 2."""
        return self.origin[axis] + (np.arange(self.cells[axis]) + 0.5) * self.spacing[axis]

    def edges(self, axis: int) -> np.ndarray:
        """Coordinates [m] of the planes between cells along an axis, both ends included."""
        return self.origin[axis] + np.arange(self.cells[axis] + 1) * self.spacing[axis]


class Source:
    """What a Frame asks. `kind`: one of the words above; `names`: fields, in the file's order;
    `ranks`: how many processes wrote it."""

    path: str
    kind: str
    names: list[str]
    ranks: int = 1
    grid: Optional[Grid] = None

    def field(self, name: str) -> np.ndarray:
        raise NotImplementedError

    def geometry(self, name: str) -> np.ndarray:
        """points (n, 3) [m]; triangles (m, 3) or lines (m, 2): numbers of points; cells: list of
        points of all cells of a mesh, offsets: where each cell's ends, types: VTK's numbers."""
        raise NotImplementedError

    def rank(self) -> np.ndarray:
        """Which rank wrote each value."""
        return np.zeros(self.count(), np.int32)

    def count(self) -> int:
        """Values of a field."""
        raise NotImplementedError


class VtkSource(Source):
    def __init__(self, file: VtkFile) -> None:
        self.file, self.path = file, file.path
        sections = file.sections
        self.fields_of = "PointData"
        if file.kind == "ImageData":
            self.kind, self.fields_of = GRID, "CellData"
            try:
                origin = tuple(float(w) for w in file.about.get("Origin", "0 0 0").split())
                spacing = tuple(float(w) for w in file.about.get("Spacing", "1 1 1").split())
            except ValueError:
                origin = spacing = ()
            if len(origin) != 3 or len(spacing) != 3:
                raise Error(f"file '{self.path}' is an image without a readable origin or spacing")
            self.grid = Grid(read_extent(file.about.get("WholeExtent"), self.path), origin, spacing)
        elif file.kind == "PolyData":
            if "connectivity" in sections.get("Lines", {}) and file.number("NumberOfLines", 1) > 0 or (
                    not sections.get("PointData") and sections.get("CellData") and "Lines" in sections):
                self.kind, self.fields_of = LINES, "CellData"
            elif "connectivity" in sections.get("Polys", {}):
                self.kind = SURFACE
            else:
                self.kind = POINTS
        elif file.kind == "UnstructuredGrid":
            self.kind, self.fields_of = MESH, "CellData"
        else:
            raise Error(f"file '{self.path}' is of VTK's kind {file.kind}, which is not read; silt writes "
                        "PolyData (.vtp, .pvtp) and ImageData (.vti)")
        if not sections.get(self.fields_of) and sections.get("CellData" if self.fields_of == "PointData"
                                                             else "PointData"):
            self.fields_of = "CellData" if self.fields_of == "PointData" else "PointData"
        if self.kind in (GRID, MESH) and self.fields_of == "PointData":
            raise Error(f"file '{self.path}' has fields at the points of a grid; silt's stand at its cells")
        if self.kind != GRID and "Points" not in sections.get("Points", {}):
            raise Error(f"file '{self.path}' has no points")
        self.names = list(sections.get(self.fields_of, {}))

    def field(self, name: str) -> np.ndarray:
        values = self.file.array(self.fields_of, name)
        if len(values) != self.count():
            raise Error(f"file '{self.path}' has {len(values)} values of '{name}' for {self.count()}")
        return values

    def count(self) -> int:
        if self.grid is not None:
            return int(np.prod(self.grid.cells))
        number = {LINES: "NumberOfLines", MESH: "NumberOfCells"}.get(self.kind, "NumberOfPoints")
        if self.kind == SURFACE and self.fields_of == "CellData":
            number = "NumberOfPolys"
        if number in self.file.piece:
            return self.file.number(number)
        return len(self.geometry({LINES: "lines", MESH: "offsets"}.get(self.kind, "points")))

    def geometry(self, name: str) -> np.ndarray:
        section = {"points": ("Points", "Points"), "triangles": ("Polys", "connectivity"),
                   "lines": ("Lines", "connectivity"), "cells": ("Cells", "connectivity"),
                   "offsets": ("Cells", "offsets"), "types": ("Cells", "types")}[name]  # fmt: skip
        if section[1] not in self.file.sections.get(section[0], {}):
            return np.empty((0, {"triangles": 3, "lines": 2}.get(name, 1)), np.int64)
        values = self.file.array(*section)
        if name not in ("triangles", "lines"):
            return values
        corners = 3 if name == "triangles" else 2
        if "offsets" in self.file.sections[section[0]] and len(values):
            ends = self.file.array(section[0], "offsets")
            if not (np.diff(ends, prepend=0) == corners).all():
                raise Error(f"file '{self.path}' has {'polygons' if corners == 3 else 'lines'} of more than "
                            f"{corners} points, which are not read; save it as "
                            f"{'triangles' if corners == 3 else 'single lines'}")
        if len(values) and (values.min() < 0 or values.max() >= self.file.number("NumberOfPoints", 1 << 62)):
            raise Error(f"file '{self.path}' is damaged: its {name} name points that are not there")
        return values.reshape(-1, corners)


class PiecesSource(Source):
    """The pieces of one frame, joined in the order of ranks."""

    def __init__(self, path: str, pieces: list[Source]) -> None:
        self.path, self.pieces, self.ranks = path, pieces, len(pieces)
        filled = [piece for piece in pieces if piece.count() > 0] or pieces[:1]
        self.kind, self.names = filled[0].kind, filled[0].names
        for piece in filled[1:]:
            if piece.kind != self.kind or piece.names != self.names:
                raise Error(f"file '{path}': its pieces '{filled[0].path}' and '{piece.path}' have different "
                            "fields; they are not of one run")
        self.filled = filled

    def field(self, name: str) -> np.ndarray:
        return np.concatenate([piece.field(name) for piece in self.filled])

    def geometry(self, name: str) -> np.ndarray:
        parts = [piece.geometry(name) for piece in self.filled]
        if name in ("triangles", "lines", "cells"):
            before = np.cumsum([0] + [len(piece.geometry("points")) for piece in self.filled])
            parts = [part.astype(np.int64) + first for part, first in zip(parts, before)]
        elif name == "offsets":
            before = np.cumsum([0] + [len(piece.geometry("cells")) for piece in self.filled])
            parts = [part.astype(np.int64) + first for part, first in zip(parts, before)]
        return np.concatenate(parts)

    def rank(self) -> np.ndarray:
        return np.repeat(np.arange(len(self.pieces), dtype=np.int32), [p.count() for p in self.pieces])

    def count(self) -> int:
        return sum(piece.count() for piece in self.filled)


class ArraySource(Source):
    """Arrays by name, as silt.npz_series keeps them: 'field/velocity', 'geometry/points'."""

    def __init__(self, path: str, kind: str, names: list[str], arrays: Mapping[str, np.ndarray],
                 prefix: str = "", grid: Optional[Grid] = None) -> None:
        self.path, self.kind, self.names, self.grid = path, kind, names, grid
        self.arrays, self.prefix = arrays, prefix

    def _array(self, name: str) -> np.ndarray:
        try:
            return self.arrays[self.prefix + name]
        except KeyError:
            raise Error(f"file '{self.path}' has no array '{self.prefix + name}'; it is not as "
                        "silt.npz_series writes it") from None
        except Exception as error:  # zipfile and zlib have errors of their own
            raise Error(f"file '{self.path}' is damaged: {error}") from None

    def field(self, name: str) -> np.ndarray:
        return self._array("field/" + name)

    def geometry(self, name: str) -> np.ndarray:
        if self.prefix + "geometry/" + name not in self.arrays:
            return np.empty((0, {"triangles": 3, "lines": 2}.get(name, 1)), np.int64)
        return self._array("geometry/" + name)

    def count(self) -> int:
        if self.grid is not None:
            return int(np.prod(self.grid.cells))
        if self.kind == LINES:
            return len(self.geometry("lines"))
        if self.kind == MESH:
            return len(self.geometry("offsets"))
        return len(self.field(self.names[0])) if self.names else len(self.geometry("points"))


def source_of(path: str) -> Source:
    """Of one file: .vtp, .vti, .vtu, or .pvtp and .pvtu with their pieces."""
    file = VtkFile(path)
    if file.kind not in ("PPolyData", "PUnstructuredGrid"):
        return VtkSource(file)
    if not file.sources:
        raise Error(f"file '{path}' names no pieces")
    folder = os.path.dirname(path)
    pieces = []
    for name in file.sources:
        piece = os.path.join(folder, name)
        if not os.path.exists(piece):
            raise Error(f"file '{path}' names the piece '{name}', which is not there; copy the pieces "
                        "of all ranks along with it")
        pieces.append(VtkSource(VtkFile(piece)))
    return PiecesSource(path, pieces)


def meta_of(source: Source) -> dict[str, Any]:
    """What an ArraySource needs besides arrays, for JSON."""
    grid = source.grid
    return {"kind": source.kind, "names": list(source.names),
            "grid": None if grid is None else [grid.cells, grid.origin, grid.spacing]}  # fmt: skip
