#!/usr/bin/env python3
"""Writes the generated files of scenes/: three COLLADA scenes, a texture and a sky.

Usage: python3 scripts/make_scenes.py [FOLDER]     (default: the repository's scenes/)

The output depends on nothing but this file. Lengths are metres, y is up. Scenes use the CGL
profile of COLLADA 1.4.1, whose own camera rule ("fit") looks at the centre of the scene's
bounding box from 1.5 diagonals away; every camera below is placed with that rule in mind.
"""

import math
import struct
import sys
import zlib
from pathlib import Path

# --- vectors -------------------------------------------------------------------------------

def add(a, b): return tuple(x + y for x, y in zip(a, b))
def sub(a, b): return tuple(x - y for x, y in zip(a, b))
def scale(a, s): return tuple(x * s for x in a)
def dot(a, b): return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return scale(a, 1 / math.sqrt(dot(a, a)))


def look_at(eye, target, size=(1, 1)):
    """Row-major node matrix at `eye` whose -z axis points at `target`; x and y scaled by `size`."""
    back = unit(sub(eye, target))
    helper = (0, 1, 0) if abs(back[1]) < 0.999 else (0, 0, -1)
    right = unit(cross(helper, back))
    up = cross(back, right)
    columns = (scale(right, size[0]), scale(up, size[1]), back, eye)
    return [column[row] for row in range(3) for column in columns] + [0, 0, 0, 1]


def fit_distance(low, high):
    """The distance from which the CGL camera rule looks at a scene with these bounds."""
    extent = sub(high, low)
    return 1.5 * math.sqrt(dot(extent, extent))


def degrees_across(half_width, distance):
    """Field of view, in degrees, of 2 x `half_width` seen head-on from `distance`."""
    return 2 * math.degrees(math.atan2(half_width, distance))


# --- meshes --------------------------------------------------------------------------------

class Mesh:
    """Polygons over three pools; a face is a list of (position, normal, uv) index triples."""

    def __init__(self):
        self.positions, self.normals, self.uvs, self.faces = [], [], [], []

    def add_flat(self, corners, uvs=None):
        """Adds a planar polygon, counter-clockwise seen from outside, with its own vertices."""
        first, normal = len(self.positions), len(self.normals)
        self.normals.append(unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]))))
        self.positions += corners
        uv = len(self.uvs)
        self.uvs += uvs or []
        self.faces.append([(first + i, normal, uv + i) for i in range(len(corners))])


def quad(*corners, uvs=None):
    mesh = Mesh()
    mesh.add_flat(list(corners), uvs)
    return mesh


def polyhedron(corners, faces, uvs=None):
    """A closed solid with flat faces and shared positions, each face a list of corner indices."""
    mesh = Mesh()
    mesh.positions, mesh.uvs = corners, uvs or []
    for face in faces:
        a, b, c = (corners[i] for i in face[:3])
        mesh.normals.append(unit(cross(sub(b, a), sub(c, a))))
        mesh.faces.append([(i, len(mesh.normals) - 1, k) for k, i in enumerate(face)])
    return mesh


def tube(surface, rows, columns, closed):
    """Triangles over surface(u, v), u and v in [0, 1), v around; outside is dS/dv x dS/du.

    `closed` joins the last row to the first; otherwise flat polygons cap the two ends. Normals
    are central differences of the surface itself, so they do not depend on the tessellation.
    """
    mesh, h = Mesh(), 1e-4
    last = rows if closed else rows - 1
    for i in range(rows):
        for j in range(columns):
            u, v = i / last, j / columns
            along = sub(surface(u + h, v), surface(u - h, v))
            around = sub(surface(u, v + h), surface(u, v - h))
            mesh.positions.append(surface(u, v))
            mesh.normals.append(unit(cross(around, along)))
    for i in range(last):
        for j in range(columns):
            near, far = i * columns, (i + 1) % rows * columns
            k = (j + 1) % columns
            a, b, c, d = near + j, near + k, far + k, far + j
            mesh.faces += [[(n, n, 0) for n in triangle] for triangle in ((a, b, c), (a, c, d))]
    if not closed:
        axis = unit(sub(surface(1, 0), surface(0, 0)))
        mesh.normals += [axis, scale(axis, -1)]
        top, bottom = len(mesh.normals) - 2, len(mesh.normals) - 1
        mesh.faces.append([(last * columns + j, top, 0) for j in range(columns)])
        mesh.faces.append([(j, bottom, 0) for j in reversed(range(columns))])
    return mesh


