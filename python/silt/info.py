# silt - BSD-3-Clause, see LICENSE
"""`silt info`: what is in a file, a series or a folder."""

from __future__ import annotations

import glob
import os
import struct

import numpy as np

from .errors import Error, cannot_read
from .frame import OF_KIND, Frame
from .names import AXES, label, split_unit, unit_of
from .series import VTK, Series
from .series import open as open_series
from .sources import GRID, LINES, SURFACE
from .summaries import summary
from .tables import table

MAGIC = b"\x89SILTCP\n"


def describe(path: str) -> str:
    """Some lines of text. Errors: silt.Error."""
    if os.path.isdir(path):
        return _folder(path)
    ending = os.path.splitext(path)[1].lower()
    if ending == ".csv":
        return _table(path)
    if ending == ".json":
        return _summary(path)
    if os.path.basename(path) == "failure.txt":
        return _failure(path)
    if ending not in (".pvd", ".npz", *VTK) and _is_checkpoint(path):
        return _checkpoint(path)
    series = open_series(path)
    if len(series) == 0:
        return f"{path}: a series without frames"
    return _series(series) if ending in (".pvd", ".npz") else f"{path}: " + _frame(series[-1])


NOBODY = np.iinfo(np.uint64).max


def _span(values: np.ndarray) -> str:
    """Least and greatest of finite values."""
    finite = values[np.isfinite(values)] if values.dtype.kind == "f" else values.reshape(-1)
    if finite.size == 0:
        return "no finite values" if values.size else "none"
    lost = values.size - finite.size
    if values.dtype == np.uint64:  # the greatest number stands for no particle
        finite = finite[finite != NOBODY]
        if finite.size == 0:
            return "none"
    none = values.size - lost - finite.size
    low, high = finite.min(), finite.max()
    words = f"{low:.6g} to {high:.6g}" if low != high else f"{low:.6g}"
    if values.dtype.kind in "iu":
        words = f"{low} to {high}" if low != high else f"{low}"
    return words + (f" ({lost} not finite)" if lost else f" ({none} none)" if none else "")


def _rows(rows: list[tuple[str, ...]]) -> str:
    wide = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join("  " + "  ".join(cell.ljust(w) for cell, w in zip(row, wide)).rstrip() for row in rows)


def _series(series: Series) -> str:
    times = series.times
    span = f"t = {times[0]:g} to {times[-1]:g} s" if len(series) > 1 else f"t = {times[0]:g} s"
    frames = f"{len(series)} frame{'s' if len(series) > 1 else ''}"
    return f"{series.path}: {frames}, {span}\nthe last, " + _frame(series[-1])


def _frame(frame: Frame) -> str:
    when = f", t = {frame.time:g} s" if np.isfinite(frame.time) else ""
    what = OF_KIND[frame.kind]
    if frame.kind == SURFACE:
        what += f" with {len(frame.triangles)} triangles"
        if "id" in frame:
            what += f" of {len(np.unique(frame.ids))} bodies"
    if frame.kind == LINES:
        what = "bonds" if "bending" in frame else "contacts" if "overlap" in frame else what
    if frame.kind == GRID:
        nx, ny, nz = frame.grid.cells
        what = f"cells, {nx} x {ny} x {nz} of " + " x ".join(f"{h:g}" for h in frame.grid.spacing) + " m"
    by = f", by {frame.ranks} ranks" if frame.ranks > 1 else ""
    rows = []
    place = frame.position.reshape(-1, 3)
    for axis in range(3):
        rows.append((label(AXES[axis], "m"), "", _span(place[:, axis])))
    for name in frame.fields:
        values = frame[name]
        count = 1 if values.ndim == (3 if frame.kind == GRID else 1) else values.shape[-1]
        size = values if count == 1 else np.linalg.norm(values, axis=-1)
        rows.append((label(split_unit(name)[0], unit_of(name)), "" if count == 1 else f"{count} components, length",
                     _span(size)))
    return f"{os.path.basename(frame.path)}: {len(frame)} {what}{when}{by}\n" + _rows(rows)


