"""Small FCLIB files of the kinds that collections of rigid-body problems hold, one folder per family.

    /usr/bin/python3 make_collection.py                          # writes collection/ anew
    /usr/bin/python3 make_collection.py OUT.hdf5 SPHERES SEED    # one packing of spheres, as large as wanted

Needs numpy and h5py. One step of Moreau's time stepping for rigid bodies under gravity, h = 10 ms, SI units:

    M v = h f + M v0 + H r,   u = H' v        W = H' M^-1 H,   q = H' (v0 + h g)

Per contact the normal (from the second body, or the ground, to the first) comes first. In the rotating frame of a table
that turns about z at OMEGA the Coriolis force is taken at the end of the step: M becomes M + 2 h m [OMEGA x], which is not
symmetric, and neither is W.
"""

import itertools
import sys

import h5py
import numpy as np

STEP, GRAVITY = 0.01, 9.81


def packing(dim, count, seed):
    """Centres and radii of balls in a box, pressed down until they rest on each other: soft balls, gradient descent."""
    rng = np.random.default_rng(seed)
    side = (count / 1.2) ** (1 / dim)
    radius = rng.uniform(0.9, 1.1, count) / 2
    centre = rng.uniform(0.5, side, (count, dim))
    centre[:, -1] *= 1.5
    for step in range(4000):
        move = np.zeros_like(centre)
        move[:, -1] -= 2e-3
        apart = centre[:, None] - centre[None]
        length = np.linalg.norm(apart, axis=2) + np.eye(count)
        overlap = np.maximum(radius[:, None] + radius[None] - length, 0) * (1 - np.eye(count))
        move += 0.3 * np.sum((overlap / length)[:, :, None] * apart, axis=1)
        move += 0.5 * np.maximum(radius[:, None] - centre, 0)
        move[:, :-1] -= 0.5 * np.maximum(centre[:, :-1] + radius[:, None] - side - 0.5, 0)
        centre += move
    return centre, radius, side + 0.5


def touching(centre, radius, side, near=0.02):
    """Contacts (first body, second body or None, normal, place): pairs, the ground and the walls."""
    dim = centre.shape[1]
    for a, b in itertools.combinations(range(len(radius)), 2):
        apart = centre[a] - centre[b]
        length = np.linalg.norm(apart)
        if length - radius[a] - radius[b] < near:
            yield a, b, apart / length, centre[b] + radius[b] * apart / length
    for a in range(len(radius)):
        for axis, sign in itertools.product(range(dim), [1, -1]):
            wall = 0.0 if sign > 0 else side
            top = axis == dim - 1 and sign < 0
            if not top and sign * (centre[a, axis] - wall) - radius[a] < near:
                normal = sign * np.eye(dim)[axis]
                yield a, None, normal, centre[a] - radius[a] * normal


def frame(normal):
    """Normal and tangents by row."""
    if len(normal) == 2:
        return np.array([normal, [-normal[1], normal[0]]])
    aside = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    aside /= np.linalg.norm(aside)
    return np.array([normal, aside, np.cross(normal, aside)])


def jump(contacts, centre):
    """H: columns are contact components, rows velocities and spins of the bodies."""
    count, dim = centre.shape
    size = {2: 3, 3: 6}[dim]
    h = np.zeros((size * count, dim * len(contacts)))
    for k, (a, b, normal, place) in enumerate(contacts):
        for body, sign in [(a, 1), (b, -1)]:
            if body is None:
                continue
            arm = place - centre[body]
            for l, e in enumerate(frame(normal)):
                spin = [arm[0] * e[1] - arm[1] * e[0]] if dim == 2 else np.cross(arm, e)
                h[size * body : size * (body + 1), dim * k + l] = sign * np.concatenate([e, spin])
    return h


def masses(dim, radius, omega):
    """M with the Coriolis force of a frame that turns at omega about the last axis of space (about the normal in the plane)."""
    size, m = {2: 3, 3: 6}[dim], 1000 * np.pi * radius**dim
    full = np.zeros((size * len(m),) * 2)
    for k, (mass, r) in enumerate(zip(m, radius)):
        own = slice(size * k, size * (k + 1))
        full[own, own] = np.diag([mass] * dim + [(0.5 if dim == 2 else 0.4) * mass * r * r] * (size - dim))
        full[size * k, size * k + 1] -= 2 * STEP * mass * omega
        full[size * k + 1, size * k] += 2 * STEP * mass * omega
    return full


def problem(dim, contacts, centre, mass, seed, mu):
    """M, H, f, w and W, q of one step from velocities that are small and random."""
    rng = np.random.default_rng(seed + 1)
    h, size = jump(contacts, centre), {2: 3, 3: 6}[dim]
    start = 0.05 * rng.standard_normal(len(mass))
    gravity = np.zeros(len(mass))
    gravity[dim - 1 :: size] = -GRAVITY
    diagonal = np.diag(np.diag(mass))
    f = diagonal @ (start + STEP * gravity)
    inverse = np.linalg.inv(mass)
    return {
        "dim": dim,
        "M": mass,
        "H": h,
        "f": f,
        "w": np.zeros(h.shape[1]),
        "W": h.T @ inverse @ h,
        "q": h.T @ inverse @ f,
        "mu": rng.uniform(*mu, len(contacts)),
    }