def knot_surface(u, v):
    """A three-lobed rope wound along a (2,3) torus knot, the trefoil, facing +z.

    The centre curve lies on a torus, whose normal is therefore perpendicular to the tangent and
    closes up with the curve: a ready-made frame for the cross-section.
    """
    major, minor, rope, turns = 0.80, 0.33, 0.185, 8
    t = 2 * math.pi * u
    theta, phi = 3 * t, 2 * t + math.pi / 2
    out = (math.cos(phi), math.sin(phi), 0)
    normal = add(scale(out, math.cos(theta)), (0, 0, math.sin(theta)))
    ring = major + minor * math.cos(theta)
    slide = add(scale(out, -math.sin(theta)), (0, 0, math.cos(theta)))
    tangent = unit(add(scale((-out[1], out[0], 0), 2 * ring), scale(slide, 3 * minor)))
    side = cross(tangent, normal)
    angle = 2 * math.pi * v
    radius = rope * (1 + 0.16 * math.cos(3 * (angle + turns * t)))
    section = add(scale(normal, radius * math.cos(angle)), scale(side, radius * math.sin(angle)))
    return add(add(scale(out, ring), (0, 0, minor * math.sin(theta))), section)


def column_surface(height, radius, lobes, turns):
    """A twisted fluted column, round at its ends, thickest and deepest cut half-way."""
    def surface(u, v):
        angle, swell = 2 * math.pi * v, math.sin(math.pi * u)
        flute = 1 + 0.28 * swell * math.cos(lobes * angle + 2 * math.pi * turns * u)
        r = radius * flute * (0.75 + 0.25 * swell)
        return (r * math.cos(angle), height * u, -r * math.sin(angle))
    return surface


def backdrop(half_width, front, back, height, radius, steps):
    """A studio cyclorama: a floor that turns upward into a wall through a quarter circle."""
    profile = [(0, front, 1, 0)]
    for i in range(steps + 1):
        a = 0.5 * math.pi * i / steps
        profile.append((radius * (1 - math.cos(a)), back + radius * (1 - math.sin(a)),
                        math.cos(a), math.sin(a)))
    profile.append((height, back, 0, 1))
    mesh = Mesh()
    for y, z, ny, nz in profile:
        mesh.positions += [(-half_width, y, z), (half_width, y, z)]
        mesh.normals += [(0, ny, nz)] * 2
    for i in range(0, 2 * len(profile) - 2, 2):
        mesh.faces.append([(n, n, 0) for n in (i, i + 1, i + 3, i + 2)])
    return mesh


def cube(size):
    """An axis-aligned cube on the ground, the whole texture on each face."""
    s = size / 2
    corners = [(x, y, z) for x in (-s, s) for y in (0, size) for z in (-s, s)]
    faces = [(1, 5, 7, 3), (4, 0, 2, 6), (0, 1, 3, 2), (5, 4, 6, 7), (3, 7, 6, 2), (0, 4, 5, 1)]
    return polyhedron(corners, faces, [(0, 0), (1, 0), (1, 1), (0, 1)])


def tetrahedron(edge):
    """A regular tetrahedron standing on the ground."""
    r, h = edge / math.sqrt(3), edge * math.sqrt(2 / 3)
    base = [(r * math.cos(a), 0, r * math.sin(a)) for a in (0, 2 * math.pi / 3, 4 * math.pi / 3)]
    return polyhedron(base + [(0, h, 0)], [(0, 1, 2), (1, 0, 3), (2, 1, 3), (0, 2, 3)])


