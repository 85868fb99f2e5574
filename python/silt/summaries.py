# silt - BSD-3-Clause, see LICENSE
"""summary.json of examples and studies: inputs, results, checks."""

from __future__ import annotations

import json
import os
from typing import Any, Union

from .errors import Error, cannot_read


class Summary:
    """A summary.json: `inputs`, `versions`, `results` are dicts, `checks` a list of dicts with name,
    value, must_be, limit and holds; `all_hold` whether all do; `raw` all of the file.

        s["mass [kg]"]   a result, or an input of that name
    """

    def __init__(self, path: str, raw: dict[str, Any]) -> None:
        self.path, self.raw = path, raw
        self.inputs: dict[str, Any] = raw.get("inputs", {})
        self.versions: dict[str, Any] = raw.get("versions", {})
        self.results: dict[str, Any] = raw.get("results", {})
        self.checks: list[dict[str, Any]] = raw.get("checks", [])

    @property
    def all_hold(self) -> bool:
        return all(check.get("holds", False) for check in self.checks)

    def __getitem__(self, name: str) -> Any:
        for part in (self.results, self.inputs):
            if name in part:
                return part[name]
        raise Error(f"file '{self.path}' has no result or input '{name}'; it has: "
                    f"{', '.join([*self.results, *self.inputs]) or 'none'}")

    def numbers(self) -> dict[str, float]:
        """All numbers by their place, as "results/mass [kg]" or "checks/energy/value"."""
        found: dict[str, float] = {}

        def visit(value: Any, place: str) -> None:
            if isinstance(value, bool) or isinstance(value, (int, float)):
                found[place] = float(value)
            elif isinstance(value, dict):
                for key, inner in value.items():
                    visit(inner, f"{place}/{key}" if place else key)
            elif isinstance(value, list):
                for k, inner in enumerate(value):
                    name = inner.get("name", k) if isinstance(inner, dict) else k
                    visit(inner, f"{place}/{name}")

        visit(self.raw, "")
        return found


def summary(path: Union[str, "os.PathLike[str]"]) -> Summary:
    """Reads a summary.json, or that of a folder. Errors: silt.Error."""
    name = os.fspath(path)
    if os.path.isdir(name):
        name = os.path.join(name, "summary.json")
    try:
        with open(name, encoding="utf-8") as file:
            raw = json.load(file)
    except OSError as error:
        raise cannot_read(name, error) from None
    except ValueError as error:
        raise Error(f"file '{name}' is no JSON, or is cut off: {error}") from None
    if not isinstance(raw, dict):
        raise Error(f"file '{name}' is no summary: it is a list or a number")
    return Summary(name, raw)
