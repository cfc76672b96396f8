#!/usr/bin/python3 -B
"""Writes the scenes of scenes/bench/, on which renderers are measured: `make bench-peers`.

Usage: scripts/make_bench_scenes.py [FOLDER]     (default: the repository's scenes/bench/)

The output depends on nothing but this file and bench_files.py. y is up. Lights are rectangles where they can be, metals reflect the
same at all angles, and polish is a blend, so that other renderers can be given the same scene without approximation.
Needs NumPy (Debian: python3-numpy), which comes with the system's Python.
"""
import sys
from pathlib import Path

import numpy as np

from bench_files import (Mesh, area, box, dielectric, diffuse, glossy, grid, lathe, map_directions, metal, named, normalized, placed,
                         plastic, ply, rectangle, ref, rgb, rotate_y, scale, shape, sky, sphere, square_lamp, translate, tube, twosided,
                         write_exr, write_scene)

GOLD, COPPER, SILVER, STEEL = (1.0, 0.78, 0.34), (0.96, 0.64, 0.54), (0.97, 0.96, 0.92), (0.62, 0.6, 0.58)


# --- boxes with spheres --------------------------------------------------------------------

def cornell(lamp_scale):
    """Two metres wide and deep, one and a half high, open towards the camera; the lamp's power does not depend on its size."""
    back, lamp_z, lamp_y = -0.995684, 0.00431585, 1.49
    white = ref("white")
    return [
        named(twosided(diffuse(0.6)), "white"),
        rectangle((0, 0, 0), (0, 0, 2), (2, 0, 0), white),
        rectangle((0, 1.5, 0), (2, 0, 0), (0, 0, 2), white),
        rectangle((0, 0.75, back), (2, 0, 0), (0, 1.5, 0), white),
        rectangle((-1, 0.75, 0), (0, 1.5, 0), (0, 0, 2), twosided(diffuse((0.6, 0.2, 0.2)))),
        rectangle((1, 0.75, 0), (0, 0, 2), (0, 1.5, 0), twosided(diffuse((0.2, 0.2, 0.6)))),
        sphere((-0.4, 0.3, -0.3), 0.3, metal(1)),
        sphere((0.4, 0.3, 0.3), 0.3, dielectric(1.45)),
        rectangle((0, lamp_y, lamp_z), (0.8 * lamp_scale, 0, 0), (0, 0, 0.6 * lamp_scale), area(10 / lamp_scale**2)),
    ]


def write_spheres(folder):
    camera = (0, 0.75, 4.802344), (0, 0.75, 0), 30.676397
    write_scene(folder / "a-spheres.xml", "A box with a mirror and a glass sphere: caustics of a large lamp, seen in a mirror too.",
                *camera, cornell(1), max_depth=101)
    write_scene(folder / "b-small-light.xml", "The box of a-spheres.xml under a lamp of 1/50 of the area, and the same power.",
                *camera, cornell(50**-0.5), max_depth=101)


# --- a glass of water ----------------------------------------------------------------------

def arc(centre, radius, start, end, steps):
    """Points of a circle in the (radius, y) plane, angles in degrees."""
    angle = np.radians(np.linspace(start, end, steps))
    return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)], -1)


def line(start, end, steps):
    """Without its ends, which belong to the neighbours. Its first and last points are near them: beyond, normals are the line's own,
    however a reader of the mesh averages them."""
    t = np.linspace(0, 1, steps)
    t[0], t[-1] = 0.02, 0.98
    return np.asarray(start) + t[:, None] * np.subtract(end, start)


