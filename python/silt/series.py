# silt - BSD-3-Clause, see LICENSE
"""Time series of files: silt.open."""

from __future__ import annotations

import builtins
import glob
import math
import os
import re
import xml.etree.ElementTree as ElementTree
from typing import Callable, Iterator, NamedTuple, Optional, Sequence, Union, overload

import numpy as np

from .errors import Error, NoFrame, cannot_read
from .frame import Frame
from .sources import PiecesSource, Source, source_of

Path = Union[str, "os.PathLike[str]"]
VTK = (".vtp", ".pvtp", ".vti", ".vtu", ".pvtu")


class Track(NamedTuple):
    """Particles through time: `times` (n,) [s], `values` (n, ...), nan where one is not there."""

    times: np.ndarray
    values: np.ndarray


class Series:
    """Frames in the order of time. Files are opened when a frame's arrays are asked for.

        s.times              (n,) [s]
        len(s), s[0], s[-1]  frames; s[::10] is a Series of every tenth
        s.at(0.5)            the frame nearest to that time [s]
        for frame in s:      in turn; a frame keeps its arrays as long as you keep it
    """

    def __init__(self, path: str, times: Sequence[float], files: Sequence[str],
                 load: Callable[[int], Source], steps: Optional[Sequence[Optional[int]]] = None) -> None:
        self.path = path
        self.times: np.ndarray = np.asarray(times, float)
        self.files = list(files)
        self.steps = list(steps) if steps is not None else [step_in(name) for name in self.files]
        self._load = load

    def __len__(self) -> int:
        return len(self.times)

    def __repr__(self) -> str:
        span = f", t = {self.times[0]:g} to {self.times[-1]:g} s" if len(self) else ""
        return f"<silt.Series of {len(self)} frames{span}, '{self.path}'>"

    @overload
    def __getitem__(self, which: int) -> Frame: ...
    @overload
    def __getitem__(self, which: slice) -> "Series": ...
    def __getitem__(self, which):
        if isinstance(which, slice):
            chosen = range(len(self))[which]
            return Series(self.path, self.times[which], [self.files[k] for k in chosen],
                          lambda k: self._load(chosen[k]), [self.steps[k] for k in chosen])
        if len(self) == 0:
            raise Error(f"series '{self.path}' has no frames yet")
        if not -len(self) <= which < len(self):
            raise NoFrame(f"series '{self.path}' has {len(self)} frames, no number {which}")
        k = which % len(self)
        return Frame(self._load(k), float(self.times[k]), self.steps[k])

    def __iter__(self) -> Iterator[Frame]:
        return (self[k] for k in range(len(self)))

    def number_at(self, time: float) -> int:
        """The number of the frame nearest to a time [s]."""
        if len(self) == 0:
            raise Error(f"series '{self.path}' has no frames yet")
        if math.isnan(time):
            raise Error(f"series '{self.path}': the time is nan; give it in s")
        return int(np.argmin(np.abs(self.times - time))) if np.isfinite(self.times).any() else 0

    def at(self, time: float) -> Frame:
        """The frame nearest to a time [s]."""
        return self[self.number_at(time)]

    def track(self, ids, field: str) -> Track:
        """A field of one particle, (n,) or (n, 3), or of several, (n, particles, ...), through time;
        by id. nan (of whole numbers, too) where a particle is not there.
        Errors: silt.Error for a field that is not there, and ids that no frame has."""
        wanted = np.asarray(ids)
        values, seen = [], np.zeros(wanted.shape, bool)
        shape: tuple[int, ...] = ()
        for frame in self:
            at = frame.find(wanted)
            here = frame[field].astype(float)
            shape = here.shape[1:]
            row = np.full(wanted.shape + shape, math.nan)
            row[at >= 0] = here[at[at >= 0]]
            seen |= at >= 0
            values.append(row)
        if not seen.all():
            lost = np.atleast_1d(wanted)[~np.atleast_1d(seen)]
            raise Error(f"series '{self.path}' has no particle with the id {lost[0]} in any frame")
        return Track(self.times.copy(), np.array(values).reshape((len(self),) + wanted.shape + shape))


def step_in(name: str) -> Optional[int]:
    """The step that the name of a file has: 'particles_000001200.vtp' -> 1200, 'w10.vtp' -> 10."""
    found = re.search(r"(\d+)(?:_r\d+)?\.[a-z]+$", os.path.basename(name))
    return int(found[1]) if found else None


