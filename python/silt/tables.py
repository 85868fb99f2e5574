# silt - BSD-3-Clause, see LICENSE
"""Tables of numbers: CSV files with a line of column names and units."""

from __future__ import annotations

import os
from typing import Iterator, Union

import numpy as np

from .errors import Error, cannot_read
from .names import find_name, split_unit, unit_of


class Table:
    """The columns of a CSV file.

        t["time"]           (rows,), with or without the unit: "time [s]" is the same
        t.unit("time")      "s", as the heading says; "" where it says none
        t.names             ("time [s]", "kinetic [J]"); len(t): rows
        t.rows              (rows, columns) of numbers
        t.columns           dict of arrays by full name

    Columns of words are arrays of words. A last row that a kill left incomplete is left out.
    """

    def __init__(self, path: str, columns: dict[str, np.ndarray]) -> None:
        self.path, self.columns = path, columns

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.columns)

    @property
    def units(self) -> dict[str, str]:
        """Units by the columns' words."""
        return {split_unit(name)[0]: unit_of(name) for name in self.columns}

    @property
    def rows(self) -> np.ndarray:
        """(rows, columns). Errors: silt.Error where a column has words."""
        for name, column in self.columns.items():
            if column.dtype.kind not in "fiu":
                raise Error(f"file '{self.path}': column '{name}' has words; ask for columns by name")
        return np.stack([c.astype(float) for c in self.columns.values()], axis=1)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and any(name in (n, split_unit(n)[0]) for n in self.columns)

    def name(self, wanted: str) -> str:
        """The full name of a column. Errors: names those there are."""
        return find_name(wanted, self.columns, "column", self.path)

    def unit(self, wanted: str) -> str:
        """The unit of a column; "" if the table does not say."""
        return unit_of(self.name(wanted))

    def __getitem__(self, wanted: str) -> np.ndarray:
        return self.columns[self.name(wanted)]

    def __repr__(self) -> str:
        return f"<silt.Table of {len(self)} rows, {', '.join(self.names)}, '{self.path}'>"


def table(path: Union[str, "os.PathLike[str]"]) -> Table:
    """Reads a CSV file of silt's. Errors: silt.Error for a file that is missing or no such table."""
    name = os.fspath(path)
    try:
        with open(name, encoding="utf-8-sig") as file:
            lines = file.read().split("\n")
    except OSError as error:
        raise cannot_read(name, error) from None
    except UnicodeDecodeError:
        raise Error(f"file '{name}' is no table: it is no text") from None
    lines = lines[:-1]  # what follows the last end of line is a row that is not whole
    if not lines or not lines[0].strip():
        raise Error(f"file '{name}' is no table: it has no line of column names"
                    + (", or is still being written" if not lines else ""))
    names = [word.strip() for word in lines[0].rstrip("\r").split(",")]
    if len(set(names)) < len(names):
        twice = next(n for n in names if names.count(n) > 1)
        raise Error(f"file '{name}' has two columns '{twice}'; give each its own name")
    cells = [line.rstrip("\r").split(",") for line in lines[1:]]
    for number, row in enumerate(cells, 2):
        if len(row) != len(names):
            raise Error(f"file '{name}' line {number} has {len(row)} cells, but there are {len(names)} columns")
    return Table(name, {n: _column([row[k] for row in cells]) for k, n in enumerate(names)})


def _column(words: list[str]) -> np.ndarray:
    try:  # ids of 64 bits must not be rounded
        if words and all(word.lstrip("-").isdigit() for word in words):
            numbers = [int(word) for word in words]
            return np.array(numbers, np.uint64 if max(numbers) > 2**63 - 1 and min(numbers) >= 0 else np.int64)
        return np.array(words, float)
    except OverflowError:
        return np.array(words, float)
    except ValueError:
        return np.array(words, str)