def octahedron(radius):
    """A regular octahedron balanced on a corner."""
    r = radius
    corners = [(r, r, 0), (0, r, -r), (-r, r, 0), (0, r, r), (0, 2 * r, 0), (0, 0, 0)]
    ring = [(i, (i + 1) % 4) for i in range(4)]
    return polyhedron(corners, [(a, b, 4) for a, b in ring] + [(b, a, 5) for a, b in ring])


# --- COLLADA -------------------------------------------------------------------------------

def numbers(values, digits=6):
    """Space-separated decimals with trailing zeros and minus zero removed."""
    texts = (f"{v:.{digits}f}".rstrip("0").rstrip(".") for v in values)
    return " ".join("0" if t == "-0" else t for t in texts)


def source_xml(name, vectors, params, digits):
    flat = numbers((x for vector in vectors for x in vector), digits)
    width = len(params)
    param_xml = "".join(f'<param name="{p}" type="float"/>' for p in params)
    return f"""        <source id="{name}">
          <float_array id="{name}-array" count="{width * len(vectors)}">{flat}</float_array>
          <technique_common>
            <accessor source="#{name}-array" count="{len(vectors)}" stride="{width}">{param_xml}</accessor>
          </technique_common>
        </source>
"""


def faces_xml(name, mesh, inputs, columns):
    corners = (corner for face in mesh.faces for corner in face)
    indices = " ".join(str(corner[c]) for corner in corners for c in columns)
    sizes = {len(face) for face in mesh.faces}
    tag = "triangles" if sizes == {3} else "polylist"
    counts = " ".join(str(len(face)) for face in mesh.faces)
    vcount = "" if tag == "triangles" else f"          <vcount>{counts}</vcount>\n"
    return f"""        <{tag} material="surface" count="{len(mesh.faces)}">
{inputs}{vcount}          <p>{indices}</p>
        </{tag}>
"""


def mesh_xml(name, mesh, digits=4):
    """A <geometry>; where positions and normals share their indices, so do the inputs."""
    shared = all(c[0] == c[1] for face in mesh.faces for c in face)
    columns = [0] if shared else [0, 1]
    inputs = [("VERTEX", f"{name}-vertices", 0, ""), ("NORMAL", f"{name}-normals", 1 - shared, "")]
    text = source_xml(f"{name}-positions", mesh.positions, "XYZ", digits)
    text += source_xml(f"{name}-normals", mesh.normals, "XYZ", digits)
    if mesh.uvs:
        inputs.append(("TEXCOORD", f"{name}-uvs", len(columns), ' set="0"'))
        columns.append(2)
        text += source_xml(f"{name}-uvs", mesh.uvs, "ST", digits)
    input_xml = "".join(f'          <input semantic="{semantic}" source="#{source}" '
                        f'offset="{offset}"{extra}/>\n' for semantic, source, offset, extra in inputs)
    return f"""    <geometry id="{name}" name="{name}">
      <mesh>
{text}        <vertices id="{name}-vertices">
          <input semantic="POSITION" source="#{name}-positions"/>
        </vertices>
{faces_xml(name, mesh, input_xml, columns)}      </mesh>
    </geometry>
"""


def sphere_xml(name, radius):
    return f"""    <geometry id="{name}" name="{name}">
      <extra>
        <technique profile="CGL"><sphere><radius>{numbers([radius])}</radius></sphere></technique>
      </extra>
    </geometry>
"""


def effect_xml(name, diffuse, params="", cgl=""):
    """An <effect>: `diffuse` for every reader, the CGL technique for those that know it."""
    extra = f"""      <extra>
        <technique profile="CGL">{cgl}</technique>
      </extra>
""" if cgl else ""
    return f"""    <effect id="{name}-effect">
      <profile_COMMON>
{params}        <technique sid="common">
          <lambert><diffuse>{diffuse}</diffuse></lambert>
        </technique>
      </profile_COMMON>
{extra}    </effect>
"""


def colour_xml(rgb):
    return f"<color>{numbers(rgb)} 1</color>"


def diffuse(name, rgb):
    return name, effect_xml(name, colour_xml(rgb))


def emitter(name, radiance):
    cgl = f"<emission><radiance>{numbers(radiance)}</radiance></emission>"
    return name, effect_xml(name, colour_xml((0, 0, 0)), cgl=cgl)


