"""The two scenes that every program computes: geometry, motion of the gripped edge, what shows that they took place.

Lengths in metres, z up, the floor at z = 0, points row by row. `clearance` is the height at which a program's own
contact distances let cloth lie on the floor; nothing else differs between programs.

- `fold`: a square of 0.7 m, 118 x 118 points, lies on the floor. Its left edge moves along a half circle to the right
  edge within 2 s, stays there for 1 s and moves back within 2 s.
- `strip`: a strip of 0.32 x 0.44 m, 33 x 45 points, stands upright on its short edge, tilted by 2 degrees, and falls
  for 2 s.
"""

import math

import numpy as np

FRAMES_PER_SECOND = 12
AREA_DENSITY = 0.158  # kg/m²; the cotton jersey of crease
GRAVITY = 9.81


def grid(columns, rows, width, height):
    """Points on a plane, (x, y) row by row, and the triangles between them."""
    x, y = np.meshgrid(np.linspace(0.0, width, columns), np.linspace(0.0, height, rows))
    index = np.arange(columns * rows).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]))
    triangles = np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])
    return x.ravel(), y.ravel(), triangles


class Fold:
    name = "fold"
    columns = rows = 118
    width = height = 0.7
    duration = 5.0

    def __init__(self, clearance):
        x, y, self.triangles = grid(self.columns, self.rows, self.width, self.height)
        self.points = np.stack([x, y, np.full_like(x, clearance)], 1)
        self.gripped = np.flatnonzero(x == 0.0)
        # The edge comes down three clearances above the floor: one for each layer under it and one of play.
        self.axis = (0.5 * self.width, 2.0 * clearance)

    @staticmethod
    def angle(time):
        """Angle by which the gripped edge is turned about the axis [rad]; starts and ends without velocity."""
        part = min(time / 2.0, 1.0) if time < 3.0 else max(1.0 - (time - 3.0) / 2.0, 0.0)
        return math.pi * part * part * (3.0 - 2.0 * part)

    def gripped_at(self, time):
        """Positions of the gripped points."""
        start = self.points[self.gripped]
        sin, cos = math.sin(self.angle(time)), math.cos(self.angle(time))
        x, z = start[:, 0] - self.axis[0], start[:, 2] - self.axis[1]
        return np.stack([self.axis[0] + cos * x + sin * z, start[:, 1], self.axis[1] - sin * x + cos * z], 1)

    def outcome(self, times, frames):
        """Part of the flap that lies over the other half while the sheet is held, and part that is back at the end."""
        if times[-1] < self.duration - 0.2:
            return f"stopped at {times[-1]:.1f} s"
        flap = self.points[:, 0] < 0.45 * self.width
        over = [np.mean(frames[np.abs(times - time).argmin()][flap, 0] > self.axis[0]) for time in (2.9, self.duration)]
        height = frames[np.abs(times - 2.9).argmin()][:, 2].max()
        return f"turned over: {100 * over[0]:.0f} % of the flap, {1000 * height:.0f} mm high; opened: {100 - 100 * over[1]:.0f} %"


class Strip:
    name = "strip"
    columns, rows = 33, 45
    width, height = 0.32, 0.44
    duration = 2.0

    def __init__(self, clearance):
        along, up, self.triangles = grid(self.columns, self.rows, self.width, self.height)
        tilt = math.radians(2.0)
        self.points = np.stack([along, up * math.sin(tilt), clearance + up * math.cos(tilt)], 1)
        self.gripped = np.zeros(0, int)

    def gripped_at(self, _time):
        return np.zeros((0, 3))

    def outcome(self, times, frames):
        words = [f"stopped at {times[-1]:.1f} s"] if times[-1] < self.duration - 0.2 else []
        words.append(f"height {1000 * (frames[-1][:, 2].max() - frames[-1][:, 2].min()):.0f} mm")
        return ", ".join(words)


SCENES = {scene.name: scene for scene in (Fold, Strip)}