def _table(path: str) -> str:
    read = table(path)
    return f"{path}: a table of {len(read)} rows\n" + _rows(
        [(name, _span(column) if column.dtype.kind in "fiu" else f"words, {len(np.unique(column))} different")
         for name, column in read.columns.items()])


def _summary(path: str) -> str:
    read = summary(path)
    held = sum(bool(check.get("holds")) for check in read.checks)
    lines = [f"{path}: {len(read.inputs)} inputs, {len(read.results)} results, {held} of {len(read.checks)} checks "
             "hold"]
    if read.results:
        lines.append(_rows([(name, f"{value:.6g}" if isinstance(value, float) else str(value)[:60])
                            for name, value in read.results.items()]))
    for check in read.checks:
        if not check.get("holds"):
            lines.append(f"  FAIL {check.get('name')}: {check.get('value')} must be {check.get('must_be')} "
                         f"{check.get('limit')}")
    return "\n".join(lines)


def _failure(path: str) -> str:
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return f"{path}:\n" + "\n".join("  " + line for line in file.read().rstrip().split("\n"))
    except OSError as error:
        raise cannot_read(path, error) from None


def _is_checkpoint(path: str) -> bool:
    try:
        with open(path, "rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except OSError as error:
        raise cannot_read(path, error) from None


def _checkpoint(path: str) -> str:
    """Signature and fields of a checkpoint; only a program that has built the scene can load it."""
    with open(path, "rb") as file:
        head = file.read(32)
        cut_off = Error(f"checkpoint '{path}' is cut off; take an older one")
        if len(head) < 32:
            raise cut_off
        mark, version, size, table_size = struct.unpack("<IIQQ", head[8:])
        if mark != 0x01020304 or version != 2:
            raise Error(f"checkpoint '{path}' is of version {version}, of which this package knows nothing; it knows "
                        "version 2")
        if size != os.path.getsize(path) or table_size > 1 << 20:
            raise cut_off
        words = file.read(table_size)
    at = 0

    def take(form: str):
        nonlocal at
        value = struct.unpack_from("<" + form, words, at)
        at += struct.calcsize("<" + form)
        return value[0]

    try:
        length = take("Q")
        signature = words[at:at + length].decode("utf-8", "replace")
        at += length
        fields = []
        for _ in range(take("Q")):
            length = take("I")
            name = words[at:at + length].decode("utf-8", "replace")
            at += length
            kind, item, count = chr(take("B")), take("B"), take("Q")
            word = {"f": "float", "u": "uint", "i": "int"}.get(kind)
            fields.append((name, "text" if word is None else f"{word}{8 * item}", f"{count} values"))
    except struct.error:
        raise Error(f"checkpoint '{path}' is damaged: its table of fields is invalid") from None
    policies = "\n".join("  " + part.strip() for part in signature.split(";") if part.strip())
    return f"{path}: a checkpoint of {size} bytes, written by\n{policies}\nwith\n" + _rows(fields)


def _folder(path: str) -> str:
    lines = [f"{path}:"]
    for name in sorted(glob.glob(os.path.join(glob.escape(path), "**", "*"), recursive=True)):
        ending, short = os.path.splitext(name)[1].lower(), os.path.relpath(name, path)
        try:
            if ending == ".pvd":
                series = open_series(name)
                what = f"{len(series)} frames" + (
                    f", t = {series.times[0]:g} to {series.times[-1]:g} s, the last of {len(series[-1])} "
                    f"{OF_KIND[series[-1].kind]}" if len(series) else "")
            elif ending == ".csv":
                read = table(name)
                what = f"{len(read)} rows: {', '.join(read.names)}"
            elif os.path.basename(name) == "summary.json":
                read_summary = summary(name)
                what = f"{len(read_summary.results)} results, {len(read_summary.checks)} checks, " + \
                    ("all hold" if read_summary.all_hold else "NOT all hold")
            elif os.path.basename(name) == "failure.txt":
                what = _failure(name).split("\n")[1].strip()
            elif ending == ".silt":
                what = "a checkpoint"
            else:
                continue
        except Error as error:
            what = str(error)
        lines.append(f"  {short}: {what}")
    if len(lines) == 1:
        raise Error(f"folder '{path}' has no series, tables, summaries or checkpoints")
    return "\n".join(lines)