def mirror(name, reflectance):
    cgl = f"<mirror><reflectance>{numbers(reflectance)}</reflectance></mirror>"
    return name, effect_xml(name, colour_xml((0.5, 0.5, 0.5)), cgl=cgl)


def glass(name, ior):
    cgl = ("<glass><reflectance>1 1 1</reflectance><transmittance>1 1 1</transmittance>"
           f"<roughness>0</roughness><ior>{ior}</ior></glass>")
    return name, effect_xml(name, colour_xml((0.5, 0.5, 0.5)), cgl=cgl)


def conductor(name, fallback, eta, k, alpha):
    cgl = (f"<microfacet><eta>{numbers(eta)}</eta><k>{numbers(k)}</k>"
           f"<alpha>{alpha}</alpha></microfacet>")
    return name, effect_xml(name, colour_xml(fallback), cgl=cgl)


def textured(name, image):
    params = f"""        <newparam sid="{image}-surface">
          <surface type="2D"><init_from>{image}-image</init_from></surface>
        </newparam>
        <newparam sid="{image}-sampler">
          <sampler2D>
            <source>{image}-surface</source>
            <wrap_s>WRAP</wrap_s>
            <wrap_t>WRAP</wrap_t>
          </sampler2D>
        </newparam>
"""
    return name, effect_xml(name, f'<texture texture="{image}-sampler" texcoord="UV"/>', params)


# Complex refractive indices at about 615, 550 and 465 nm, after Johnson and Christy,
# "Optical Constants of the Noble Metals", Physical Review B 6 (1972).
GOLD = ((0.143, 0.375, 1.442), (3.983, 2.386, 1.603))
COPPER = ((0.200, 0.924, 1.102), (3.913, 2.453, 2.142))


def object_node(name, geometry, material, transform=""):
    return f"""      <node id="{name}-node" name="{name}">
{transform}        <instance_geometry url="#{geometry}">
          <bind_material>
            <technique_common>
              <instance_material symbol="surface" target="#{material}">
                <bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="0"/>
              </instance_material>
            </technique_common>
          </bind_material>
        </instance_geometry>
      </node>
"""


def translate(x, y, z):
    return f"        <translate>{numbers((x, y, z))}</translate>\n"


def rotate_y(degrees):
    return f"        <rotate>0 1 0 {numbers([degrees])}</rotate>\n"


def matrix(values):
    return f"        <matrix>{numbers(values)}</matrix>\n"


def area_light(name, radiance, eye, target, size):
    """A one-sided rectangle of `size` at `eye` that faces `target`: (<light>, <node>)."""
    light = f"""    <light id="{name}" name="{name}">
      <technique_common><point><color>{numbers(radiance)}</color></point></technique_common>
      <extra>
        <technique profile="CGL"><area><color>{numbers(radiance)}</color></area></technique>
      </extra>
    </light>
"""
    node = f"""      <node id="{name}-node" name="{name}">
{matrix(look_at(eye, target, size))}        <instance_light url="#{name}"/>
      </node>
"""
    return light, node


def camera(xfov, eye, target):
    """A 4:3 camera: (<camera>, <node>)."""
    optics = f"""    <camera id="camera" name="camera">
      <optics>
        <technique_common>
          <perspective>
            <xfov>{numbers([xfov], 4)}</xfov>
            <aspect_ratio>1.333333</aspect_ratio>
            <znear>0.1</znear>
            <zfar>100</zfar>
          </perspective>
        </technique_common>
      </optics>
    </camera>
"""
    node = f"""      <node id="camera-node" name="camera">
{matrix(look_at(eye, target))}        <instance_camera url="#camera"/>
      </node>
"""
    return optics, node


