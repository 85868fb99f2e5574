# silt - BSD-3-Clause, see LICENSE
"""`silt compare`: differences of two outputs, field by field."""

from __future__ import annotations

import argparse
import glob
import math
import os
import re
from dataclasses import dataclass
from typing import Iterable, Optional, Sequence, Union

import numpy as np

from .errors import Error
from .frame import Frame
from .names import label, same, split_unit, unit_of
from .series import VTK, Series
from .series import open as open_series
from .summaries import Summary, summary
from .tables import Table, table

OF_KIND = {"surface": "points of a surface", "grid": "cells", "mesh": "cells"}
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


class Apart(Error):
    """What --common passes over."""


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


class Comparison:
    """What a comparison has found: `found` differences; `left_out`: words for what --common has passed
    over; `failed`: a sentence for each file that cannot be compared, of `files` in all."""

    def __init__(self, choice: Choice, common: bool) -> None:
        self.choice, self.common = choice, common
        self.found: list[Difference] = []
        self.left_out: list[str] = []
        self.failed: dict[str, Error] = {}
        self.files = 1

    def leave_out(self, name: str, count_a: int, of_a: int, count_b: int, of_b: int, what: str, where: str = "") -> None:
        """Counts what one side has alone."""
        if count_a or count_b:
            self.left_out.append(f"{name}{where}: {count_a} of {of_a} {what} of A and {count_b} of {of_b} of B")

    def error(self) -> Optional[Error]:
        """Of the files that cannot be compared, in one sentence."""
        if not self.failed:
            return None
        words = "; ".join(map(str, self.failed.values()))
        if self.files > 1:
            words = f"{len(self.failed)} of {self.files} files cannot be compared: {words}"
        if any(isinstance(one, Apart) for one in self.failed.values()):
            words += "; --common (in Python common=True) compares what both have"
        return Error(words)


Comparable = Union[str, "os.PathLike[str]", Series, Frame, Table, Summary]


def compare(a: Comparable, b: Comparable, fields: Optional[Sequence[str]] = None,
            ignore: Sequence[str] = (), common: bool = False) -> list[Difference]:
    """Differences of two series (.pvd), files (.vtp, .vti, ...), tables (.csv), summaries (.json), or
    of all of these that two folders have; by their paths, or as Series (slices too), Frames (whatever
    their times), Tables, Summaries. Particles are matched by id, contacts and bonds by the ids of their
    partners, rows of tables with a column id by that. `fields`: only these; `ignore`: not these;
    `common`: only times, particles, rows, fields and files that both have. Errors: silt.Error where
    they cannot be compared: other times, particles, rows or fields, or a file that only one folder
    has; of folders after all files, naming each."""
    both = compare_all(a, b, fields, ignore, common)
    error = both.error()
    if error is not None:
        raise error
    return both.found


def compare_all(a: Comparable, b: Comparable, fields: Optional[Sequence[str]] = None,
                ignore: Sequence[str] = (), common: bool = False) -> Comparison:
    """As compare(), with what was left out; folders go on where a file cannot be compared."""
    both = Comparison(Choice(fields, ignore), common)
    a, b = _known(a), _known(b)
    paths = isinstance(a, str) and isinstance(b, str)
    if paths and os.path.isdir(a) != os.path.isdir(b):
        for path in (a, b):
            if not os.path.exists(path):
                raise Error(f"there is no file or folder '{path}'")
        raise Error(f"'{a if os.path.isdir(a) else b}' is a folder; compare two folders or two files")
    pairs = [(a, b, os.path.basename(a) if isinstance(a, str) else "")]
    if paths and os.path.isdir(a):
        pairs = [(os.path.join(a, name), os.path.join(b, name), name) for name in _shared(a, b, both)]
    both.files = len(pairs) + len(both.failed)
    for left, right, name in pairs:
        try:
            both.found += (_files if paths else _objects)(left, right, name, both)
        except Error as error:
            both.failed[name] = error
    if not both.failed:
        both.choice.check()
    return both