def tumbler():
    """A glass with its water: air to glass, glass to water, water to air. They meet in one circle of points."""
    wall, floor, level, height, base = 0.025, 0.09, 0.78, 1.15, 0.32
    def outer(y): return base + 0.05 * y
    def inner(y): return outer(y) - wall
    edge = [inner(level), level]
    rim, foot, well = wall / 2, 0.03, 0.06
    glass = np.vstack([[edge], line(edge, (inner(height), height), 8),
                       arc((outer(height) - rim, height), rim, 180, 0, 17),
                       line((outer(height), height), (outer(foot), foot), 24),
                       arc((outer(foot) - foot, foot), foot, 0, -90, 9),
                       line((outer(foot) - foot, 0), (0, 0), 10), [(0, 0)]])
    corner = arc((inner(floor + well) - well, floor + well), well, -90, 0, 13)
    water = np.vstack([[(0, floor)], line((0, floor), corner[0], 10), corner, line(corner[-1], edge, 20), [edge]])
    surface = np.vstack([[edge], line(edge, (0, level), 6), [(0, level)]])
    segments = 160
    return lathe(glass[::-1], segments), lathe(water, segments), lathe(surface, segments)


def ring():
    radius, height, thickness, edge = 0.3, 0.17, 0.03, 0.012
    low, high = np.array((radius, 0)), np.array((radius + thickness, height))
    corners = [((high[0] - edge, low[1] + edge), -90), ((high[0] - edge, high[1] - edge), 0),
               ((low[0] + edge, high[1] - edge), 90), ((low[0] + edge, low[1] + edge), 180)]
    arcs = [arc(centre, edge, start, start + 90, 5) for centre, start in corners]
    sides = [line(arcs[k][-1], arcs[(k + 1) % 4][0], 6) for k in range(4)]
    return lathe(np.vstack([part for pair in zip(arcs, sides) for part in pair]), 160, closed=True)


def write_water(folder):
    for name, mesh in zip(("glass", "water", "surface"), tumbler()):
        mesh.write(folder / f"c-{name}.ply")
    ring().write(folder / "c-ring.ply")
    directions = map_directions(128, 65)
    up = directions[..., 1:2]
    dusk = normalized(np.array((-0.9, 0.12, -0.6)))
    glow = np.exp(6 * (directions @ dusk - 1))[..., None]
    air = np.array((0.10, 0.15, 0.27)) * (1 - 0.5 * np.maximum(up, 0)) + glow * np.array((0.75, 0.42, 0.22))
    write_exr(folder / "c-sky.exr", np.where(up > -0.02, air, np.array((0.05, 0.045, 0.04))))
    planks = []
    browns = np.array([(0.42, 0.25, 0.14), (0.36, 0.20, 0.11), (0.46, 0.29, 0.17), (0.39, 0.23, 0.12), (0.33, 0.19, 0.10)])
    for k, z in enumerate(np.arange(-3.5, 3.6, 0.7)):
        planks.append(box((-6, -0.3, z - 0.343), (6, -0.002, z + 0.343), diffuse(browns[k * 3 % 5])))
    lamp, aim = np.array((-2.4, 3.4, -2.2)), (0, 0.4, 0)
    write_scene(folder / "c-water.xml", """A glass of water and a golden ring on a table, under a lamp of one square centimetre and an evening sky: caustics, and caustics
     seen through glass. A unit is a decimetre. Each interface is a surface of its own: air to glass, water to glass, water to air.""",
                (0.75, 2.6, 4.4), (0.12, 0.33, 0), 30,
                [*planks,
                 ply("c-glass.ply", dielectric(1.5)),
                 ply("c-water.ply", dielectric(1.33, 1.5)),
                 ply("c-surface.ply", dielectric(1.33)),
                 ply("c-ring.ply", placed(translate((-0.62, 0, 0.45))), metal(GOLD)),
                 ply("c-ring.ply", placed(scale((0.8, 0.8, 0.8)), translate((0.55, 0, -0.75))), metal(SILVER)),
                 square_lamp(lamp, aim, 0.1, 6000 * np.array((1, 0.9, 0.76))),
                 sky("c-sky.exr")])


# --- a mesh under maps ---------------------------------------------------------------------