def scene_xml(comment, view, materials, geometries, nodes, lights=(), images=()):
    """A whole document; `view` and `lights` are (library entry, node) pairs."""
    def library(kind, entries):
        text = "".join(entries)
        return f"  <library_{kind}>\n{text}  </library_{kind}>\n" if text else ""
    image_xml = [f'    <image id="{i}-image" name="{i}"><init_from>{i}.png</init_from></image>\n'
                 for i in images]
    material_xml = [f'    <material id="{name}" name="{name}"><instance_effect url="#{name}-effect"/>'
                    "</material>\n" for name, _ in materials]
    libraries = "".join((library("cameras", [view[0]]), library("lights", [l for l, _ in lights]),
                         library("images", image_xml), library("effects", [e for _, e in materials]),
                         library("materials", material_xml), library("geometries", geometries)))
    placed = view[1] + "".join(n for _, n in lights) + "".join(nodes)
    return f"""<?xml version="1.0" encoding="utf-8"?>
<!-- {comment}
     Written by scripts/make_scenes.py; change that, not this. -->
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>
    <contributor><author>The Etendue project</author></contributor>
    <created>2025-01-01T00:00:00Z</created>
    <modified>2025-01-01T00:00:00Z</modified>
    <unit name="meter" meter="1"/>
    <up_axis>Y_UP</up_axis>
  </asset>
{libraries}  <library_visual_scenes>
    <visual_scene id="scene" name="scene">
{placed}    </visual_scene>
  </library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
"""


# --- scenes --------------------------------------------------------------------------------

def cornell_spheres():
    """A 4:3 box around the origin, so that the CGL rule and the file's camera see the same."""
    w, h, d = 1.2, 0.9, 1.0
    a, b, c, e = (-w, -h, d), (w, -h, d), (w, h, d), (-w, h, d)
    f, g, i, j = (-w, -h, -d), (w, -h, -d), (w, h, -d), (-w, h, -d)
    walls = {"floor": (a, b, g, f), "ceiling": (e, j, i, c), "back": (f, g, i, j),
             "left": (a, f, j, e), "right": (b, c, i, g)}
    paint = {"left": "terracotta", "right": "teal"}
    y, lx, lz, radiance = h - 0.01, 0.4, 0.3, (10, 9.2, 8)
    lamp = quad((-lx, y, -lz), (lx, y, -lz), (lx, y, lz), (-lx, y, lz))
    distance = fit_distance((-w, -h, -d), (w, h, d))
    opening = degrees_across(0.99 * w, distance - d)
    return scene_xml(
        "A box with a glass and a mirror sphere. The lamp stands here twice, as the area light\n"
        "     and as the emissive quad in the same place: the profile makes them one light.",
        camera(opening, (0, 0, distance), (0, 0, 0)),
        [diffuse("white", (0.74, 0.73, 0.70)), diffuse("terracotta", (0.62, 0.16, 0.08)),
         diffuse("teal", (0.06, 0.33, 0.38)), emitter("lamp", radiance),
         glass("glass", 1.5), mirror("mirror", (0.95, 0.95, 0.95))],
        [mesh_xml(name, quad(*corners)) for name, corners in walls.items()]
        + [mesh_xml("lamp-quad", lamp), sphere_xml("ball", 0.38)],
        [object_node(name, name, paint.get(name, "white")) for name in walls]
        + [object_node("lamp", "lamp-quad", "lamp"),
           object_node("glass-ball", "ball", "glass", translate(0.48, 0.38 - h, 0.32)),
           object_node("mirror-ball", "ball", "mirror", translate(-0.46, 0.38 - h, -0.3))],
        [area_light("lamp-light", radiance, (0, y, 0), (0, -h, 0), (2 * lx, 2 * lz))])


def knot():
    """A golden trefoil of 43,200 triangles on a cyclorama under three soft boxes."""
    mesh = tube(knot_surface, 480, 45, closed=True)
    ground = -min(p[1] for p in mesh.positions)
    width, depth, height = 3.6, 2.0, 2.6
    centre = (0, height / 2, 0)
    distance = fit_distance((-width, 0, -depth), (width, height, depth))
    eye = add(centre, scale(unit((0, 0.17, 1)), distance))
    target = (0, 1.15, 0)
    return scene_xml(
        "A golden rope tied into a trefoil knot, in a studio.",
        camera(degrees_across(1.8, distance), eye, centre),
        [conductor("gold", (0.8, 0.6, 0.2), *GOLD, 0.15), diffuse("paper", (0.20, 0.31, 0.37))],
        [mesh_xml("knot", mesh), mesh_xml("backdrop", backdrop(width, depth, -depth, height, 1, 24))],
        [object_node("knot", "knot", "gold", translate(0, ground, 0) + rotate_y(-18)),
         object_node("backdrop", "backdrop", "paper")],
        [area_light("key", (17, 15.5, 13), (-3, 4, 3.5), target, (2.4, 1.8)),
         area_light("fill", (2.2, 2.4, 2.6), (4.5, 2.4, 4.5), target, (3, 4)),
         area_light("rim", (12, 12, 12), (1.2, 4.2, -1.5), target, (3, 0.5))])