def balls(dim, count, seed, omega=0.0, mu=(0.3, 0.8)):
    centre, radius, side = packing(dim, count, seed)
    contacts = list(touching(centre, radius, side))
    return problem(dim, contacts, centre, masses(dim, radius, omega), seed, mu)


def blocks(dim, count, seed, points, omega=0.0):
    """A column of blocks, every face on the one below at so many points: redundant wherever a face has more than it needs."""
    centre = np.zeros((count, dim))
    centre[:, -1] = 0.5 + np.arange(count)
    spread = np.linspace(-0.5, 0.5, points)
    places = [[x] for x in spread] if dim == 2 else list(itertools.product(spread, spread))
    up = np.eye(dim)[-1]
    contacts = [
        (k, k - 1 if k else None, up, np.append(place, float(k))) for k in range(count) for place in places
    ]
    return problem(dim, contacts, centre, masses(dim, np.full(count, 0.5), omega), seed, (0.3, 0.8))


def matrix(group, name, a, storage):
    """Entries that are not zero: triplets with rows in i, compressed columns or compressed rows; `full` stores zeros too."""
    rows, cols = np.nonzero(a) if storage != "full" else np.indices(a.shape).reshape(2, -1)
    lines, other, count = (rows, cols, a.shape[0]) if storage == "rows" else (cols, rows, a.shape[1])
    order = np.lexsort((other, lines))
    rows, cols, lines, other = rows[order], cols[order], lines[order], other[order]
    compressed = storage in ("rows", "columns")
    own = group.create_group(name)
    pointers = np.searchsorted(lines, np.arange(count + 1)) if compressed else cols
    nz = {"rows": -2, "columns": -1}.get(storage, len(rows))
    for key, value in [("m", [a.shape[0]]), ("n", [a.shape[1]]), ("nz", [nz]), ("nzmax", [len(rows)])]:
        own[key] = np.array(value, dtype="i4")
    own["p"] = np.array(pointers, dtype="i4")
    own["i"] = np.array(other if compressed else rows, dtype="i4")
    own["x"] = a[rows, cols]


def write(path, data, kind="local", storage="triplets", group=None, extra=None):
    """A file; `group`: another name of the group of the problem, `extra`: further vectors."""
    with h5py.File(path, "w", libver=("earliest", "v108")) as file:
        own = file.create_group(group or f"fclib_{kind}")
        own["spacedim"] = np.array([data["dim"]], dtype="i4")
        matrices, vectors = ("W", ["q", "mu"]) if kind == "local" else ("MH", ["f", "w", "mu"])
        for name in matrices:
            matrix(own, name, data[name], storage)
        for name in vectors:
            own[f"vectors/{name}"] = data[name]
        for name, values in (extra or {}).items():
            own[f"vectors/{name}"] = values


def rolling(dim, count, seed):
    """Components of a contact with moments: two more in space, one more in the plane. What stands in W is not looked at."""
    data = balls(dim, count, seed)
    points = len(data["mu"])
    size = {2: 3, 3: 5}[dim]
    return {**data, "dim": size, "W": np.eye(size * points), "q": np.zeros(size * points)}, points


def collection():
    from pathlib import Path

    root = Path(__file__).parent / "collection"
    for family in ["spheres", "disks", "blocks", "rotating", "rolling"]:
        (root / family).mkdir(parents=True, exist_ok=True)
    write(root / "spheres/packing-3d.hdf5", balls(3, 5, 1))
    write(root / "spheres/packing-3d-global.hdf5", balls(3, 5, 1), "global")
    write(root / "disks/packing-2d.hdf5", balls(2, 8, 2), storage="columns")
    write(root / "disks/full-2d.hdf5", balls(2, 4, 3), storage="full")
    write(root / "blocks/column-2d.hdf5", blocks(2, 6, 4, 3), storage="rows")
    write(root / "blocks/column-3d.hdf5", blocks(3, 3, 5, 2))
    write(root / "rotating/table-2d.hdf5", balls(2, 8, 6, omega=0.5))
    write(root / "rotating/table-3d.hdf5", balls(3, 5, 7, omega=0.5), storage="columns")
    write(root / "rotating/column-3d.hdf5", blocks(3, 2, 8, 2, omega=0.5), storage="rows")
    write(root / "rotating/table-2d-global.hdf5", balls(2, 4, 9, omega=0.5), "global")
    data, points = rolling(3, 3, 10)
    write(root / "rolling/local-3d.hdf5", data, extra={"mu_r": np.full(points, 0.1)})
    data, points = rolling(2, 3, 11)
    write(root / "rolling/local-2d.hdf5", data, extra={"mu_r": np.full(points, 0.1)})
    named = {"group": "fclib_global_rolling", "extra": {"mu_r": np.full(points, 0.1)}}
    write(root / "rolling/global-2d.hdf5", {**balls(2, 3, 11), "dim": 3}, "global", **named)


if __name__ == "__main__":
    match sys.argv[1:]:
        case []:
            collection()
        case [path, count, seed]:
            write(path, balls(3, int(count), int(seed)))
        case _:
            sys.exit(__doc__)
