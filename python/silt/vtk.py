# silt - BSD-3-Clause, see LICENSE
"""VTK's XML files: their header at once, their arrays one by one when they are asked for.

silt writes arrays as appended raw data with lengths of 64 bits. What ParaView saves of them is read
too: ascii, base64 (inline or appended), compressed by zlib, lengths of 32 bits.
"""

from __future__ import annotations

import base64
import os
import xml.etree.ElementTree as ElementTree
import zlib
from dataclasses import dataclass
from typing import Optional

import numpy as np

from .errors import Error, cannot_read

TYPES = {"Float64": "f8", "Float32": "f4", "Int8": "i1", "UInt8": "u1", "Int16": "i2",
         "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8"}  # fmt: skip
APPENDED = b"<AppendedData"


@dataclass
class ArrayHead:
    """What the header says of one array."""

    name: str
    type: np.dtype
    components: int
    format: str
    offset: int  # [bytes] behind the mark '_', of appended ones
    text: str  # of those that stand in the header


class VtkFile:
    """The header of one file, and its arrays on demand.

    `kind`: VTK's word (PolyData, ImageData, ...); `about`: the attributes of its data set; `piece`:
    those of its only piece; `sections`: arrays by section (Points, PointData, Polys, ...) and name.
    Errors: silt.Error for a file that is missing, no VTK file, of a kind that is not read, or cut
    off, as a run that was killed or a full disk leaves it.
    """

    def __init__(self, path: str) -> None:
        self.path = path
        head, self._data_at, self._base64 = self._read_head()
        root = self._parse(head)
        if not self.is_whole:
            raise Error(f"file '{path}' is cut off before its end; the run that wrote it was killed, or the disk "
                        "was full")
        self.kind = root.get("type", "")
        data_set = root.find(self.kind)
        if root.tag != "VTKFile" or data_set is None:
            raise self._foreign()
        self.about = dict(data_set.attrib)
        self.byte_order = ">" if root.get("byte_order") == "BigEndian" else "<"
        self._length = np.dtype(self.byte_order + TYPES.get(root.get("header_type", "UInt32"), "u4"))
        compressor = root.get("compressor", "")
        if compressor not in ("", "vtkZLibDataCompressor"):
            raise Error(f"file '{path}' is compressed by {compressor}, which is not read; save it "
                        "with zlib or without compression")
        self._compressed = compressor != ""
        pieces = data_set.findall("Piece")
        self.sources = [p.get("Source", "") for p in pieces] if self.kind.startswith("P") else []
        if self.kind == "PolyData":
            self.sources = []
        if not self.sources and len(pieces) > 1:
            raise Error(f"file '{path}' has {len(pieces)} pieces in one file, which is not read; "
                        "save each as a file of its own")
        self.piece = dict(pieces[0].attrib) if pieces else {}
        self.sections: dict[str, dict[str, ArrayHead]] = {}
        for section in pieces[0] if pieces and not self.sources else []:
            arrays = [self._array_head(element) for element in section.iter("DataArray")]
            self.sections[section.tag] = {array.name: array for array in arrays}

    # ------------------------------------------------------------------------------ header

    def _read_head(self) -> tuple[bytes, int, bool]:
        """The XML before the appended data, and where this begins."""
        try:
            with open(self.path, "rb") as file:
                size = file.seek(0, os.SEEK_END)
                file.seek(max(0, size - 100))
                self.is_whole = file.read().rstrip().endswith(b"</VTKFile>")
                file.seek(0)
                content = b""
                while APPENDED not in content:
                    block = file.read(1 << 16)
                    if not block:
                        return content, -1, False
                    content += block
                at = content.index(APPENDED)
                while b"_" not in content[content.find(b">", at):] or b">" not in content[at:]:
                    block = file.read(64)
                    if not block:
                        raise Error(f"file '{self.path}' is cut off where its data should begin; the "
                                    "run that wrote it was killed, or the disk was full")
                    content += block
        except OSError as error:
            raise cannot_read(self.path, error) from None
        end = content.index(b">", at)
        return content[:at], content.index(b"_", end) + 1, b"base64" in content[at:end]

    def _parse(self, head: bytes) -> ElementTree.Element:
        try:
            return ElementTree.fromstring(head + (b"</VTKFile>" if self._data_at >= 0 else b""))
        except ElementTree.ParseError:
            if head.lstrip().startswith((b"<?xml", b"<VTKFile")):
                raise Error(f"file '{self.path}' is cut off in its header; the run that wrote it was "
                            "killed, or the disk was full") from None
            if not head.strip():
                raise Error(f"file '{self.path}' is empty; the run that wrote it was killed, or the disk was "
                            "full") from None
            raise self._foreign() from None

    def _foreign(self) -> Error:
        return Error(f"file '{self.path}' is no VTK file in XML, as silt writes them (.vtp, .vti)")

    def _array_head(self, element: ElementTree.Element) -> ArrayHead:
        name = element.get("Name", "")
        kind = element.get("type", "")
        try:
            number = np.dtype(self.byte_order + TYPES[kind])
            components = int(element.get("NumberOfComponents", "1"))
            offset = int(element.get("offset", "0"))
        except (KeyError, ValueError):
            raise Error(f"file '{self.path}' has an array '{name}' of type '{kind}', which is not read; "
                        f"numbers are of {', '.join(TYPES)}") from None
        return ArrayHead(name, number, components, element.get("format", "ascii"), offset,
                         element.text or "")

    # ------------------------------------------------------------------------------ arrays

    def array(self, section: str, name: str) -> np.ndarray:
        """One array, (n,) or (n, components), read now."""
        head = self.sections[section][name]
        if head.format == "ascii":
            try:
                values = np.array(head.text.split(), dtype=head.type)
            except ValueError:
                raise Error(f"file '{self.path}' has words that are no numbers in its array "
                            f"'{name}'") from None
        else:
            raw = (self._decode(head.text.strip().encode(), name) if head.format == "binary" else
                   self._appended(head))
            if len(raw) % head.type.itemsize:
                raise self._cut_off(name)
            values = np.frombuffer(raw, head.type)
        values = values.astype(head.type.newbyteorder("="), copy=False)
        if len(values) % head.components:
            raise self._cut_off(name)
        return values.reshape(-1, head.components) if head.components > 1 else values

    def _cut_off(self, name: str) -> Error:
        return Error(f"file '{self.path}' is cut off in its array '{name}'; the run that wrote it was "
                     "killed, or the disk was full")

    def _appended(self, head: ArrayHead) -> bytes:
        if self._data_at < 0:
            raise self._cut_off(head.name)
        try:
            with open(self.path, "rb") as file:
                size = os.fstat(file.fileno()).st_size
                file.seek(self._data_at + head.offset)
                if self._base64:
                    return self._decode(file.read().split(b"<")[0], head.name)
                if self._compressed:
                    return self._inflate(file.read, head.name)
                count = int.from_bytes(file.read(self._length.itemsize), self._order())
                if file.tell() + count > size:
                    raise self._cut_off(head.name)
                return file.read(count)
        except OSError as error:
            raise cannot_read(self.path, error) from None

    def _order(self) -> str:
        return "little" if self.byte_order == "<" else "big"

    def _inflate(self, read, name: str) -> bytes:
        """Blocks by zlib: their number, size, size of the last, compressed sizes, blocks."""
        item = self._length.itemsize
        start = np.frombuffer(read(3 * item), self._length)
        if len(start) < 3:
            raise self._cut_off(name)
        sizes = np.frombuffer(read(int(start[0]) * item), self._length)
        try:
            return b"".join(zlib.decompress(read(int(size))) for size in sizes)
        except zlib.error:
            raise self._cut_off(name) from None

    def _decode(self, words: bytes, name: str) -> bytes:
        """Base64: the length and the data in one piece; compressed, the head in a piece of its own."""
        item = self._length.itemsize
        try:
            if not self._compressed:
                count = int.from_bytes(base64.b64decode(words[:4 * -(-item // 3)])[:item], self._order())
                raw = base64.b64decode(words[:4 * -(-(item + count) // 3)])[item:item + count]
                if len(raw) < count:
                    raise self._cut_off(name)
                return raw
            blocks = int.from_bytes(base64.b64decode(words[:4 * -(-item // 3)])[:item], self._order())
            head = 4 * -(-(3 + blocks) * item // 3)
            whole = base64.b64decode(words[:head])[:(3 + blocks) * item]
            sizes = np.frombuffer(whole, self._length)[3:]
            whole += base64.b64decode(words[head:head + 4 * -(-int(sizes.sum()) // 3)])
        except ValueError:
            raise self._cut_off(name) from None
        at = 0

        def read(count: int) -> bytes:
            nonlocal at
            at += count
            return whole[at - count:at]

        return self._inflate(read, name)

    def number(self, of: str, default: int = 0) -> int:
        """A count that the piece says, as NumberOfPoints."""
        try:
            return int(self.piece.get(of, default))
        except ValueError:
            raise self._foreign() from None


def read_extent(words: Optional[str], path: str) -> tuple[int, int, int]:
    """Cells of an image in x, y and z."""
    try:
        ends = [int(word) for word in (words or "").split()]
        return ends[1] - ends[0], ends[3] - ends[2], ends[5] - ends[4]
    except (ValueError, IndexError):
        raise Error(f"file '{path}' is an image without a readable extent") from None
