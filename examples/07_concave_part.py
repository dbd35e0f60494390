"""A part with a hollow and a hump, as triangles: `part.ply`, on which a task can press.

    python examples/07_concave_part.py part.ply

Then `[surface]` of a task file says `shape = "mesh"` and `file = "part.ply"`. The catalogue's task `wipe-part` has this
part. Its triangles lie within 0.03 mm of the smooth shape.
"""

import sys

import numpy as np
import trimesh

LENGTH, WIDTH, HEIGHT = 0.24, 0.18, 0.06  # m
WAVE, DISH = 0.008, 0.35  # m: height of the wave along x; radius of the trough along y
STEP = 4e-3  # m between two corners


def height(x, y):
    """m: a hollow at x < 0, a hump at x > 0, in a shallow trough."""
    return WAVE * np.sin(2.0 * np.pi * x / LENGTH) + y**2 / (2.0 * DISH)


def part() -> trimesh.Trimesh:
    """A closed block whose top is that height."""
    x = np.linspace(-LENGTH / 2, LENGTH / 2, round(LENGTH / STEP) + 1)
    y = np.linspace(-WIDTH / 2, WIDTH / 2, round(WIDTH / STEP) + 1)
    X, Y = np.meshgrid(x, y, indexing="ij")
    top = np.stack([X, Y, height(X, Y)], axis=-1).reshape(-1, 3)
    corner = np.arange(X.size).reshape(X.shape)
    a, b, c, d = (corner[i : i + len(x) - 1, j : j + len(y) - 1].ravel() for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    upper = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    rim = np.concatenate([corner[:-1, 0], corner[-1, :-1], corner[:0:-1, -1], corner[0, :0:-1]])
    below = top[rim] * [1, 1, 0] - [0, 0, HEIGHT]
    low, first = X.size + np.arange(len(rim)), np.roll(rim, -1)
    under = np.roll(low, -1)
    sides = np.concatenate([np.stack([low, under, first], 1), np.stack([low, first, rim], 1)])
    middle = X.size + len(rim)
    floor = np.stack([np.full(len(rim), middle), under, low], 1)
    vertices = np.concatenate([top, below, [[0.0, 0.0, -HEIGHT]]])
    return trimesh.Trimesh(vertices, np.concatenate([upper, sides, floor]), process=False)


if __name__ == "__main__":
    made = part()
    assert made.is_watertight
    assert made.volume > 0
    made.export(sys.argv[1] if len(sys.argv) > 1 else "part.ply")
    print(f"{len(made.faces)} triangles, {made.volume * 1e3:.2f} litres")
