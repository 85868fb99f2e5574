# silt - BSD-3-Clause, see LICENSE
"""The command line: draw, curves, cells, compare, info."""

from __future__ import annotations

import argparse
import sys
from typing import NoReturn, Sequence

from .errors import Error

ABOUT = """Reads, draws and compares what silt writes.

  silt draw out/vtk/particles.pvd --colour velocity -o bed.png
  silt draw out/vtk/particles.pvd --view iso --perspective -o bed.gif
  silt draw contacts.vtp --slab y=0.04,0.06 -o chains.png
  silt draw out/vtk/flow.pvd --slice y=0.05 --colour velocity -o flow.png
  silt curves energy.csv --x time --y kinetic,potential -o energy.png
  silt cells early.csv late.csv --value voidage -o voidage.png
  silt compare out/first out/second --tolerance 1e-9
  silt info out/vtk/particles.pvd

A wrong argument or file ends in one sentence on stderr and status 2; `compare` ends with 1 where what
it compares differs. `silt NAME --help` lists the options."""


class Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise Error(message + "; see --help")


def add_out(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--out", required=True, metavar="PNG")
    parser.add_argument("--title")


def make_parser(pictures: bool) -> Parser:
    """`pictures`: with the commands that draw, which import matplotlib."""
    parser = Parser(prog="silt", description=ABOUT, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, metavar="draw|curves|cells|compare|info", dest="command")
    draw = commands.add_parser("draw", help="particles, bodies, walls, contacts, bonds, slices of flows; movies")
    curves = commands.add_parser("curves", help="columns of tables over another column")
    cells = commands.add_parser("cells", help="a field on the cells of a plane, several tables side by side")
    compare = commands.add_parser("compare", help="differences of two outputs, field by field")
    info = commands.add_parser("info", help="what is in a file, a series or a folder")

    compare.add_argument("a", metavar="A", help="a series, a file, a table, a summary.json, or a folder")
    compare.add_argument("b", metavar="B", help="the other one")
    compare.add_argument("--tolerance", type=float, default=0.0, metavar="T",
                         help="largest difference allowed [-], over the largest value of the field (0)")
    compare.add_argument("--absolute", type=float, default=0.0, metavar="D",
                         help="differences up to this are allowed besides, in the field's unit (0)")
    compare.add_argument("--fields", metavar="NAME,NAME", help="only these fields or columns")
    compare.add_argument("--ignore", metavar="NAME,NAME", help="leave out these fields, columns or numbers")
    compare.add_argument("--common", action="store_true",
                         help="compare only times, particles, rows, fields and files that both have, and say what is left out")
    compare.set_defaults(run=_compare)
    info.add_argument("files", nargs="+", metavar="FILE")
    info.set_defaults(run=_info)
    if not pictures:
        return parser

    from .drawing import cells as cells_module
    from .drawing import curves as curves_module
    from .drawing import scene
    from .drawing.style import COLOUR_MAPS

    scene.add_options(draw)
    draw.set_defaults(run=scene.run)
    curves.add_argument("files", nargs="+", metavar="FILE.csv", help="several: in one picture, a colour a file")
    curves.add_argument("--labels", nargs="+", metavar="T", help="what the files are called (their names)")
    curves.add_argument("--x", required=True, metavar="COLUMN", help="with or without its unit")
    curves.add_argument("--y", required=True, metavar="COLUMN[,COLUMN]",
                        help="with or without its unit, or how only its name begins")
    curves.add_argument("--marks", metavar="COLUMN[,COLUMN]",
                        help="points without a line, in the colours of the columns of --y in turn")
    curves.add_argument("--marks-label", metavar="T", default="measured", help="what the points are called")
    curves.add_argument("--x-label", metavar="T", help="what the x axis is called; its unit is added, or T has a "
                        "larger or smaller one, as 'size [mm]' of a column in m: numbers are converted")
    curves.add_argument("--y-label", metavar="T", help="what all columns of --y are, as with --x-label")
    curves.add_argument("--log", choices=["x", "y", "xy"], default="", help="logarithmic axes")
    curves.add_argument("--reference", action="append", metavar="LABEL:SLOPE,OFFSET",
                        help="a straight line to compare with; may be repeated")
    add_out(curves)
    curves.set_defaults(run=curves_module.draw_curves)
    cells.add_argument("files", nargs="+", metavar="FILE.csv",
                       help="a row a cell: its middle across and upwards [m], then fields")
    cells.add_argument("--value", required=True, metavar="COLUMN", help="with or without its unit")
    cells.add_argument("--range", metavar="LOW,HIGH", help="values at the ends of the colour bar")
    cells.add_argument("--map", choices=sorted(COLOUR_MAPS), default="viridis", help="colours (viridis)")
    cells.add_argument("--title", nargs="+", metavar="T", help="a caption for each file")
    cells.add_argument("-o", "--out", required=True, metavar="PNG")
    cells.add_argument("--least", metavar="COLUMN=VALUE", help="cells with less of it stay white, and so do lone ones "
                       "(at most one neighbour of four has enough)")
    cells.add_argument("--walls", metavar="FILE", help="a surface: lines where the plane of the cells cuts it")
    cells.set_defaults(run=cells_module.draw_cells)
    return parser


# Values such as -0.1,0.1,0,1 begin like an option: they are joined to theirs.
SIGNED = ("--bounds", "--range", "--flow-range", "--view")


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in SIGNED and argument.startswith("-"):
            joined[-1] += "=" + argument
        else:
            joined.append(argument)
    return make_parser(arguments[:1] not in (["info"], ["compare"])).parse_args(joined)


def _compare(options: argparse.Namespace) -> int:
    from .comparison import run

    return run(options)


def _info(options: argparse.Namespace) -> int:
    from .info import describe

    for k, name in enumerate(options.files):
        print(("\n" if k else "") + describe(name))
    return 0


def run(arguments: Sequence[str]) -> int:
    try:
        options = parse(arguments)
        return options.run(options) or 0
    except Error as error:
        sys.stderr.write(f"silt: {error}\n")
        return 2