def garden():
    """Objects in a row that recedes from the camera, for depth of field under sky.hdr."""
    eye, pitch = (-0.35, 0.85, 2.1), math.radians(-13)
    forward = (0, math.sin(pitch), math.cos(pitch))
    half = math.tan(math.radians(25))
    row = [  # distance, place across the picture (-1 to 1), name, material, radius or mesh
        (1.4, -0.66, "copper-ball", "copper", 0.14), (1.8, -0.22, "glass-ball", "glass", 0.19),
        (2.3, 0.16, "tile-cube", "tiles", cube(0.36)), (2.9, -0.62, "mirror-ball", "mirror", 0.30),
        (3.6, 0.62, "blue-column", "blue", tube(column_surface(0.95, 0.22, 4, 0.6), 48, 48, False)),
        (4.4, -0.12, "saffron-ball", "saffron", 0.34),
        (5.2, 0.27, "tetrahedron", "rose", tetrahedron(0.9)),
        (6.0, -0.40, "white-column", "white",
         tube(column_surface(1.25, 0.26, 6, -0.5), 56, 72, False)),
        (7.0, 0.08, "octahedron", "leaf", octahedron(0.5)), (8.0, 0.47, "gold-ball", "gold", 0.55)]
    geometries, nodes = [], []
    for distance, across, name, material, shape in row:
        ball = isinstance(shape, float)
        geometries.append(sphere_xml(name, shape) if ball else mesh_xml(name, shape))
        place = translate(eye[0] + across * half * distance, shape if ball else 0, eye[2] - distance)
        nodes.append(object_node(name, name, material, place + ("" if ball else rotate_y(25))))
    w, near, far = 5, 3, -9
    terrace = quad((-w, 0, near), (w, 0, near), (w, 0, far), (-w, 0, far),
                   uvs=[(0, 0), (w, 0), (w, (near - far) / 2), (0, (near - far) / 2)])
    return scene_xml(
        "Things at 1.4 to 8 m from the camera. The file has no lights: it is meant for the sky\n"
        "     of sky.hdr (option env), the camera placement 'file', and a lens, for example\n"
        "     of radius 0.03 focused at 2.9.",
        camera(50, eye, add(eye, (forward[0], forward[1], -forward[2]))),
        [conductor("copper", (0.7, 0.4, 0.3), *COPPER, 0.15), glass("glass", 1.5),
         mirror("mirror", (0.95, 0.95, 0.95)), conductor("gold", (0.8, 0.6, 0.2), *GOLD, 0.15),
         textured("tiles", "tiles"), diffuse("blue", (0.08, 0.20, 0.48)),
         diffuse("saffron", (0.72, 0.42, 0.06)), diffuse("rose", (0.58, 0.16, 0.22)),
         diffuse("leaf", (0.16, 0.38, 0.12)), diffuse("white", (0.58, 0.57, 0.54))],
        geometries + [mesh_xml("terrace", terrace)],
        nodes + [object_node("terrace", "terrace", "tiles")], images=["tiles"])


# --- images --------------------------------------------------------------------------------

def hash_unit(*integers):
    """A repeatable number in [0, 1) for a tuple of integers."""
    return zlib.crc32(struct.pack(f"{len(integers)}i", *integers)) / 2**32


