# silt - BSD-3-Clause, see LICENSE
"""The picture behind draw.py: spheres, triangles, walls and lines in parallel projection.

Coordinates are (right, up, towards the viewer). Nearest wins, pixel by pixel: the canvas keeps the
depth of what it shows. Everything is computed for many bodies at once by numpy.
"""

import numpy as np

SUPERSAMPLING = 2
LIGHT = np.array([-0.35, 0.50, 0.79], np.float32)
WALL = np.array([0.88, 0.91, 0.95], np.float32)  # a wall behind the grains
EDGE = 0.30
VEIL = 0.25  # share of an edge's colour where it passes in front of grains


def expand(counts):
    """Of each group of `counts` its number, and the place in it: [0 0 1 1 1], [0 1 0 1 2]."""
    group = np.repeat(np.arange(len(counts)), counts)
    return group, np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)


def area(p, q):
    """Twice that of the triangle between two vectors of the plane, by row."""
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]


class Canvas:
    """A picture of spheres and lines in parallel projection; lengths in (supersampled) pixels."""

    def __init__(self, bounds, width):
        self.left, right, self.bottom, top = bounds
        self.width = width * SUPERSAMPLING
        self.scale = self.width / (right - self.left)
        rows = round((top - self.bottom) * self.scale / SUPERSAMPLING)
        self.height = SUPERSAMPLING * max(1, rows)
        self.depth = np.full((self.height, self.width), -np.inf, np.float32)
        self.image = np.ones((self.height, self.width, 3), np.float32)

    def to_pixels(self, projected):
        return (projected[..., :3] - [self.left, self.bottom, 0]) * self.scale

    # ------------------------------------------------------------------------------ spheres

    def draw_spheres(self, projected, radii, colours):
        place, r = self.to_pixels(projected), radii * self.scale
        inside = ((place[:, 0] > -r) & (place[:, 0] < self.width + r) &
                  (place[:, 1] > -r) & (place[:, 1] < self.height + r))
        near_first = np.flatnonzero(inside)[np.argsort(-place[inside, 2], kind="stable")]
        place, r, colours = place[near_first], r[near_first], colours[near_first]
        owner = self.front_spheres(place, r)
        rows, columns = np.nonzero(owner < len(r))
        if len(rows) == 0:
            return
        who = owner[rows, columns]
        nx = np.clip((columns + 0.5 - place[who, 0]) / r[who], -1, 1)
        ny = np.clip((rows + 0.5 - place[who, 1]) / r[who], -1, 1)
        nz = np.sqrt(np.clip(1 - nx * nx - ny * ny, 0, 1))
        self.depth[rows, columns] = depth = place[who, 2] + nz * r[who]
        shade = 0.42 + 0.58 * np.clip(nx * LIGHT[0] + ny * LIGHT[1] + nz * LIGHT[2], 0, 1)
        shade *= 0.70 + 0.30 * np.minimum(1, nz / 0.45)  # a dark rim parts neighbours
        near, far = np.percentile(depth, [99, 1])
        shade *= 1 - 0.30 * np.clip((near - depth) / max(near - far, 12 * np.median(r)), 0, 1)
        self.image[rows, columns] = np.clip(colours[who] * shade[:, None], 0, 1)

    def front_spheres(self, place, r):
        """Which sphere is seen at each pixel: its place in the near-to-far order, or len(r).

        Along a ray, spheres that do not overlap follow each other as their centres do, so the
        nearest centre wins. Near-to-far in portions: what a portion has covered is final, and
        spheres all of whose pixels are covered are skipped.
        """
        owner = np.full((self.height, self.width), len(r), np.int64)
        low = np.maximum(np.floor(place[:, :2] - r[:, None]).astype(int), 0)
        high = np.minimum(np.ceil(place[:, :2] + r[:, None]).astype(int) + 1,
                          [self.width, self.height])
        size = np.ceil(r).astype(int)
        portion = max(1000, len(r) // 40)
        for start in range(0, len(r), portion):
            some = np.arange(start, min(start + portion, len(r)))
            some = some[self.open_blocks(owner == len(r), low[some], high[some]) > 0]
            for k in np.unique(size[some]):
                group = some[size[some] == k]
                if len(group) < (2 * k + 1) ** 2:
                    self.stamp_each(owner, group, place, r, low, high)
                else:
                    self.stamp_together(owner, group, place, r, k)
        return owner

    @staticmethod
    def open_blocks(free, low, high, block=4):
        """How many blocks of pixels with a free one touch each box from `low` to below `high`."""
        for axis in (0, 1):
            free = np.logical_or.reduceat(free, np.arange(0, free.shape[axis], block), axis=axis)
        sums = np.zeros((free.shape[0] + 1, free.shape[1] + 1), np.int32)
        np.cumsum(np.cumsum(free, axis=0, dtype=np.int32), axis=1, out=sums[1:, 1:])
        (x0, y0), (x1, y1) = (low // block).T, (-(-high // block)).T
        return sums[y1, x1] - sums[y0, x1] - sums[y1, x0] + sums[y0, x0]

    @staticmethod
    def stamp_each(owner, group, place, r, low, high):
        for i in group:
            (x0, y0), (x1, y1) = low[i], high[i]
            dx = np.arange(x0, x1) + 0.5 - place[i, 0]
            dy = np.arange(y0, y1) + 0.5 - place[i, 1]
            disc = dx * dx + (dy * dy)[:, None] <= r[i] ** 2
            part = owner[y0:y1, x0:x1]
            part[disc] = np.minimum(part[disc], i)

    def stamp_together(self, owner, group, place, r, k):
        group = group[::-1]  # far to near: of several at one pixel the last assignment stays
        cell = np.floor(place[group, :2]).astype(int)
        flat = owner.reshape(-1)
        for ox in range(-k, k + 1):
            for oy in range(-k, k + 1):
                x, y = cell[:, 0] + ox, cell[:, 1] + oy
                d2 = (x + 0.5 - place[group, 0]) ** 2 + (y + 0.5 - place[group, 1]) ** 2
                hit = (d2 <= r[group] ** 2) | (ox == 0 and oy == 0)  # a dot at least
                hit &= (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
                at, who = y[hit] * self.width + x[hit], group[hit]
                nearer = who < flat[at]
                flat[at[nearer]] = who[nearer]

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
    def is_hidden(depth, low, high, nearest, block=16):
        """Whether all that small boxes of pixels show is nearer than what would come there."""
        farthest = depth
        for axis in (0, 1):
            starts = np.arange(0, farthest.shape[axis], block)
            farthest = np.minimum.reduceat(farthest, starts, axis)
        last = [farthest.shape[1] - 1, farthest.shape[0] - 1]
        (x0, y0), (x1, y1) = (np.clip(np.floor(end / block), 0, last).astype(int).T
                              for end in (low, high))
        small = (x1 - x0 <= 1) & (y1 - y0 <= 1)
        return small & (nearest < np.minimum(np.minimum(farthest[y0, x0], farthest[y0, x1]),
                                             np.minimum(farthest[y1, x0], farthest[y1, x1])))

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
        names = names.astype(np.int32)[who]
        flat_depth, flat_owner = depth.reshape(-1), owner.reshape(-1)
        while len(at) > 0:  # of several at one pixel any is first, until none is nearer
            nearer = z > flat_depth[at]
            at, z, names = at[nearer], z[nearer], names[nearer]
            flat_depth[at] = z
            flat_owner[at] = names

    # -------------------------------------------------------------------------------- walls

    def draw_walls(self, corners):
        """Triangles (n, 3, 3) of walls where there are no grains: the farthest at each pixel. Walls
        in front of grains are left out."""
        corners = self.to_pixels(corners)
        behind = np.full(self.depth.shape, -np.inf, np.float32)
        owner = self.front_triangles(corners * [1, 1, -1], behind)
        n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        n *= np.where(n[:, 2:] < 0, -1, 1)
        shade = (0.84 + 0.20 * np.clip(n @ LIGHT, 0, 1)).astype(np.float32)
        free = (owner >= 0) & ~np.isfinite(self.depth)
        self.image[free] = np.clip(WALL * shade[owner[free], None], 0, 1)

    # -------------------------------------------------------------------------------- lines

    def draw_lines(self, segments):
        """Lines where no grain is; faint where they pass in front of one."""
        ends = self.to_pixels(segments)
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

    def picture(self):
        n = SUPERSAMPLING
        small = self.image.reshape(self.height // n, n, self.width // n, n, 3).mean(axis=(1, 3))
        return small[::-1]