def knot(rows, columns):
    """A rope of five strands wound along a (2, 3) torus knot; the torus's normals are a frame that closes with it."""
    u = 2 * np.pi * np.arange(rows)[:, None] / rows
    v = 2 * np.pi * np.arange(columns) / columns
    theta, phi = 3 * u, 2 * u
    around = np.stack([np.cos(phi), 0 * phi, np.sin(phi)], -1)
    up = np.array((0, 1, 0))
    outward = around * np.cos(theta)[..., None] + up * np.sin(theta)[..., None]
    centre = around + 0.4 * outward
    tangent = normalized(np.roll(centre, -1, 0) - np.roll(centre, 1, 0))
    side = normalized(np.cross(tangent, outward))
    radius = 0.19 * (1 + 0.13 * np.cos(5 * v + 15 * u))[..., None]
    points = centre + radius * (outward * np.cos(v)[:, None] - side * np.sin(v)[:, None])
    return grid(points, True, True)


def museum(width=512, height=257):
    """A hall: pale walls, a dark wooden floor, two high windows, a row of small lamps on the ceiling and one spotlight."""
    d = map_directions(width, height)
    half = np.array((7, 3.5, 9))
    distance = np.min(half / np.maximum(np.abs(d), 1e-9), -1)
    p = d * distance[..., None]
    on = np.abs(p) > half - 1e-6
    shade = 0.55 + 0.45 * np.cos(p[..., 0] * 0.3) * np.cos(p[..., 2] * 0.2)
    level = np.where(d[..., 1:2] > 0, (0.42, 0.40, 0.37), (0.12, 0.07, 0.04))
    light = np.where(on[..., 1:2], level, (0.30, 0.27, 0.23)) * shade[..., None]
    along = (p[..., 0] + p[..., 2]) % 3.6 - 1.8
    pictures = (on[..., 0] & (p[..., 0] > 0) | on[..., 2]) & (np.abs(p[..., 1] - 0.6) < 1.1) & (np.abs(along) < 1.2)
    light[pictures] *= (0.5, 0.25, 0.2)
    window = on[..., 0] & (p[..., 0] < 0) & (np.abs(np.abs(p[..., 2]) - 3) < 1.3) & (np.abs(p[..., 1] - 0.8) < 1.9)
    bars = (np.abs(p[..., 2] % 0.65 - 0.3) < 0.04) | (np.abs(p[..., 1] % 0.95 - 0.3) < 0.04)
    light[window & ~bars] = 9, 10.5, 12
    lamps = on[..., 1] & (d[..., 1] > 0) & (np.abs(p[..., 0] - 2.5) < 0.12) & (np.abs(p[..., 2] % 2 - 1) < 0.12)
    light[lamps] = 160, 130, 90
    spot = normalized(np.array((0.75, 0.62, 0.35)))
    light[d @ spot > np.cos(np.radians(0.9))] = 2200, 2000, 1700
    return light


def clear_sky(width=2048, height=1025, elevation=32, azimuth=55):
    """Preetham, Shirley & Smits 1999's distribution of a clear sky in plain colours; a sun of 0.53 degrees that gives level ground
    four times as much light as the sky; grey ground."""
    d = map_directions(width, height)
    e, a = np.radians(elevation), np.radians(azimuth)
    sun = np.array((np.cos(e) * np.sin(a), np.sin(e), -np.cos(e) * np.cos(a)))
    cosine = np.clip(d @ sun, -1, 1)
    gamma = np.arccos(cosine)
    up = np.maximum(d[..., 1], 0.02)
    def perez(A, B, C, D, E):
        return (1 + A * np.exp(B / up)) * (1 + C * np.exp(D * gamma) + E * cosine**2)
    luminance, haze = perez(-1, -0.32, 10, -3, 0.45), np.exp(-4 * up)
    colour = (1 - haze[..., None]) * np.array((0.36, 0.70, 1.45)) + haze[..., None] * np.array((0.95, 1.0, 1.05))
    light = 0.055 * luminance[..., None] * colour
    # Few levels of brightness: a smooth sky in half floats hardly packs at all.
    levels = 2.0 ** np.floor(np.log2(light) - 9)
    light = np.round(light / levels) * levels
    light[d[..., 1] < 0] = 0.09, 0.08, 0.07
    solid = np.abs(np.sin(np.pi * np.arange(height) / (height - 1)))[:, None] * (2 * np.pi / width) * (np.pi / (height - 1))
    cosines = np.maximum(d[..., 1], 0)
    ground = np.sum(light[..., 1] * cosines * solid)
    # A texel shows the share of the disc that covers it.
    radius, texel = np.radians(0.53 / 2), np.pi / (height - 1)
    cover = np.clip((radius - gamma) / texel + 0.5, 0, 1)
    radiance = 4 * ground / np.sum(cover * cosines * solid)
    return light + np.minimum(radiance * cover[..., None] * np.array((1.06, 1.0, 0.86)), 65000)


