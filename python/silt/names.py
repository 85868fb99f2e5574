# silt - BSD-3-Clause, see LICENSE
"""Names of fields and columns, with or without their units."""

from __future__ import annotations

from typing import Iterable

from .errors import Error

# Of silt's own fields whose names do not say it (docs/contact_data.md, docs/fluid.md, ...).
UNITS = {
    "position": "m", "velocity": "m/s", "angular_velocity": "rad/s", "radius": "m",
    "force": "N", "normal_force": "N", "tangential_force": "N", "shear_force": "N", "overlap": "m",
    "twisting": "N m", "bending": "N m", "load": "-", "energy": "J", "rests_until": "s",
    "pressure": "Pa", "pressure_with_weight": "Pa", "voidage": "-", "temperature": "K",
    "mean_velocity": "m/s", "rms_velocity": "m/s", "mean_superficial_velocity": "m/s",
    "mean_pressure": "Pa", "rms_pressure": "Pa", "mean_pressure_with_weight": "Pa",
    "eddy_viscosity": "Pa s", "turbulent_energy": "m2/s2", "dissipation": "m2/s3",
    "mean_voidage": "-", "mean_temperature": "K", "rms_temperature": "K",
    "solid_fraction": "-", "density": "kg/m3", "granular_temperature": "m2/s2",
    "contact_stress": "Pa", "kinetic_stress": "Pa", "worn depth": "m", "worn volume": "m3",
}  # fmt: skip
AXES = ("x", "y", "z")


def split_unit(name: str) -> tuple[str, str]:
    """'time [s]' -> ('time', 's'); ('time', '') where there is none."""
    word, bracket, unit = name.partition(" [")
    return (word, unit[:-1]) if bracket and unit.endswith("]") else (name, "")


def unit_of(name: str) -> str:
    """The unit of a field or column: in its brackets, else silt's own; '' if unknown."""
    word, unit = split_unit(name)
    return unit or UNITS.get(word, "")


def same(wanted: str, name: str) -> bool:
    """Whether `wanted` means `name`: as it stands, without its unit, or with spaces for '_'."""
    word = split_unit(name)[0]
    return wanted in (name, word) or wanted.replace(" ", "_") == word.replace(" ", "_")


def find_name(wanted: str, names: Iterable[str], what: str, path: str) -> str:
    """The full name that `wanted` means. Errors: names those there are."""
    names = list(names)
    if wanted in names:
        return wanted
    for name in names:
        if same(wanted, name):
            return name
    raise Error(f"file '{path}' has no {what} '{wanted}'; it has: {', '.join(names) or 'none'}")


def find_start(wanted: str, names: Iterable[str], what: str, path: str) -> str:
    """As find_name; else the only name that begins with `wanted`. Errors: names those that do."""
    names = list(names)
    starts = [name for name in names if name.replace("_", " ").startswith(wanted.replace("_", " "))]
    if any(same(wanted, name) for name in names) or not starts or not wanted:
        return find_name(wanted, names, what, path)
    if len(starts) > 1:
        raise Error(f"file '{path}' has {len(starts)} {what}s that begin with '{wanted}': {', '.join(starts)}")
    return starts[0]


def label(word: str, unit: str) -> str:
    """'velocity', 'm/s' -> 'velocity [m/s]'."""
    return f"{word} [{unit}]" if unit else word
