# silt - BSD-3-Clause, see LICENSE
"""A picture of spheres, triangles, walls and lines, computed by numpy for many bodies at once.

Coordinates are (right, up, towards the viewer). Nearest wins, pixel by pixel: the canvas keeps the
depth of what it shows. Lengths of pixels count supersampled ones.
"""

from __future__ import annotations

from typing import Optional, Sequence

import numpy as np

SUPERSAMPLING = 2
LIGHT = np.array([-0.35, 0.50, 0.79], np.float32)
WALL = np.array([0.88, 0.91, 0.95], np.float32)
EDGE = 0.30
VEIL = 0.25  # share of an edge's colour where it passes in front of grains
GLASS = 0.30  # share of a see-through wall's colour
GLASS_OVER = 0.10  # where it passes in front of grains: their colours must still be those of the colour bar


def expand(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of each group of `counts` its number, and the place in it: [0 0 1 1 1], [0 1 0 1 2]."""
    group = np.repeat(np.arange(len(counts)), counts)
    return group, np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)


def area(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Twice that of the triangle between two vectors of the plane, by row."""
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]


class Canvas:
    """A picture `width` pixels wide of the rectangle `bounds` (left, right, bottom, top) [m].

    Without `eye` the projection is parallel. With `eye`, a place (right, up, towards the viewer) [m],
    it is in perspective, and `bounds` are seen in the plane at `plane` [m] towards the viewer.
    """

    def __init__(self, bounds: Sequence[float], width: int, eye: Optional[Sequence[float]] = None,
                 plane: float = 0) -> None:
        self.left, right, self.bottom, top = bounds
        self.width = width * SUPERSAMPLING
        self.scale = self.width / (right - self.left)
        rows = round((top - self.bottom) * self.scale / SUPERSAMPLING)
        self.height = SUPERSAMPLING * max(1, rows)
        self.depth = np.full((self.height, self.width), -np.inf, np.float32)
        self.image = np.ones((self.height, self.width, 3), np.float32)
        self.eye = None if eye is None else np.asarray(eye, float)
        self.slack = 0.004 * self.width
        self.reach = 0.0 if self.eye is None else self.eye[2] - plane  # [m] from the eye to the plane

    def to_pixels(self, projected: np.ndarray) -> np.ndarray:
        """Columns, rows, depths (greater is nearer; planes have linear ones); nan behind the eye."""
        if self.eye is None:
            return (projected[..., :3] - [self.left, self.bottom, 0]) * self.scale
        away = self.eye - projected[..., :3]
        away[..., 2] = np.where(away[..., 2] > 0, away[..., 2], np.nan)
        shrink = self.reach / away[..., 2]
        return np.stack([(self.eye[0] - self.left - away[..., 0] * shrink) * self.scale,
                         (self.eye[1] - self.bottom - away[..., 1] * shrink) * self.scale,
                         self.reach * (shrink - 1) * self.scale], axis=-1)

    # ------------------------------------------------------------------------------ spheres

    def draw_spheres(self, projected: np.ndarray, radii: np.ndarray, colours: np.ndarray) -> None:
        """Shaded spheres: centres (n, 3) and radii (n,) [m], colours (n, 3) from 0 to 1."""
        places, radii = np.asarray(projected, float), np.asarray(radii, float)
        owner = self._front_spheres(places, radii)
        seen = np.flatnonzero(owner.reshape(-1) >= 0)
        if len(seen) == 0:
            return
        near, far = np.percentile(self.depth.reshape(-1)[seen[::1 + len(seen) // 100_000]], [99, 1])
        self.slack = 0.25 * float(np.median(radii)) * self.scale
        fade = max(near - far, 12 * float(np.median(radii)) * self.scale)
        colours = np.asarray(colours, np.float32)
        for some in np.array_split(seen, 1 + len(seen) // 1_000_000):
            who = owner.reshape(-1)[some]
            n, facing = self._normals(places[who], radii[who], some % self.width, some // self.width)
            shade = 0.42 + 0.58 * np.clip(n @ LIGHT, 0, 1)
            shade *= 0.70 + 0.30 * np.minimum(1, facing / 0.45)  # a dark rim parts neighbours
            depth = self.depth.reshape(-1)[some]
            shade *= 1 - 0.30 * np.clip((near - depth) / fade, 0, 1)
            self.image.reshape(-1, 3)[some] = np.clip(colours[who] * shade[:, None], 0, 1)

    def _rays(self, columns: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Per metre away from the eye, how far right and up the middles of pixels lie."""
        focal = self.scale * self.reach
        return ((columns + 0.5) - (self.eye[0] - self.left) * self.scale) / focal, \
            ((rows + 0.5) - (self.eye[1] - self.bottom) * self.scale) / focal

    def _hit(self, places, radii, columns, rows):
        """Where the line of sight of a pixel meets its sphere: right, up, towards the viewer, relative to
        its centre [m], and whether it does; where not, the outline."""
        if self.eye is None:
            dx = (columns + 0.5) / self.scale + self.left - places[:, 0]
            dy = (rows + 0.5) / self.scale + self.bottom - places[:, 1]
            rest = radii * radii - dx * dx - dy * dy
            return dx, dy, np.sqrt(np.maximum(rest, 0)), rest >= 0
        u, v = self._rays(columns, rows)
        x, y, z = places[:, 0] - self.eye[0], places[:, 1] - self.eye[1], self.eye[2] - places[:, 2]
        square, along = u * u + v * v + 1, u * x + v * y + z
        rest = along * along - square * (x * x + y * y + z * z - radii * radii)
        away = (along - np.sqrt(np.maximum(rest, 0))) / square
        return away * u - x, away * v - y, z - away, rest >= 0

    def _normals(self, places, radii, columns, rows) -> tuple[np.ndarray, np.ndarray]:
        """Unit normals, and how much they face the viewer."""
        x, y, z, _ = self._hit(places, radii, columns, rows)
        n = np.stack([x, y, z], axis=1)
        n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        if self.eye is None:
            return n.astype(np.float32), n[:, 2]
        u, v = self._rays(columns, rows)
        facing = (n[:, 2] - u * n[:, 0] - v * n[:, 1]) / np.sqrt(u * u + v * v + 1)
        return n.astype(np.float32), np.clip(facing, 0, 1)

    def _boxes(self, places, radii) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What spheres may cover: least and greatest column and row, and their nearest depth; nan of
        those that the eye is in or before."""
        if self.eye is None:
            middle = self.to_pixels(places)
            r = np.maximum(radii * self.scale, 0.71)[:, None]  # a dot at least
            return middle[:, :2] - r, middle[:, :2] + r, middle[:, 2] + radii * self.scale
        z = self.eye[2] - places[:, 2]
        focal = self.scale * self.reach
        ends = []
        with np.errstate(invalid="ignore", divide="ignore"):
            z = np.where(z > radii, z, np.nan)
            for axis in (0, 1):
                across = places[:, axis] - self.eye[axis]
                turn, half = np.arctan2(across, z), np.arcsin(radii / np.hypot(across, z))
                start = (self.eye[axis] - (self.left, self.bottom)[axis]) * self.scale
                least, most = (start + focal * np.tan(turn + side * half) for side in (-1, 1))
                middle, dot = 0.5 * (least + most), np.maximum(0.5 * (most - least), 0.71)
                ends.append((middle - dot, middle + dot))
            nearest = self.reach * (self.reach / (z - radii) - 1) * self.scale
        return np.stack([ends[0][0], ends[1][0]], 1), np.stack([ends[0][1], ends[1][1]], 1), nearest

    def _front_spheres(self, places, radii, portion: int = 1_000_000) -> np.ndarray:
        """Which sphere is seen at each pixel, or -1; sets its depth. Near-to-far in portions of about so
        many pixels; spheres behind what nearer portions have covered are skipped."""
        owner = np.full(self.depth.shape, -1, np.int32)
        low, high, nearest = self._boxes(places, radii)
        size = [self.width, self.height]
        with np.errstate(invalid="ignore"):
            inside = np.isfinite(nearest) & (high > 0).all(axis=1) & (low < size).all(axis=1)
        order = np.flatnonzero(inside)
        order = order[np.argsort(-nearest[order], kind="stable")]
        ends = np.cumsum(np.prod(np.clip(high[order], 0, size) - np.clip(low[order], 0, size), axis=1) + 2)
        start = 0
        while start < len(order):
            before = ends[start - 1] if start > 0 else 0
            stop = max(start + 1, int(np.searchsorted(ends, before + portion)))
            some = order[start:stop]
            start = stop
            some = some[~self.is_hidden(self.depth, low[some], high[some], nearest[some])]
            self._stamp(owner, some, places[some], radii[some], low[some], high[some])
        return owner

    def _stamp(self, owner, names, places, radii, low, high) -> None:
        """The pixels whose middles spheres cover, row by row; of tiny ones the one that they are in."""
        first = np.clip(np.ceil(low - 0.5), 0, [self.width, self.height]).astype(int)
        last = np.clip(np.floor(high - 0.5) + 1, 0, [self.width, self.height]).astype(int)
        ball, down = expand(np.maximum(last[:, 1] - first[:, 1], 0))
        row = first[ball, 1] + down
        left, right = first[ball, 0], last[ball, 0]
        if self.eye is None:  # the chord of each row
            middle = (low + high)[ball] / 2
            half = (high - low)[ball, 0] / 2
            chord = np.sqrt(np.maximum(half * half - (row + 0.5 - middle[:, 1]) ** 2, 0))
            left = np.maximum(left, np.ceil(middle[:, 0] - chord - 0.5).astype(int))
            right = np.minimum(right, np.floor(middle[:, 0] + chord - 0.5).astype(int) + 1)
        span, along = expand(np.maximum(right - left, 0))
        who, column, row = ball[span], left[span] + along, row[span]
        _, _, z, meets = self._hit(places[who], radii[who], column, row)
        keep = meets | ((high - low)[who] < 1.5).any(axis=1)
        who, column, row, z = who[keep], column[keep], row[keep], (places[who, 2] + z)[keep]
        depth = z * self.scale if self.eye is None else \
            self.reach * (self.reach / (self.eye[2] - z) - 1) * self.scale
        self._nearest(self.depth, owner, row * self.width + column, depth.astype(np.float32),
                      names.astype(np.int32)[who])

    @staticmethod
    def _nearest(depth, owner, at, z, names) -> None:
        """Puts pixels `at` of depths `z` where they are nearer than what is there."""
        flat_depth, flat_owner = depth.reshape(-1), owner.reshape(-1)
        while len(at) > 0:  # of several at one pixel any is first, until none is nearer
            nearer = z > flat_depth[at]
            at, z, names = at[nearer], z[nearer], names[nearer]
            flat_depth[at] = z
            flat_owner[at] = names

    # ---------------------------------------------------------------------------- triangles

    def draw_triangles(self, projected, triangles, normals, colours):
        """Closed surfaces of bodies: points, triangles whose corners run anticlockwise as seen from
        outside, the unit normals (n, 3, 3) of their corners, and the colours of the points."""
        corners = self.to_pixels(projected)[triangles]
        owner = self.front_triangles(corners, self.depth)
        seen = np.flatnonzero(owner.reshape(-1) >= 0)
        if len(seen) == 0:
            return
        near, far = np.percentile(self.depth.reshape(-1)[seen[::1 + len(seen) // 100_000]], [99, 1])
        colours = colours.astype(np.float32)
        for some in np.array_split(seen, 1 + len(seen) // 1_000_000):
            who = owner.reshape(-1)[some]
            a, b, c = (corners[who, k, :2] for k in range(3))
            x = np.stack([some % self.width + 0.5, some // self.width + 0.5], axis=1)
            whole = area(b - a, c - a)
            at_b, at_c = area(x - a, c - a) / whole, area(b - a, x - a) / whole
            n = ((1 - at_b - at_c)[:, None] * normals[who, 0] + at_b[:, None] * normals[who, 1] +
                 at_c[:, None] * normals[who, 2]).astype(np.float32)
            n /= np.sqrt(np.maximum((n * n).sum(axis=1, keepdims=True), 1e-12))
            shade = 0.42 + 0.58 * np.clip(n @ LIGHT, 0, 1)
            shade *= 0.70 + 0.30 * np.clip(n[:, 2] / 0.35, 0, 1)
            depth = self.depth.reshape(-1)[some]
            shade *= 1 - 0.30 * np.clip((near - depth) / max(near - far, 1), 0, 1)
            colour = colours[triangles[who, 0]] * shade[:, None]
            self.image.reshape(-1, 3)[some] = np.clip(colour, 0, 1)

    def front_triangles(self, corners, depth, portion=1_000_000):
        """Which triangle is the nearest of those at each pixel's middle, or -1; `depth` is that of
        what is there, and becomes that of the nearest.

        Near-to-far in portions of about so many pixels; triangles behind what nearer portions have
        covered are skipped.
        """
        owner = np.full(depth.shape, -1, np.int32)
        nearest, low, high = corners[:, :, 2].max(axis=1), corners[:, :, :2].min(axis=1), \
            corners[:, :, :2].max(axis=1)
        inside = np.isfinite(corners).all(axis=(1, 2))
        inside &= (high > 0).all(axis=1) & (low < [self.width, self.height]).all(axis=1)
        order = np.flatnonzero(inside)
        order = order[np.argsort(-nearest[order], kind="stable")]
        size = [self.width, self.height]
        extent = np.clip(high[order], 0, size) - np.clip(low[order], 0, size)
        ends = np.cumsum(0.5 * extent.prod(axis=1) + 2)  # pixels and some work a triangle
        start = 0
        while start < len(order):
            before = ends[start - 1] if start > 0 else 0
            stop = max(start + 1, np.searchsorted(ends, before + portion))
            some = order[start:stop]
            start = stop
            some = some[~self.is_hidden(depth, low[some], high[some], nearest[some])]
            self.fill(owner, depth, some, corners[some])
        return owner

    @staticmethod
    def is_hidden(depth, low, high, nearest, blocks=(16, 64, 256)):
        """Whether all that boxes of pixels show is nearer than what would come there."""
        hidden = np.zeros(len(low), bool)
        farthest, side = depth, 1
        for block in blocks:  # a box is looked up where it touches four blocks at most
            for axis in (0, 1):
                starts = np.arange(0, farthest.shape[axis], block // side)
                farthest = np.minimum.reduceat(farthest, starts, axis)
            side = block
            last = [farthest.shape[1] - 1, farthest.shape[0] - 1]
            (x0, y0), (x1, y1) = (np.clip(np.floor(end / block), 0, last).astype(int).T
                                  for end in (low, high))
            small = (x1 - x0 <= 1) & (y1 - y0 <= 1)
            hidden |= small & (nearest < np.minimum(np.minimum(farthest[y0, x0], farthest[y0, x1]),
                                                    np.minimum(farthest[y1, x0], farthest[y1, x1])))
        return hidden

    def fill(self, owner, depth, names, corners):
        """The pixels whose middles triangles cover, row by row."""
        if len(names) == 0:
            return
        order = np.argsort(corners[:, :, 1], axis=1)
        a, b, c = np.take_along_axis(corners, order[:, :, None], axis=1).transpose(1, 0, 2)
        first = np.clip(np.ceil(a[:, 1] - 0.5), 0, self.height).astype(int)
        rows = np.clip(np.ceil(c[:, 1] - 0.5), 0, self.height).astype(int) - first
        tri, down = expand(rows)
        row = first[tri] + down
        y = row + 0.5

        def slope(p, q):
            tall = q[:, 1] - p[:, 1]
            return (q[:, 0] - p[:, 0]) / np.where(tall > 0, tall, 1)

        ac, ab, bc = slope(a, c), slope(a, b), slope(b, c)
        along = a[tri, 0] + ac[tri] * (y - a[tri, 1])
        other = np.where(y < b[tri, 1], a[tri, 0] + ab[tri] * (y - a[tri, 1]),
                         b[tri, 0] + bc[tri] * (y - b[tri, 1]))
        left = np.clip(np.ceil(np.minimum(along, other) - 0.5), 0, self.width).astype(int)
        right = np.clip(np.ceil(np.maximum(along, other) - 0.5), 0, self.width).astype(int)
        n = np.cross(b - a, c - a)
        steep = np.where(n[:, 2] != 0, n[:, 2], np.inf)
        dz_dx, dz_dy = -n[:, 0] / steep, -n[:, 1] / steep
        z = a[tri, 2] + dz_dx[tri] * (left + 0.5 - a[tri, 0]) + dz_dy[tri] * (y - a[tri, 1])
        # A sliver's plane says little about its depth: it stays between its corners.
        least, most = corners[:, :, 2].min(axis=1), corners[:, :, 2].max(axis=1)
        span, along = expand(np.maximum(right - left, 0))
        who = tri[span]
        z = np.clip(z[span] + dz_dx[who] * along, least[who], most[who]).astype(np.float32)
        at = row[span] * self.width + left[span] + along
        self._nearest(depth, owner, at, z, names.astype(np.int32)[who])

    def draw_flat(self, corners: np.ndarray, colours: np.ndarray) -> None:
        """Triangles (n, 3, 3) of colours (n, 3) without light or shade: slices of fields."""
        owner = self.front_triangles(self.to_pixels(corners), self.depth)
        seen = owner >= 0
        self.image[seen] = colours[owner[seen]]

    # -------------------------------------------------------------------------------- walls

    def _wall_shades(self, corners: np.ndarray) -> np.ndarray:
        """Brightness of triangles, the same from both sides."""
        n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        n *= np.where(n[:, 2:] < 0, -1, 1)
        return (0.84 + 0.20 * np.clip(n @ LIGHT, 0, 1)).astype(np.float32)

    def draw_walls(self, corners: np.ndarray) -> None:
        """Triangles (n, 3, 3) of walls where there are no grains: the farthest at each pixel. Walls
        in front of grains are left out."""
        behind = np.full(self.depth.shape, -np.inf, np.float32)
        owner = self.front_triangles(self.to_pixels(corners) * [1, 1, -1], behind)
        shade = self._wall_shades(corners)
        free = (owner >= 0) & ~np.isfinite(self.depth)
        self.image[free] = np.clip(WALL * shade[owner[free], None], 0, 1)

    def draw_solid_walls(self, corners: np.ndarray) -> None:
        """Walls that hide what is behind them."""
        owner = self.front_triangles(self.to_pixels(corners), self.depth)
        seen = owner >= 0
        shade = self._wall_shades(corners)[owner[seen]] ** 3
        self.image[seen] = np.clip(WALL * shade[:, None], 0, 1)

    def draw_glass_walls(self, corners: np.ndarray) -> None:
        """Walls as draw_walls() has them, and the nearest of those that nothing hides as a veil. Bodies
        overlap walls that they press on: what stands out by up to `slack` is veiled, too."""
        self.draw_walls(corners)
        front = self.depth - np.float32(self.slack)
        owner = self.front_triangles(self.to_pixels(corners), front)
        seen = owner >= 0
        tint = 0.75 * WALL * self._wall_shades(corners)[owner[seen]][:, None] ** 3
        share = np.where(np.isfinite(self.depth[seen]), GLASS_OVER, GLASS).astype(np.float32)[:, None]
        self.image[seen] += share * (tint - self.image[seen])

    # -------------------------------------------------------------------------------- lines

    def draw_lines(self, segments):
        """Lines where no grain is; faint where they pass in front of one."""
        ends = self.to_pixels(segments)
        ends = ends[np.isfinite(ends).all(axis=(1, 2))]
        length = np.abs(ends[:, 1, :2] - ends[:, 0, :2]).max(axis=1)
        steps = np.ceil(2 * np.minimum(length, 4 * self.width)).astype(int) + 1
        which = np.repeat(np.arange(len(ends)), steps)
        count = np.arange(len(which)) - np.repeat(np.cumsum(steps) - steps, steps)
        part = (count / np.maximum(steps[which] - 1, 1))[:, None]
        points = ends[which, 0] + part * (ends[which, 1] - ends[which, 0])
        column, row = np.floor(points[:, :2]).astype(int).T
        # Lines lie on walls, which grains touch: half a pixel decides nothing.
        share = np.zeros((self.height, self.width), np.float32)
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                x, y = column + dx, row + dy
                ok = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
                x, y = x[ok], y[ok]
                seen = points[ok, 2] >= self.depth[y, x] - 1
                share[y[seen], x[seen]] = 1
        share[np.isfinite(self.depth)] *= VEIL
        rows, columns = np.nonzero(share)
        part = share[rows, columns, None]
        self.image[rows, columns] += part * (EDGE - self.image[rows, columns])

    def size(self) -> tuple[int, int]:
        """Width and height of the picture in pixels."""
        return self.width // SUPERSAMPLING, self.height // SUPERSAMPLING

    def picture(self):
        n = SUPERSAMPLING
        small = self.image.reshape(self.height // n, n, self.width // n, n, 3).mean(axis=(1, 3))
        return small[::-1]