def open(path: Union[Path, Sequence[Path]]) -> Series:  # noqa: A001  (as gzip.open)
    """Any series that silt writes: a `.pvd` list of .vtp, .pvtp or .vti files; a folder that has one
    (of several particles.pvd); a .npz file or folder of silt.npz_series; a single file, or a list or
    pattern of them, in this order or that of their steps, with times where a .pvd beside them tells.
    Errors: silt.Error for a file that is missing, cut off or of another kind."""
    if isinstance(path, (list, tuple)):
        return _of_files([os.fspath(p) for p in path], "files")
    name = os.fspath(path)  # type: ignore[arg-type]
    ending = os.path.splitext(name)[1].lower()
    if os.path.isdir(name):
        return _of_folder(name)
    if ending == ".pvd":
        return _of_list(name)
    if ending == ".npz":
        from .npz import open_npz

        return open_npz(name)
    if ending in VTK and not os.path.exists(name) and glob.has_magic(name):
        found = sorted(glob.glob(name), key=lambda f: (step_in(f) is None, step_in(f) or 0, f))
        if not found:
            raise Error(f"there is no file '{name}'")
        return _of_files(found, name)
    if not os.path.exists(name):
        raise cannot_read(name, FileNotFoundError(2, "No such file or directory"))
    if ending in VTK:
        return _of_files([name], name)
    if ending == ".csv":
        raise Error(f"file '{name}' is a table: read it by silt.table, draw it by `silt curves`")
    if ending == ".json":
        raise Error(f"file '{name}' is a summary: read it by silt.summary")
    if ending == ".silt":
        raise Error(f"file '{name}' is a checkpoint: only `python3 -m silt info` looks at it, and "
                    "silt::load_checkpoint reads it")
    raise Error(f"file '{name}' is none that silt.open reads: .pvd, {', '.join(VTK)}, .npz, or a folder")


def read(path: Path) -> Frame:
    """One file (.vtp, .pvtp, .vti, .vtu) as a Frame; of a series its last frame."""
    return open(path)[-1]


def _of_files(names: list[str], path: str) -> Series:
    if not names:
        raise Error("silt.open: the list of files is empty")
    times = [time_in_list(name) for name in names]
    return Series(path, [math.nan if t is None else t for t in times], names,
                  lambda k: source_of(names[k]))


def _of_folder(folder: str) -> Series:
    if os.path.exists(os.path.join(folder, "series.json")):
        from .npz import open_npz

        return open_npz(folder)
    for inner in (folder, os.path.join(folder, "vtk")):
        lists = sorted(glob.glob(os.path.join(glob.escape(inner), "*.pvd")))
        particles = os.path.join(inner, "particles.pvd")
        if particles in lists or len(lists) == 1:
            return _of_list(particles if particles in lists else lists[0])
        if lists:
            raise Error(f"folder '{folder}' has several series; open one of "
                        f"{', '.join(os.path.relpath(name, folder) for name in lists)}")
    raise Error(f"folder '{folder}' has no series (.pvd), and no folder vtk that has one")


def read_list(path: str) -> list[tuple[float, list[str]]]:
    """Times [s] and files (several: parts of a frame) of a .pvd list, in its order."""
    try:
        with builtins.open(path, "rb") as file:
            content = file.read()
    except OSError as error:
        raise cannot_read(path, error) from None
    if not content.strip():
        raise Error(f"series '{path}' is empty, as a power failure may leave it; open its files themselves")
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError:
        if content.lstrip().startswith((b"<?xml", b"<VTKFile")):
            raise Error(f"series '{path}' is cut off; open its files themselves, as in "
                        "silt.open('particles_*.vtp')") from None
        raise Error(f"file '{path}' is no series of VTK files (.pvd)") from None
    if root.get("type") != "Collection":
        raise Error(f"file '{path}' is no series of VTK files (.pvd)")
    frames: list[tuple[float, list[str]]] = []
    folder = os.path.dirname(path)
    try:
        for entry in root.iter("DataSet"):
            time, file_name = float(entry.attrib["timestep"]), os.path.join(folder, entry.attrib["file"])
            if frames and frames[-1][0] == time:
                frames[-1][1].append(file_name)
            else:
                frames.append((time, [file_name]))
    except (KeyError, ValueError):
        raise Error(f"series '{path}' has an entry without a time or a file") from None
    return frames


def _of_list(path: str) -> Series:
    frames = read_list(path)

    def load(k: int) -> Source:
        for name in frames[k][1]:
            if not os.path.exists(name):
                raise Error(f"series '{path}' lists the file '{os.path.basename(name)}' for t = "
                            f"{frames[k][0]:g} s, which is not there; copy all files of the series together")
        parts = [source_of(name) for name in frames[k][1]]
        return parts[0] if len(parts) == 1 else PiecesSource(frames[k][1][0], parts)

    return Series(path, [time for time, _ in frames], [names[0] for _, names in frames], load)


def time_in_list(path: str) -> Optional[float]:
    """The time [s] of a file, as a .pvd file beside it says, or None."""
    folder = os.path.dirname(path)
    for series in sorted(glob.glob(os.path.join(glob.escape(folder), "*.pvd"))):
        try:
            for time, names in read_list(series):
                if path in names:
                    return time
        except Error:
            continue
    return None