def tile_texel(x, y, tile=64, grout=3):
    """8-bit sRGB of a 4 x 4 floor: stone in two tones, one blue tile top left, grey joints."""
    column, row = x // tile, y // tile
    edge = min(x % tile, y % tile, tile - 1 - x % tile, tile - 1 - y % tile)
    if edge < grout:
        return (70, 67, 64)
    stone = (128, 118, 104) if (column + row) % 2 else (106, 97, 86)
    base = (44, 80, 124) if (column, row) == (0, 0) else stone
    shade = 0.92 + 0.16 * hash_unit(column, row)
    return tuple(int(c * shade) for c in base)


def png_bytes(size, texel):
    """An 8-bit RGB PNG (ISO/IEC 15948) of size x size texels."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(size)) for y in range(size))
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0")
            + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


TURBIDITY = 3
SUN_ZENITH = math.radians(90 - 35)
SUN_AZIMUTH = math.radians(-65)  # from -z towards +x: low on the left, a little ahead
SUN_RADIUS = math.radians(0.9)  # 3.4 times the real one, to cover a handful of texels
ZENITH_RADIANCE = 0.3
SUN_TO_SKY = 5  # ratio of the two irradiances on the ground
GROUND_ALBEDO = 0.1


def perez(coefficients, cos_zenith, gamma):
    """The Perez formula as in Preetham et al. 1999, equation 3."""
    a, b, c, d, e = coefficients
    return ((1 + a * math.exp(b / cos_zenith))
            * (1 + c * math.exp(d * gamma) + e * math.cos(gamma) ** 2))


def sky_model():
    """(zenith value, Perez coefficients) of x, y and Y: Preetham et al. 1999, appendix A.2."""
    t, s = TURBIDITY, SUN_ZENITH
    def chromaticity(table):
        return sum(t ** (2 - i) * sum(k * s ** (3 - j) for j, k in enumerate(line))
                   for i, line in enumerate(table))
    x = chromaticity(((0.00166, -0.00375, 0.00209, 0), (-0.02903, 0.06377, -0.03202, 0.00394),
                      (0.11693, -0.21196, 0.06052, 0.25886)))
    y = chromaticity(((0.00275, -0.00610, 0.00317, 0), (-0.04214, 0.08970, -0.04153, 0.00516),
                      (0.15346, -0.26756, 0.06670, 0.26688)))
    return ((x, (-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125,
                 -0.0641 * t - 0.8989, -0.0033 * t + 0.0452)),
            (y, (-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102,
                 -0.0441 * t - 1.6537, -0.0109 * t + 0.0529)),
            (ZENITH_RADIANCE, (0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251,
                               0.1206 * t - 2.5771, -0.0670 * t + 0.3703)))


def rec709(x, y, luminance):
    """Linear Rec. 709 of a CIE xyY colour, clipped at zero (ITU-R BT.709 primaries, D65)."""
    xx, yy, zz = x / y * luminance, luminance, (1 - x - y) / y * luminance
    return tuple(max(0.0, c) for c in (3.2404542 * xx - 1.5371385 * yy - 0.4985314 * zz,
                                       -0.9692660 * xx + 1.8760108 * yy + 0.0415560 * zz,
                                       0.0556434 * xx - 0.2040259 * yy + 1.0572252 * zz))


def sky_radiance(model, direction, sun):
    """Preetham et al. 1999, equation 4, for x, y and Y."""
    gamma = math.acos(max(-1.0, min(1.0, dot(direction, sun))))
    xyy = [zenith * perez(k, direction[1], gamma) / perez(k, 1, SUN_ZENITH) for zenith, k in model]
    return rec709(*xyy)


def sun_colour():
    """Transmittance of the air at 610, 550 and 465 nm: Preetham et al. 1999, appendix A.1."""
    mass = 1 / (math.cos(SUN_ZENITH) + 0.15 * (93.885 - math.degrees(SUN_ZENITH)) ** -1.253)
    beta = 0.04608 * TURBIDITY - 0.04586
    return tuple(math.exp(-mass * (0.008735 * w ** -4.08 + beta * w ** -1.3))
                 for w in (0.61, 0.55, 0.465))


def sky_direction(x, y, width, height):
    """u = atan2(x, -z) / 2 pi and v = acos(y) / pi, the top row at the zenith."""
    phi, theta = 2 * math.pi * x / width, math.pi * y / height
    return (math.sin(theta) * math.sin(phi), math.cos(theta), -math.sin(theta) * math.cos(phi))


def sun_coverage(x, y, width, height, sun, grid=8):
    """The part of texel (x, y) that the sun's disc covers."""
    if dot(sky_direction(x + 0.5, y + 0.5, width, height), sun) < math.cos(3 * SUN_RADIUS):
        return 0
    offsets = [(i + 0.5) / grid for i in range(grid)]
    return sum(dot(sky_direction(x + i, y + j, width, height), sun) > math.cos(SUN_RADIUS)
               for i in offsets for j in offsets) / grid**2


