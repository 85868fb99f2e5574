# silt - BSD-3-Clause, see LICENSE
"""`silt compare`: differences of two outputs, field by field."""

from __future__ import annotations

import argparse
import glob
import math
import os
import re
from dataclasses import dataclass
from typing import Iterable, Optional, Sequence

import numpy as np

from .errors import Error
from .frame import Frame
from .names import label, same, split_unit, unit_of
from .series import VTK, Series
from .series import open as open_series
from .summaries import summary
from .tables import table

TIME = 1e-9  # [-] of the span of times: frames this close are of the same time


@dataclass
class Difference:
    """Of one field: `largest` and `rms` difference and `scale`, the largest value of both, in its
    `unit`; `count` values compared; `where` the largest one is: time [s], particle or row."""

    file: str
    name: str
    unit: str
    largest: float
    rms: float
    scale: float
    count: int
    where: str

    @property
    def relative(self) -> float:
        """The largest difference over the largest value [-]; inf where only one has a value."""
        return 0.0 if self.largest == 0 else self.largest / self.scale if self.scale > 0 else math.inf

    def exceeds(self, tolerance: float, absolute: float = 0) -> bool:
        return not (self.largest <= absolute or self.relative <= tolerance)


class Sum:
    """Gathers the differences of one field over frames."""

    def __init__(self, file: str, name: str) -> None:
        self.file, self.name = file, name
        self.largest = self.scale = self.squares = 0.0
        self.count, self.where = 0, ""

    def add(self, a: np.ndarray, b: np.ndarray, where) -> None:
        """`where(k)`: words for value k along the first axis."""
        if a.shape != b.shape:
            raise Error(f"{self.file}: '{self.name}' has the shape {a.shape} in A and {b.shape} in B")
        if a.size == 0:
            return
        if a.dtype.kind not in "fiub" or b.dtype.kind not in "fiub":
            apart = (a != b).astype(float)
            largest_value = 1.0
        else:
            both = a.dtype.kind in "iub" and b.dtype.kind in "iub"  # exact, ids of 64 bits too
            x, y = a.astype(float), b.astype(float)
            with np.errstate(invalid="ignore"):
                apart = np.abs(x - y)
            if both:
                apart = np.where(a == b, 0.0, np.maximum(apart, 1.0))
            else:
                apart = np.where((x == y) | np.isnan(x) & np.isnan(y), 0.0, apart)
                apart[np.isnan(apart)] = math.inf  # only one is a number
            finite = np.r_[np.abs(x[np.isfinite(x)]), np.abs(y[np.isfinite(y)])]
            largest_value = float(finite.max()) if len(finite) else 0.0
        self.scale = max(self.scale, largest_value)
        self.count += a.size
        self.squares += float(np.sum(np.square(apart)))
        most = float(apart.max())
        if most > self.largest:
            self.largest = most
            self.where = where(int(np.unravel_index(int(np.argmax(apart)), apart.shape)[0]))

    def result(self) -> Difference:
        word, unit = split_unit(self.name)[0], unit_of(self.name)
        rms = math.sqrt(self.squares / self.count) if self.count else 0.0
        return Difference(self.file, word, unit, self.largest, rms, self.scale, self.count, self.where)


class Choice:
    """Which fields are compared."""

    def __init__(self, fields: Optional[Sequence[str]] = None, ignore: Sequence[str] = ()) -> None:
        self.fields, self.ignore = fields, list(ignore)
        self.met: set[str] = set()

    def takes(self, name: str) -> bool:
        word = name.rpartition("/")[2]
        for wanted in self.fields or []:
            if same(wanted, name) or same(wanted, word):
                self.met.add(wanted)
                return True
        return self.fields is None and not any(same(i, name) or same(i, word) for i in self.ignore)

    def check(self) -> None:
        lost = [f for f in self.fields or [] if f not in self.met]
        if lost:
            raise Error(f"there is no field or column '{lost[0]}' in what is compared")


def compare(a: str, b: str, fields: Optional[Sequence[str]] = None,
            ignore: Sequence[str] = ()) -> list[Difference]:
    """Differences of two series (.pvd), files (.vtp, .vti, ...), tables (.csv), summaries (.json), or
    of all of these that two folders have. Particles are matched by id, contacts and bonds by the ids
    of their partners, rows of tables with a column id by that. `fields`: only these; `ignore`: not
    these. Errors: silt.Error where they cannot be compared: other times, particles, rows or fields,
    or a file that only one folder has."""
    a, b = os.fspath(a), os.fspath(b)
    choice = Choice(fields, ignore)
    if os.path.isdir(a) != os.path.isdir(b):
        raise Error(f"one of '{a}' and '{b}' is a folder; compare two folders or two files")
    found: list[Difference] = []
    if not os.path.isdir(a):
        found = _files(a, b, os.path.basename(a), choice)
    else:
        names = _shared(a, b)
        for name in names:
            found += _files(os.path.join(a, name), os.path.join(b, name), name, choice)
    choice.check()
    return found