def write_mesh(folder):
    knot(640, 40).write(folder / "d-knot.ply")
    write_exr(folder / "d-museum.exr", museum())
    write_exr(folder / "d-sun.exr", clear_sky())
    parts = [rectangle((0, 0, 0), (0, 0, 60), (60, 0, 0), diffuse((0.42, 0.4, 0.37))),
             ply("d-knot.ply", placed(translate((0, 0.62, 0))), metal(COPPER, 0.15)),
             sphere((-1.55, 0.42, 1.25), 0.42, plastic((0.1, 0.3, 0.55))),
             sphere((1.35, 0.3, 1.5), 0.3, plastic((0.6, 0.08, 0.05))),
             sphere((0.05, 0.24, 2.15), 0.24, metal(GOLD, 0.05))]
    for name, brightness, comment in (("museum", 1, "a hall's map: two windows, small lamps"),
                                      ("sun", 4, "a clear sky; the sun is 0.53 degrees wide")):
        default = f'<default name="map" value="d-{name}.exr"/>'
        write_scene(folder / f"d-mesh-{name}.xml", f"""A knot of 51,200 triangles in rough copper, with plastic and golden balls, under {comment}.
     -D map=FILE puts another map in its place.""",
                    (0.7, 1.75, 6.6), (0, 0.72, 0.2), 37, [default, *parts, sky("$map", brightness)])


# --- a door left ajar ----------------------------------------------------------------------

def teapot():
    """A pot of our own: a turned body with a lid, a handle and a spout."""
    body = np.vstack([[(0, 0)], line((0, 0), (0.30, 0), 4), arc((0.30, 0.03), 0.03, -90, 0, 5),
                      np.stack([0.33 + 0.22 * np.sin(np.pi * np.linspace(0.03, 0.88, 28)), np.linspace(0.05, 0.575, 28)], -1),
                      arc((0.36, 0.62), 0.045, -60, 150, 9),
                      np.stack([0.31 * np.cos(np.linspace(0, 1.45, 14)), 0.645 + 0.13 * np.sin(np.linspace(0, 1.45, 14))], -1),
                      arc((0.0, 0.84), 0.07, -50, 90, 12)])
    t = np.linspace(0, 1, 24)
    handle = np.stack([-0.46 - 0.30 * np.sin(np.pi * t), 0.15 + 0.40 * t, 0 * t], -1)
    spout = np.stack([0.46 + 0.42 * t, 0.22 + 0.42 * t**2.2, 0 * t], -1)
    body[-1, 0] = 0
    return Mesh.joined([lathe(body, 64), tube(handle, 0.035, 16), tube(spout, 0.10 - 0.06 * t, 20)])


