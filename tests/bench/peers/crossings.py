"""Counts pairs of triangles of a mesh that cross, with numpy and scipy alone and no code of any program compared.

Two triangles without a common point cross if an edge of one passes through the other: its ends lie on two sides of the
plane, and its line passes the three edges on the same side. The sides are signs of tetrahedron volumes. An end nearer to
the plane than a millionth of the edge (6 nm) lies on neither side: flat cloth does not cross itself by rounding.
"""

import numpy as np
from scipy.spatial import cKDTree

CHUNK = 2_000_000
TOLERANCE = 1e-6


def volume(a, b, c, d):
    """Six times the signed volume of tetrahedra, row by row."""
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)


def pierces(p, q, a, b, c):
    """Whether the edge pq passes through the triangle abc, row by row."""
    least = TOLERANCE * np.linalg.norm(q - p, axis=1) * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    from_p, from_q = volume(a, b, c, p), volume(a, b, c, q)
    hit = (from_p * from_q < 0.0) & (np.minimum(np.abs(from_p), np.abs(from_q)) > least)
    row = np.flatnonzero(hit)
    p, q, a, b, c = p[row], q[row], a[row], b[row], c[row]
    sides = np.stack([np.sign(volume(p, q, *edge)) for edge in ((a, b), (b, c), (c, a))])
    hit[row] = np.abs(sides.sum(0)) == 3
    return hit


def near_pairs(points, triangles):
    """Pairs of triangles whose bounding boxes overlap and that have no common point."""
    corners = points[triangles]
    low, high = corners.min(1), corners.max(1)
    centre = 0.5 * (low + high)
    radius = 0.5 * np.linalg.norm(high - low, axis=1)
    # Large triangles are looked for apart, so that a few stretched ones do not make the search of all wide.
    limit = np.quantile(radius, 0.95)
    small = np.flatnonzero(radius <= limit)
    large = np.flatnonzero(radius > limit)
    tree = cKDTree(centre[small])
    found = [small[tree.query_pairs(2.0 * limit, output_type="ndarray").reshape(-1, 2)]]
    for triangle in large:
        others = np.array(tree.query_ball_point(centre[triangle], radius[triangle] + limit), int)
        found.append(np.stack([np.full(len(others), triangle), small[others]], 1))
    if len(large):
        tree = cKDTree(centre[large])
        found.append(large[tree.query_pairs(2.0 * radius.max(), output_type="ndarray").reshape(-1, 2)])
    pairs = np.concatenate(found)
    i, j = pairs[:, 0], pairs[:, 1]
    overlap = ((low[i] <= high[j]) & (low[j] <= high[i])).all(1)
    pairs = pairs[overlap]
    shared = (triangles[pairs[:, 0]][:, :, None] == triangles[pairs[:, 1]][:, None, :]).any((1, 2))
    return pairs[~shared]


def crossings(points, triangles):
    """Number of pairs of triangles that cross."""
    pairs = near_pairs(points, triangles)
    count = 0
    for start in range(0, len(pairs), CHUNK):
        part = pairs[start : start + CHUNK]
        hit = np.zeros(len(part), bool)
        for one, other in ((0, 1), (1, 0)):
            face = [points[triangles[part[:, other], k]] for k in range(3)]
            for k in range(3):
                p, q = points[triangles[part[:, one], k]], points[triangles[part[:, one], (k + 1) % 3]]
                hit |= pierces(p, q, *face)
        count += int(hit.sum())
    return count


def stretch(points, rest, triangles):
    """Elongation that 99 % of the edges stay below [-]. Edges that are shorter than at rest span wrinkles."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    at_rest = np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1)
    return max(float(np.quantile(length / at_rest - 1.0, 0.99)), 0.0)


def check():
    """Counts crossings whose number is known: two rectangles through one another, and apart."""
    square = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], float)
    upright = np.array([[1, 1.5, -1], [3, 1.5, -1], [3, 1.5, 1], [1, 1.5, 1]], float)
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    across = crossings(np.concatenate([square, upright]), triangles)
    apart = crossings(np.concatenate([square, upright + [0, 0, 1.5]]), triangles)
    if (across, apart) != (3, 0):
        raise SystemExit(f"the counter of crossings is wrong: {across} and {apart}, not 3 and 0")


if __name__ == "__main__":
    check()