def _shared(a: str, b: str) -> list[str]:
    """Files of both folders that are compared; of series their lists alone."""
    def those_of(folder: str) -> set[str]:
        names = {os.path.relpath(f, folder) for ending in ("pvd", "csv", "json", "npz")
                 for f in glob.glob(os.path.join(glob.escape(folder), "**", "*." + ending), recursive=True)}
        listed = set()
        for name in names:
            if name.endswith(".pvd"):
                from .series import read_list

                listed |= {os.path.relpath(f, folder) for _, files in read_list(os.path.join(folder, name))
                           for f in files}
        for ending in VTK:  # that no series lists and that are no pieces of ranks
            for f in glob.glob(os.path.join(glob.escape(folder), "**", "*" + ending), recursive=True):
                name = os.path.relpath(f, folder)
                if name not in listed and not re.search(r"_r\d+\.vt.$", name):
                    names.add(name)
        return {n for n in names if not n.endswith("series.json")}

    in_a, in_b = those_of(a), those_of(b)
    only = sorted(in_a ^ in_b)
    if only:
        where = a if only[0] in in_a else b
        raise Error(f"only '{where}' has '{only[0]}'" + (f", and {len(only) - 1} more files are in one of them alone"
                                                         if len(only) > 1 else ""))
    if not in_a:
        raise Error(f"folders '{a}' and '{b}' have no series, tables or summaries")
    return sorted(in_a)


def _files(a: str, b: str, name: str, choice: Choice) -> list[Difference]:
    endings = [os.path.splitext(path)[1].lower() for path in (a, b)]
    if endings == [".csv", ".csv"]:
        return _tables(a, b, name, choice)
    if endings == [".json", ".json"]:
        return _summaries(a, b, name, choice)
    if ".csv" in endings or ".json" in endings:
        raise Error(f"files '{a}' and '{b}' are of different kinds")
    return _series(open_series(a), open_series(b), name, choice)


def _series(a: Series, b: Series, name: str, choice: Choice) -> list[Difference]:
    if len(a) != len(b):
        raise Error(f"{name}: A has {len(a)} frames and B has {len(b)}")
    span = np.ptp(a.times) if len(a) else 0
    with np.errstate(invalid="ignore"):
        apart = np.abs(a.times - b.times) > TIME * max(span, 1e-300) + 1e-12
    if apart.any():
        k = int(np.argmax(apart))
        raise Error(f"{name}: frame {k} is of t = {a.times[k]:g} s in A and of t = {b.times[k]:g} s in B")
    sums: dict[str, Sum] = {}
    for left, right in zip(a, b):
        _frames(left, right, name, sums, choice)
    return [s.result() for s in sums.values()]


def _frames(a: Frame, b: Frame, name: str, sums: dict[str, Sum], choice: Choice) -> None:
    when = f"t = {a.time:g} s, " if math.isfinite(a.time) else ""
    if a.kind != b.kind or set(a.fields) != set(b.fields) and choice.fields is None:
        odd = sorted(set(a.fields) ^ set(b.fields))
        raise Error(f"{name}, {when}" + (f"A has {a.kind} and B has {b.kind}" if a.kind != b.kind else
                                         f"the field '{odd[0]}' is in one of them alone"))
    order_a, order_b, words = _order(a, b, name, when)
    for field_name in ["position", *a.fields]:
        if not choice.takes(field_name) or field_name not in a or field_name not in b:
            continue
        x, y = a[field_name], b[field_name]
        if order_a is not None:
            x, y = x[order_a], y[order_b]
        if field_name not in sums:
            sums[field_name] = Sum(name, field_name)
        sums[field_name].add(x, y, lambda k: when + words(k))