def luminance(rgb):
    return dot((0.2126, 0.7152, 0.0722), rgb)


def sky_rows(width, height):
    """Rows of RGB radiance: sky and sun above the horizon, a grey ground that they light below."""
    model = sky_model()
    sun = sky_direction(SUN_AZIMUTH / (2 * math.pi), SUN_ZENITH / math.pi, 1, 1)
    rows, coverage, sky_light, sun_light = [], [], 0, 0
    for y in range(height // 2):
        cos_theta = math.cos(math.pi * (y + 0.5) / height)
        texel = 2 * math.pi**2 / (width * height) * math.sqrt(1 - cos_theta**2)
        row = [sky_radiance(model, sky_direction(x + 0.5, y + 0.5, width, height), sun)
               for x in range(width)]
        cover = [sun_coverage(x, y, width, height, sun) for x in range(width)]
        sky_light += sum(luminance(rgb) for rgb in row) * cos_theta * texel
        sun_light += sum(cover) * cos_theta * texel
        rows.append(row)
        coverage.append(cover)
    tint = sun_colour()
    disc = scale(tint, SUN_TO_SKY * sky_light / sun_light / luminance(tint))
    rows = [[add(sky, scale(disc, c)) for sky, c in zip(*pair)] for pair in zip(rows, coverage)]
    ground = GROUND_ALBEDO / math.pi * (1 + SUN_TO_SKY) * sky_light
    return rows + [[(ground,) * 3] * width] * (height - height // 2)


def rgbe(rgb):
    """Ward, "Real Pixels", Graphics Gems II (1991): mantissas that share one exponent."""
    exponent = math.frexp(max(rgb))[1]
    if max(rgb) * 2.0 ** (8 - exponent) >= 255.5:
        exponent += 1
    return [int(c * 2.0 ** (8 - exponent) + 0.5) for c in rgb] + [exponent + 128]


def run_lengths(values):
    """One channel of a scanline: runs as (128 + n, value), other bytes as (n, bytes)."""
    out, literal, i = bytearray(), bytearray(), 0
    def flush():
        if literal:
            out.extend([len(literal), *literal])
            literal.clear()
    while i < len(values):
        n = 1
        while n < 127 and i + n < len(values) and values[i + n] == values[i]:
            n += 1
        if n > 2:
            flush()
            out.extend([128 + n, values[i]])
        else:
            literal.extend(values[i:i + n])
            if len(literal) > 120:
                flush()
        i += n
    flush()
    return bytes(out)


def hdr_bytes(rows):
    """A Radiance picture with run-length encoded scanlines."""
    out = [f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {len(rows)} +X {len(rows[0])}\n".encode()]
    for row in rows:
        out.append(struct.pack(">BBH", 2, 2, len(row)))
        out += [run_lengths(channel) for channel in zip(*map(rgbe, row))]
    return b"".join(out)


def main():
    default = Path(__file__).resolve().parent.parent / "scenes"
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    folder.mkdir(parents=True, exist_ok=True)
    for make in (cornell_spheres, knot, garden):
        text = make().encode()
        (folder / (make.__name__.replace("_", "-") + ".dae")).write_bytes(text)
    (folder / "tiles.png").write_bytes(png_bytes(256, tile_texel))
    (folder / "sky.hdr").write_bytes(hdr_bytes(sky_rows(512, 256)))


if __name__ == "__main__":
    main()