def write_door(folder):
    teapot().write(folder / "e-teapot.ply")
    white, plaster, panel = ref("white"), ref("plaster"), 0.05
    hinge, width, height, ajar = 0.35, 0.95, 2.05, 24
    parts = [
        named(diffuse((0.76, 0.73, 0.68)), "white"), named(diffuse((0.62, 0.66, 0.62)), "plaster"),
        named(glossy((0.36, 0.22, 0.13), 0.12, 0.2), "wood"),
        # The room: floor, ceiling, left, right, and a wall behind the camera.
        box((-2.8, -0.1, -6.4), (4, 0, 3.6), ref("wood")), box((-2.8, 2.6, -6.4), (4, 2.7, 3.6), white),
        box((-2.6, -0.1, -2.2), (-2.5, 2.7, 3.6), plaster), box((2.5, -0.1, -2.2), (2.6, 2.7, 3.6), plaster),
        box((-2.6, -0.1, 3.5), (2.6, 2.7, 3.6), white),
        # The wall with the door, and the bright room behind it.
        box((-2.6, -0.1, -2.1), (hinge, 2.7, -2), plaster), box((hinge + width, -0.1, -2.1), (4, 2.7, -2), plaster),
        box((hinge - 0.01, height, -2.1), (hinge + width + 0.01, 2.7, -2), plaster),
        box((-2.8, -0.1, -6.4), (4, 2.7, -6.3), white), box((-2.8, -0.1, -6.4), (-2.5, 2.7, -2.05), white),
        box((3.7, -0.1, -6.4), (4, 2.7, -2.05), white),
        rectangle((1.2, 2.59, -4.3), (3.2, 0, 0), (0, 0, 2.4), area((150, 140, 122))),
        shape("cube", placed(scale((width / 2 - 0.004, height / 2 - 0.004, 0.02)), translate((width / 2, height / 2, -0.02)),
                             rotate_y(ajar), translate((hinge, 0, -2.05))), diffuse((0.25, 0.33, 0.42))),
        # A table with three pots, a chest, two balls, a picture.
        box((-1.7, 0.70, -0.55), (0.5, 0.75, 0.55), ref("wood")),
        *(box((x - 0.04, 0, z - 0.04), (x + 0.04, 0.70, z + 0.04), ref("wood")) for x in (-1.62, 0.42) for z in (-0.47, 0.47)),
        *(ply("e-teapot.ply", placed(scale((0.52, 0.52, 0.52)), rotate_y(turn), translate((x, 0.751, z))), bsdf) for x, z, turn, bsdf in (
            (-1.2, 0.05, 20, diffuse((0.55, 0.16, 0.10))), (-0.55, -0.1, 200, glossy((0.05, 0.22, 0.30), 0.25, 0.08)),
            (0.1, 0.1, -30, metal(SILVER, 0.12)))),
        box((-2.45, 0, -1.95), (-1.15, 0.85, -1.4), glossy((0.45, 0.30, 0.18), 0.1, 0.1)),
        sphere((-1.8, 1.03, -1.68), 0.18, metal(GOLD, 0.06)), sphere((1.5, 0.3, -0.3), 0.3, diffuse((0.7, 0.55, 0.2))),
        box((-2.5, 1.25, 0.0), (-2.47, 2.0, 1.0), diffuse((0.15, 0.25, 0.5))),
    ]
    write_scene(folder / "e-ajar-door.xml", "A room whose only light comes around a door, from the lamp of the room behind.",
                (0.5, 1.5, 3.3), (-0.15, 0.98, -1), 62, parts)


# --- a hall with many lights ---------------------------------------------------------------

def octahedra(centres, radii):
    corners = np.array([(1, 0, 0), (0, 0, -1), (-1, 0, 0), (0, 0, 1), (0, 1, 0), (0, -1, 0)])
    faces = np.array([(a, (a + 1) % 4, 4) for a in range(4)] + [((a + 1) % 4, a, 5) for a in range(4)])
    positions = centres[:, None] + radii[:, None, None] * corners
    return Mesh(positions, faces + 6 * np.arange(len(centres))[:, None, None])


