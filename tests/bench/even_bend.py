#!/usr/bin/env python3
"""Writes a sidecar whose creases are perfect: even_bend.py SIDECAR OUT [--width MM] [--angle DEGREES]

Bends the garment of SIDECAR, which has to lie flat in its file, by geometry along the three lines of `fold-thrice`, by the same angle
everywhere and over `--width` to either side, and writes a copy with the angles that its hinges have then. What a measure of creases says
of OUT is what it can say at best of these triangles. Needs numpy."""
import argparse
import json

import numpy as np

LINES = [(0, 0.3), (0, 0.7), (1, 0.5)]


def hinge_angles(x, hinges):
    """Signed angles between the two triangles of each hinge [rad]."""
    a, b, c, d = (x[hinges[:, k]] for k in range(4))
    first, second = np.cross(b - a, c - a), np.cross(d - a, b - a)
    along = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    return np.arctan2((np.cross(first, second) * along).sum(1), (first * second).sum(1))


def bent(x, axis, up, place, width, angle):
    """The points x [m], bent by `angle` [rad] across `axis` over `width` [m] to either side of `place` [m]."""
    beside = x[:, axis] - place
    grid = np.linspace(-width, width, 2001)
    slope = angle * (grid + width) / (2 * width)
    middle, step = (slope[:-1] + slope[1:]) / 2, np.diff(grid)
    along = np.concatenate([[0], np.cumsum(np.cos(middle) * step)]) - width
    above = np.concatenate([[0], np.cumsum(np.sin(middle) * step)])
    beyond = np.maximum(beside - width, 0)
    turned = np.interp(beside, grid, slope)
    height = x[:, up] - x[:, up].mean()
    y = x.copy()
    y[:, axis] = place + np.minimum(beside, -width) + width + np.interp(beside, grid, along)
    y[:, axis] += beyond * np.cos(angle) - height * np.sin(turned)
    y[:, up] = np.interp(beside, grid, above) + beyond * np.sin(angle) + height * np.cos(turned)
    return y


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sidecar")
    parser.add_argument("out")
    parser.add_argument("--width", type=float, default=8.0, help="to either side of a line [mm]")
    parser.add_argument("--angle", type=float, default=95.0, help="across a line [degrees]")
    arguments = parser.parse_args()
    with open(arguments.sidecar, encoding="utf-8") as file:
        sidecar = json.load(file)
    x, hinges = np.array(sidecar["mesh"]["points_m"]), np.array(sidecar["hinges"]["points"])
    low, size = x.min(0), np.ptp(x, axis=0)
    up = int(np.argmin(size))
    axes = [k for k in range(3) if k != up]
    flat, change = hinge_angles(x, hinges), np.zeros(len(hinges))
    for axis, fraction in LINES:
        place = low[axes[axis]] + fraction * size[axes[axis]]
        y = bent(x, axes[axis], up, place, 1e-3 * arguments.width, np.radians(arguments.angle))
        by = hinge_angles(y, hinges) - flat
        change += (by + np.pi) % (2 * np.pi) - np.pi
    source = np.array(sidecar["hinges"]["source_angle_rad"])
    sidecar["hinges"]["rest_angle_rad"] = (source + change).tolist()
    with open(arguments.out, "w", encoding="utf-8") as file:
        json.dump(sidecar, file)


if __name__ == "__main__":
    main()
