# silt - BSD-3-Clause, see LICENSE
"""Series as numpy's own files: silt.npz_series."""

from __future__ import annotations

import builtins
import json
import os
from typing import Any, Optional, Sequence

import numpy as np

from .errors import Error, cannot_read
from .series import Path, Series
from .series import open as open_series
from .sources import GRID, LINES, MESH, SURFACE, ArraySource, Grid, Source, meta_of

GEOMETRY = {SURFACE: ("points", "triangles"), LINES: ("points", "lines"), GRID: (),
            MESH: ("points", "cells", "offsets", "types")}  # fmt: skip


def npz_series(series: Any, path: Path, fields: Optional[Sequence[str]] = None) -> str:
    """Writes a series (a Series, or what silt.open reads) to `path`: one file if it ends in .npz,
    else a folder with a file a frame and their list, series.json. silt.open reads both back; numpy
    alone reads the arrays as `numpy.load("bed.npz")["0/field/velocity"]`. `fields`: only these.
    Files are whole or not there. Returns the path.
    Errors: silt.Error for a field that is not there, and a file that cannot be written."""
    name = os.fspath(path)
    source = series if isinstance(series, Series) else open_series(series)
    meta: dict[str, Any] = {"times": source.times.tolist(), "steps": source.steps, "frames": []}
    if name.endswith(".npz"):
        arrays: dict[str, np.ndarray] = {}
        for k, frame in enumerate(source):
            meta["frames"].append(_add(arrays, f"{k}/", frame, fields))
        arrays["meta"] = np.array(json.dumps(meta))
        _save(name, arrays)
        return name
    try:
        os.makedirs(name, exist_ok=True)
    except OSError as error:
        raise Error(f"folder '{name}' cannot be created: {error.strerror}") from None
    meta["files"] = [f"frame_{k:06d}.npz" for k in range(len(source))]
    for k, frame in enumerate(source):
        arrays = {}
        meta["frames"].append(_add(arrays, "", frame, fields))
        _save(os.path.join(name, meta["files"][k]), arrays)
    _write(os.path.join(name, "series.json"), lambda file: file.write(json.dumps(meta).encode()))
    return name


def _add(arrays: dict[str, np.ndarray], prefix: str, frame, fields: Optional[Sequence[str]]) -> dict[str, Any]:
    source: Source = frame._source
    names = list(source.names) if fields is None else [frame.name(field) for field in fields]
    for field in names:
        arrays[f"{prefix}field/{field}"] = source.field(field)
    for part in GEOMETRY.get(source.kind, ("points",)):
        arrays[f"{prefix}geometry/{part}"] = source.geometry(part)
    return {**meta_of(source), "names": names}


def _save(path: str, arrays: dict[str, np.ndarray]) -> None:
    # numpy names its archive's members: a field's '/' makes folders in it, which zip allows.
    _write(path, lambda file: np.savez_compressed(file, **arrays))


def _write(path: str, write) -> None:
    partial = path + ".partial"
    try:
        with builtins.open(partial, "wb") as file:
            write(file)
        os.replace(partial, path)
    except OSError as error:
        if os.path.exists(partial):
            os.remove(partial)
        raise Error(f"file '{path}' cannot be written: {error.strerror or error}") from None


def open_npz(path: str) -> Series:
    """A series that npz_series wrote."""
    if os.path.isdir(path):
        try:
            with builtins.open(os.path.join(path, "series.json"), "rb") as file:
                meta = json.loads(file.read())
            files = [os.path.join(path, name) for name in meta["files"]]
        except OSError as error:
            raise cannot_read(os.path.join(path, "series.json"), error) from None
        except (ValueError, KeyError, TypeError):
            raise Error(f"file '{path}/series.json' is not as silt.npz_series writes it") from None
        return _series(path, meta, files, lambda k: (_load(files[k]), ""))
    archive = _load(path)
    try:
        meta = json.loads(str(archive["meta"]))
    except (KeyError, ValueError):
        raise Error(f"file '{path}' is not as silt.npz_series writes it") from None
    return _series(path, meta, [path] * len(meta["times"]), lambda k: (archive, f"{k}/"))


def _series(path: str, meta: dict[str, Any], files: list[str], arrays) -> Series:
    def load(k: int) -> Source:
        about = meta["frames"][k]
        grid = about["grid"]
        mapping, prefix = arrays(k)
        return ArraySource(files[k], about["kind"], list(about["names"]), mapping, prefix,
                           None if grid is None else Grid(*(tuple(part) for part in grid)))

    try:
        return Series(path, meta["times"], files, load, meta["steps"])
    except KeyError:
        raise Error(f"file '{path}' is not as silt.npz_series writes it") from None


def _load(path: str):
    try:
        return np.load(path, allow_pickle=False)
    except OSError as error:
        if error.errno is None:
            raise Error(f"file '{path}' is no file of numpy's (.npz), or is cut off") from None
        raise cannot_read(path, error) from None
    except Exception:  # zipfile.BadZipFile, ValueError, EOFError
        raise Error(f"file '{path}' is no file of numpy's (.npz), or is cut off") from None