def lantern_places():
    """Garlands between the columns and across the nave, stars under the ceiling, candles on the floor of the chambers behind."""
    random = np.random.RandomState(4)
    places, t = [], np.linspace(0, 1, 22)[:-1]
    for z in np.arange(-42, 4, 4.0):
        for x in (-3.2, 3.2):
            places.append(np.stack([0 * t + x, 3.9 - 4.4 * t * (1 - t), z + 4 * t], -1))
        s = np.linspace(0.04, 0.96, 20)
        places.append(np.stack([-3.2 + 6.4 * s, 5.6 - 5 * s * (1 - s), 0 * s + z], -1))
        for x in (-1, 1):
            candles = random.uniform((4.3, 0.12, z + 0.3), (7.6, 0.5, z + 3.7), (26, 3))
            places.append(candles * (x, 1, 1))
    stars = random.uniform((-7.5, 6.3, -45), (7.5, 6.9, 5), (520, 3))
    return np.concatenate([*places, stars]), random


def write_hall(folder):
    places, random = lantern_places()
    radii = random.uniform(0.018, 0.035, len(places))
    colours = np.array([(1, 0.62, 0.28), (1, 0.78, 0.48), (1, 0.35, 0.12), (0.35, 0.75, 1), (0.9, 0.25, 0.55), (0.4, 1, 0.55)])
    colour = random.choice(len(colours), len(places), p=(0.34, 0.3, 0.14, 0.1, 0.07, 0.05))
    power = random.choice(3, len(places), p=(0.6, 0.3, 0.1))
    lamps = []
    for c in range(len(colours)):
        for p in range(3):
            chosen = (colour == c) & (power == p)
            octahedra(places[chosen], radii[chosen]).write(folder / f"f-lanterns-{c}{p}.ply")
            lamps.append(ply(f"f-lanterns-{c}{p}.ply", '<boolean name="face_normals" value="true"/>',
                             area(colours[c] * (30, 110, 400)[p])))
    shaft = np.vstack([[(0.62, 0), (0.62, 0.2)], arc((0.5, 0.3), 0.1, -60, 60, 7), line((0.46, 0.42), (0.40, 6.2), 8),
                       arc((0.46, 6.35), 0.1, -60, 60, 7), [(0.66, 6.6), (0.66, 7)]])
    lathe(shaft, 48).write(folder / "f-column.ply")
    stone = ref("stone")
    parts = [named(diffuse((0.55, 0.52, 0.48)), "stone"),
             box((-8.2, -0.2, -47), (8.2, 0, 8), glossy((0.30, 0.27, 0.25), 0.2, 0.12)), box((-8.2, 7, -47), (8.2, 7.2, 8), stone),
             box((-8.2, 0, -47), (-8, 7, 8), stone), box((8, 0, -47), (8.2, 7, 8), stone), box((-8.2, 0, -47.2), (8.2, 7, -47), stone),
             box((-8.2, 0, 8), (8.2, 7, 8.2), stone)]
    for z in np.arange(-42, 4, 4.0):
        for x in (-1, 1):
            parts.append(ply("f-column.ply", placed(translate((3.2 * x, 0, z))), stone))
            # Walls between the chambers, half as high as the hall, and a parapet in front of each.
            parts.append(box((min(4.1 * x, 8 * x), 0, z - 0.1), (max(4.1 * x, 8 * x), 3.4, z + 0.1), stone))
            parts.append(box((min(4.1 * x, 4.25 * x), 0, z + 1.2), (max(4.1 * x, 4.25 * x), 0.9, z + 2.8), stone))
    write_scene(folder / "f-many-lights.xml", f"""A hall of columns with {len(places)} lanterns, {8 * len(places)} shining triangles, in six colours;
     most are far away or stand in chambers behind walls.""", (0.9, 1.7, 6.6), (-0.5, 2.1, -6), 66, parts + lamps)


# --- plates under lamps of several sizes ---------------------------------------------------