def _known(given):
    """A path as text, a Frame as a series of one; others as they are."""
    if isinstance(given, Frame):
        return Series(given.path, [math.nan], [given.path], lambda k: given._source, [given.step])
    if isinstance(given, (Series, Table, Summary)):
        return given
    try:
        return os.fspath(given)
    except TypeError:
        raise Error("silt.compare takes paths, Series, Frames, Tables and Summaries, no "
                    f"{type(given).__name__}") from None


def _objects(a, b, name: str, both: Comparison) -> list[Difference]:
    """Of what is read already, or one of a path and one that is."""
    name = name or os.path.basename(a.path)
    for kind, read, differ in ((Series, open_series, _series), (Table, table, _tables),
                               (Summary, summary, _summaries)):
        if isinstance(a, kind) or isinstance(b, kind):
            a, b = (read(x) if isinstance(x, str) else x for x in (a, b))
            if not (isinstance(a, kind) and isinstance(b, kind)):
                raise Error(f"silt.compare: '{a.path}' is a {type(a).__name__} and '{b.path}' a "
                            f"{type(b).__name__}; give two of one kind")
            return differ(a, b, name, both)
    raise AssertionError("of no kind")


def _shared(a: str, b: str, both: Comparison) -> list[str]:
    """Files of both folders that are compared; of series their lists alone. Others are noted."""
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
    if not in_a | in_b:
        raise Error(f"folders '{a}' and '{b}' have no series, tables or summaries")
    if both.common:
        if not in_a & in_b:
            raise Error(f"folders '{a}' and '{b}' have no file in common")
        only = sorted(in_a ^ in_b)
        if only:
            both.left_out.append("the files " + ", ".join(only[:5]) + (f" and {len(only) - 5} more" if only[5:] else ""))
        return sorted(in_a & in_b)
    for name in sorted(in_a ^ in_b):
        both.failed[name] = Apart(f"only '{a if name in in_a else b}' has '{name}'")
    return sorted(in_a & in_b)


def _files(a: str, b: str, name: str, both: Comparison) -> list[Difference]:
    endings = [os.path.splitext(path)[1].lower() for path in (a, b)]
    if endings == [".csv", ".csv"]:
        return _tables(table(a), table(b), name, both)
    if endings == [".json", ".json"]:
        return _summaries(summary(a), summary(b), name, both)
    if ".csv" in endings or ".json" in endings:
        raise Error(f"files '{a}' and '{b}' are of different kinds")
    return _series(open_series(a), open_series(b), name, both)


def _pairs(a: np.ndarray, b: np.ndarray, within: float = 0) -> tuple[np.ndarray, np.ndarray]:
    """Where values of `a` and `b` stand that are the same, `within` this; each once, in a's order."""
    if len(a) == 0 or len(b) == 0:
        return np.empty(0, int), np.empty(0, int)
    order = np.argsort(b, kind="stable")
    right = np.clip(np.searchsorted(b[order], a), 1, max(len(b) - 1, 1))
    near = [order[np.minimum(right - k, len(b) - 1)] for k in (0, 1)]
    best = np.where(np.abs(b[near[0]] - a) < np.abs(b[near[1]] - a), near[0], near[1])
    of_a = np.flatnonzero(np.abs(b[best] - a) <= within)
    of_a = of_a[np.sort(np.unique(best[of_a], return_index=True)[1])]
    return of_a, best[of_a]


def _span(times: np.ndarray) -> float:
    """[s] Times this close are the same."""
    return TIME * max(float(np.ptp(times)) if len(times) else 0.0, 1e-300) + 1e-12


