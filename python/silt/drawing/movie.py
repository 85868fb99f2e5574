# silt - BSD-3-Clause, see LICENSE
"""Movies: frames as numbered pictures, .gif by Pillow, .mp4 by ffmpeg."""

from __future__ import annotations

import glob
import os
import re
import shutil
import subprocess
import tempfile
from importlib.util import find_spec

from ..errors import Error
from .style import save

NUMBERED = re.compile(r"%0?\d*d")


def is_movie(path: str) -> bool:
    """Whether a name means a movie: .gif, .mp4, or numbered frames, as frame_%04d.png."""
    return path.lower().endswith((".gif", ".mp4")) or NUMBERED.search(os.path.basename(path)) is not None


class Movie:
    """Takes figures one by one and writes them at the end of a `with` block without an error.
    Errors: silt.Error, at once, where what is needed to write it is not installed."""

    def __init__(self, path: str, fps: float) -> None:
        self.path, self.fps, self.count = path, fps, 0
        self.ending = os.path.splitext(path)[1].lower()
        if self.ending == ".gif" and find_spec("PIL") is None:
            raise Error(f"movie '{path}': this Python has no Pillow, which writes .gif (Debian: apt-get install "
                        "python3-pil); frames need nothing more: -o frame_%04d.png")
        if self.ending == ".mp4" and shutil.which("ffmpeg") is None:
            raise Error(f"movie '{path}': there is no ffmpeg, which writes .mp4 (Debian: apt-get install ffmpeg); "
                        "-o movie.gif or frames, -o frame_%04d.png, need none")
        self.folder = ""

    def __enter__(self) -> "Movie":
        self.folder = tempfile.mkdtemp() if self.ending in (".gif", ".mp4") else ""
        return self

    def add(self, figure) -> None:
        """The next frame."""
        save(figure, os.path.join(self.folder, "%06d.png") % self.count if self.folder else self.path % self.count)
        self.count += 1

    def __exit__(self, kind, error, trace) -> None:
        try:
            if kind is None and self.folder:
                self._write_gif() if self.ending == ".gif" else self._write_mp4()
        finally:
            if self.folder:
                shutil.rmtree(self.folder, ignore_errors=True)

    def _write_gif(self) -> None:
        from PIL import Image

        frames = []  # palettes by coverage, so that white is white; Floyd and Steinberg between colours
        for name in sorted(glob.glob(os.path.join(self.folder, "*.png"))):
            with Image.open(name) as image:
                full = image.convert("RGB")
                frames.append(full.quantize(palette=full.quantize(255, method=1), dither=3))
        partial = self.path + ".partial"
        try:
            frames[0].save(partial, format="GIF", save_all=True, append_images=frames[1:], loop=0,
                           duration=max(20, round(1000 / self.fps)))
            os.replace(partial, self.path)
        except OSError as error:
            raise Error(f"file '{self.path}' cannot be written: {error.strerror or error}") from None

    def _write_mp4(self) -> None:
        done = subprocess.run(["ffmpeg", "-y", "-loglevel", "error", "-framerate", f"{self.fps:g}", "-i",
                               os.path.join(self.folder, "%06d.png"), "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                               "-pix_fmt", "yuv420p", self.path], capture_output=True, text=True)
        if done.returncode:
            raise Error(f"movie '{self.path}' cannot be written: ffmpeg says: {done.stderr.strip().splitlines()[-1:]}")