def _order(a: Frame, b: Frame, name: str, when: str):
    """How values of both go together: two orders (None: as they stand), and words for number k."""
    known = (("id",), ("number",), ("a", "b", "wall"))
    keys = next((keys for keys in known if all(k in a and k in b for k in keys)), None)
    if len(a) != len(b):
        raise Error(f"{name}, {when}A has {len(a)} {a.kind} and B has {len(b)}")
    if keys is None:
        return None, None, lambda k: f"layer {k} of cells along x" if a.kind == "grid" else f"value {k}"
    orders = [np.lexsort([frame[k] for k in reversed(keys)]) for frame in (a, b)]
    sorted_keys = [[frame[k][order] for k in keys] for frame, order in zip((a, b), orders)]
    for key, x, y in zip(keys, *sorted_keys):
        if (x != y).any():
            k = int(np.argmax(x != y))
            what = "particle" if keys == ("id",) else "bond" if keys == ("number",) else "contact"
            raise Error(f"{name}, {when}A and B have other {what}s: {key} {x[k]} in A where B has {y[k]}")
    if keys == ("id",):
        return orders[0], orders[1], lambda k: f"particle {sorted_keys[0][0][k]}"
    if keys == ("number",):
        return orders[0], orders[1], lambda k: f"bond {sorted_keys[0][0][k]}"
    return orders[0], orders[1], lambda k: "contact of " + " and ".join(str(s[k]) for s in sorted_keys[0][:2])


def _tables(a: str, b: str, name: str, choice: Choice) -> list[Difference]:
    left, right = table(a), table(b)
    odd = sorted(set(left.names) ^ set(right.names))
    if odd and choice.fields is None:
        raise Error(f"{name}: the column '{odd[0]}' is in one of them alone")
    if len(left) != len(right):
        raise Error(f"{name}: A has {len(left)} rows and B has {len(right)}")
    orders = (slice(None), slice(None))
    if "id" in left.names and "id" in right.names:
        orders = (np.argsort(left["id"], kind="stable"), np.argsort(right["id"], kind="stable"))
        if (left["id"][orders[0]] != right["id"][orders[1]]).any():
            raise Error(f"{name}: A and B have other particles")
    found = []
    for column in left.names:
        if choice.takes(column) and column in right.names:
            one = Sum(name, column)
            one.add(left[column][orders[0]], right[column][orders[1]], lambda k: f"row {k + 1}")
            found.append(one.result())
    return found


def _summaries(a: str, b: str, name: str, choice: Choice) -> list[Difference]:
    left, right = summary(a).numbers(), summary(b).numbers()
    odd = [n for n in sorted(set(left) ^ set(right)) if choice.takes(n)]
    if odd:
        raise Error(f"{name}: '{odd[0]}' is in one of them alone")
    found = []
    for place in left:
        if choice.takes(place):
            one = Sum(name, place)
            one.add(np.array([left[place]]), np.array([right[place]]), lambda k: "")
            found.append(one.result())
    return found


def show(found: Iterable[Difference], tolerance: float, absolute: float) -> str:
    """A line a field; those that differ too much are marked."""
    rows = [("", "field", "largest", "rms", "relative", "values", "where")]
    file = None
    for one in found:
        if one.file != file:
            file = one.file
            rows.append((one.file + ":",))
        rows.append(("FAIL" if one.exceeds(tolerance, absolute) else "", label(one.name, one.unit),
                     f"{one.largest:.3g}", f"{one.rms:.3g}", f"{one.relative:.2g}", str(one.count), one.where))
    wide = [max(len(row[k]) for row in rows if len(row) > 1) for k in range(7)]
    return "\n".join(row[0] if len(row) == 1 else
                     "  ".join(cell.rjust(w) if 2 <= k <= 5 else cell.ljust(w)
                               for k, (cell, w) in enumerate(zip(row, wide))).rstrip() for row in rows)


def run(options: argparse.Namespace) -> int:
    for option in ("tolerance", "absolute"):
        if not getattr(options, option) >= 0:
            raise Error(f"--{option} {getattr(options, option):g} must not be negative")
    words = [w.split(",") if w else None for w in (options.fields, options.ignore)]
    found = compare(options.a, options.b, words[0], words[1] or ())
    print(show(found, options.tolerance, options.absolute))
    beyond = [one for one in found if one.exceeds(options.tolerance, options.absolute)]
    if beyond:
        worst = max(beyond, key=lambda one: one.relative)
        print(f"{len(beyond)} of {len(found)} differ by more than the tolerance, {options.tolerance:g} of their largest "
              f"value; the most {worst.name}, by {worst.relative:.2g}")
        return 1
    print(f"all {len(found)} agree within {options.tolerance:g} of their largest values"
          if any(one.largest > 0 for one in found) else f"all {len(found)} are equal")
    return 0