def _common_frames(a: Series, b: Series, name: str, both: Comparison) -> tuple[Sequence[int], Sequence[int]]:
    """Numbers of frames of the same time; where no time is known of the same step, else number."""
    if np.isfinite(a.times).all() and np.isfinite(b.times).all():
        of_a, of_b = _pairs(a.times, b.times, _span(a.times))
    elif None not in a.steps and None not in b.steps:
        of_a, of_b = _pairs(np.array(a.steps, float), np.array(b.steps, float))
    else:
        of_a = of_b = np.arange(min(len(a), len(b)))
    if len(of_a) == 0 and len(a) and len(b):
        raise Error(f"{name}: A and B have no time or step in common")
    both.leave_out(name, len(a) - len(of_a), len(a), len(b) - len(of_b), len(b), "frames")
    return of_a.tolist(), of_b.tolist()


def _series(a: Series, b: Series, name: str, both: Comparison) -> list[Difference]:
    if both.common:
        of_a, of_b = _common_frames(a, b, name, both)
    else:
        if len(a) != len(b):
            raise Apart(f"{name}: A has {len(a)} frames and B has {len(b)}")
        with np.errstate(invalid="ignore"):
            apart = np.abs(a.times - b.times) > _span(a.times)
        if apart.any():
            k = int(np.argmax(apart))
            raise Apart(f"{name}: frame {k} is of t = {a.times[k]:g} s in A and of t = {b.times[k]:g} s in B")
        of_a = of_b = range(len(a))
    sums: dict[str, Sum] = {}
    before = len(both.left_out)
    for k, m in zip(of_a, of_b):
        _frames(a[k], b[m], name, sums, both)
    if len(both.left_out) > before + 3:  # a line a frame would hide the rest
        more = len(both.left_out) - before - 2
        both.left_out[before + 2:] = [f"{name}: the like in {more} more cases"]
    return [s.result() for s in sums.values()]


def _frames(a: Frame, b: Frame, name: str, sums: dict[str, Sum], both: Comparison) -> None:
    when = f"t = {a.time:g} s, " if math.isfinite(a.time) else ""
    choice, odd = both.choice, sorted(set(a.fields) ^ set(b.fields))
    if a.kind != b.kind:
        raise Error(f"{name}, {when}A has {a.kind} and B has {b.kind}")
    if odd and choice.fields is None:
        if not both.common:
            raise Apart(f"{name}, {when}the field '{odd[0]}' is in one of them alone")
        words = f"{name}: the fields {', '.join(odd)}"
        if words not in both.left_out:
            both.left_out.append(words)
    order_a, order_b, words = _order(a, b, name, when, both)
    for field_name in ["position", *a.fields]:
        if not choice.takes(field_name) or field_name not in a or field_name not in b:
            continue
        x, y = a[field_name], b[field_name]
        if order_a is not None:
            x, y = x[order_a], y[order_b]
        if field_name not in sums:
            sums[field_name] = Sum(name, field_name)
        sums[field_name].add(x, y, lambda k: when + words(k))


def _order(a: Frame, b: Frame, name: str, when: str, both: Comparison):
    """How values of both go together: two orders (None: as they stand), and words for number k."""
    known = (("id",), ("number",), ("a", "b", "wall"))
    keys = next((keys for keys in known if all(k in a and k in b for k in keys)), None)
    if len(a) != len(b) and not (both.common and keys):
        raise (Apart if keys else Error)(f"{name}, {when}A has {len(a)} {OF_KIND.get(a.kind, a.kind)} and B has {len(b)}")
    if keys is None:
        return None, None, lambda k: f"layer {k} of cells along x" if a.kind == "grid" else f"value {k}"
    what = "particle" if keys == ("id",) else "bond" if keys == ("number",) else "contact"
    orders = [np.lexsort([frame[k] for k in reversed(keys)]) for frame in (a, b)]
    if both.common:
        rows = [list(zip(*(frame[k][order].tolist() for k in keys))) for frame, order in zip((a, b), orders)]
        shared = set(rows[0]) & set(rows[1])
        orders = [order[[row in shared for row in r]] if len(r) else order for order, r in zip(orders, rows)]
        both.leave_out(name, len(a) - len(orders[0]), len(a), len(b) - len(orders[1]), len(b), what + "s",
                       f", {when}"[:-2] if when else "")
        if len(orders[0]) != len(orders[1]):
            raise Error(f"{name}, {when}a {what} stands there twice in one of A and B")
    sorted_keys = [[frame[k][order] for k in keys] for frame, order in zip((a, b), orders)]
    for key, x, y in zip(keys, *sorted_keys):
        if (x != y).any():
            k = int(np.argmax(x != y))
            raise Apart(f"{name}, {when}A and B have other {what}s: {key} {x[k]} in A where B has {y[k]}")
    if len(keys) == 1:
        return orders[0], orders[1], lambda k: f"{what} {sorted_keys[0][0][k]}"
    return orders[0], orders[1], lambda k: "contact of " + " and ".join(str(s[k]) for s in sorted_keys[0][:2])