def write_plates(folder):
    eye, target = np.array((0, 3.6, 9.0)), np.array((0, 1.75, 0))
    lamps_at = np.array((0, 4.1, -1.9))
    sizes, places = (0.04, 0.2, 0.6, 1.4), (-3.3, -1.5, 0.5, 3.1)
    colours = np.array([(1, 0.9, 0.65), (0.75, 1, 0.75), (0.75, 0.85, 1), (1, 0.75, 0.7)])
    lamps = [square_lamp(lamps_at + (x, 0, 0), (x, 0, 2.0), size, 7 / size**2 * colour) for x, size, colour in zip(places, sizes, colours)]
    plates = []
    for place, alpha in zip(((0, 2.35, -1.3), (0, 1.55, -0.4), (0, 0.85, 0.7), (0, 0.32, 2.0)), (0.005, 0.02, 0.06, 0.15)):
        centre = np.array(place)
        normal = normalized(normalized(eye - centre) + normalized(lamps_at - centre))
        v = np.cross(normal, (1, 0, 0))
        plates.append(rectangle(centre, (7.6, 0, 0), -v * 0.95, twosided(metal(STEEL, alpha))))
    parts = [rectangle((0, -0.4, 0), (0, 0, 30), (30, 0, 0), diffuse(0.5)),
             rectangle((0, 5, -3.2), (30, 0, 0), (0, 20, 0), diffuse(0.5)), *plates, *lamps]
    write_scene(folder / "g-veach-mis.xml", """Metal plates from nearly smooth to rough under four square lamps of the same power, from 4 to 140 cm wide,
     after Veach's thesis (1997), figure 9.2: sampling lamps fails at the upper left, sampling surfaces at the lower right.""",
                eye, target, 48, parts)


# --- fog -----------------------------------------------------------------------------------

def write_fog(folder):
    spot = np.array((2.6, 4.6, -2.6))
    fog = ('<medium type="homogeneous" name="interior"><rgb name="sigma_t" value="0.12 0.12 0.12"/>'
           '<rgb name="albedo" value="0.94 0.95 0.97"/><phase type="hg"><float name="g" value="0.4"/></phase></medium>')
    lamp = ('<emitter type="spot">' + placed(f'<lookat origin="{" ".join(map(str, spot))}" target="-0.9 0.4 0.4" up="0 1 0"/>') +
            rgb("intensity", (700, 620, 480)) + '<float name="cutoff_angle" value="24"/><float name="beam_width" value="21"/></emitter>')
    across = normalized(np.array((-0.9, 0.4, 0.4)) - spot)
    right = normalized(np.cross(across, (0, 1, 0)))
    up = np.cross(right, across)
    slats = [rectangle(spot + 1.5 * across + k * 0.19 * right, 0.085 * right, 1.5 * up, twosided(diffuse(0.25))) for k in range(-4, 5)]
    parts = [shape("cube", placed(scale((4.5, 2.8, 4.5)), translate((0, 2.6, -0.5))), '<bsdf type="null"/>', fog),
             rectangle((0, 0, 0), (0, 0, 24), (24, 0, 0), diffuse((0.35, 0.33, 0.30))),
             rectangle((0, 4, -4.2), (24, 0, 0), (0, 10, 0), diffuse((0.28, 0.31, 0.36))), *slats,
             sphere((-0.9, 0.7, 0.5), 0.7, glossy((0.55, 0.12, 0.08), 0.2, 0.1)),
             shape("cube", placed(scale((0.5, 0.9, 0.5)), rotate_y(30), translate((0.9, 0.9, -0.9))), diffuse((0.6, 0.58, 0.5))),
             sphere((1.2, 0.35, 1.2), 0.35, metal(SILVER)), lamp]
    write_scene(folder / "h-fog-spot.xml", "Fog in a hall, and a spotlight behind slats that throw their shadows into it.",
                (-1.0, 1.7, 7.6), (0.1, 1.75, 0), 50, parts, integrator="volpath")


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent / "scenes" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    for write in (write_spheres, write_water, write_mesh, write_door, write_hall, write_plates, write_fog):
        write(folder)


if __name__ == "__main__":
    main()