def _rows(left: Table, right: Table, name: str, both: Comparison):
    """Rows of two tables that go together: by id, of --common by time or step too, else by number."""
    key = next((k for k in ("id", "time", "step") if k in left and k in right
                and all(t[k].dtype.kind in "fiu" for t in (left, right))), None)
    if both.common:
        if key is None:
            of_a = of_b = np.arange(min(len(left), len(right)))
        else:
            x, y = left[key], right[key]
            of_a, of_b = _pairs(x, y, _span(x) if key == "time" else 0)
        if len(of_a) == 0 and len(left) and len(right):
            raise Error(f"{name}: A and B have no row in common")
        both.leave_out(name, len(left) - len(of_a), len(left), len(right) - len(of_b), len(right), "rows")
        return of_a, of_b
    if len(left) != len(right):
        raise Apart(f"{name}: A has {len(left)} rows and B has {len(right)}")
    if key != "id":
        return slice(None), slice(None)
    orders = (np.argsort(left["id"], kind="stable"), np.argsort(right["id"], kind="stable"))
    if (left["id"][orders[0]] != right["id"][orders[1]]).any():
        raise Apart(f"{name}: A and B have other particles")
    return orders


def _tables(left: Table, right: Table, name: str, both: Comparison) -> list[Difference]:
    odd = sorted(set(left.names) ^ set(right.names))
    if odd and both.choice.fields is None:
        if not both.common:
            raise Apart(f"{name}: the column '{odd[0]}' is in one of them alone")
        both.left_out.append(f"{name}: the columns {', '.join(odd)}")
    of_a, of_b = _rows(left, right, name, both)
    numbers = np.arange(len(left))[of_a]
    found = []
    for column in left.names:
        if both.choice.takes(column) and column in right.names:
            one = Sum(name, column)
            one.add(left[column][of_a], right[column][of_b], lambda k: f"row {numbers[k] + 1}")
            found.append(one.result())
    return found


def _summaries(a: Summary, b: Summary, name: str, both: Comparison) -> list[Difference]:
    left, right, choice = a.numbers(), b.numbers(), both.choice
    odd = [n for n in sorted(set(left) ^ set(right)) if choice.takes(n)]
    if odd and not both.common:
        raise Apart(f"{name}: '{odd[0]}' is in one of them alone")
    if odd:
        both.left_out.append(f"{name}: the numbers {', '.join(odd)}")
    found = []
    for place in left:
        if choice.takes(place) and place in right:
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
    both = compare_all(options.a, options.b, words[0], words[1] or (), options.common)
    found, error = both.found, both.error()
    if found or error is None:
        print(show(found, options.tolerance, options.absolute))
    for words_of_one in both.left_out:
        print(f"left out: {words_of_one}")
    beyond = [one for one in found if one.exceeds(options.tolerance, options.absolute)]
    if beyond:
        worst = max(beyond, key=lambda one: one.relative)
        print(f"{len(beyond)} of {len(found)} differ by more than the tolerance, {options.tolerance:g} of their largest "
              f"value; the most {worst.name}, by {worst.relative:.2g}")
    if error is not None:
        raise error
    if beyond:
        return 1
    print(f"all {len(found)} agree within {options.tolerance:g} of their largest values"
          if any(one.largest > 0 for one in found) else f"all {len(found)} are equal")
    return 0
