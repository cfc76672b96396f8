"""Reads Mitsuba 3 scenes, as far as scenes/bench/ needs it, into plain objects for other renderers."""
import re
import struct
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


class Unknown(Exception):
    """Something that this reader, or the renderer it serves, cannot express."""


@dataclass
class Item:
    """One element with a type: its named values, and what stands in it."""
    tag: str
    type: str
    name: str
    values: dict = field(default_factory=dict)
    children: list = field(default_factory=list)

    def child(self, tag, name=None):
        found = [c for c in self.children if c.tag == tag and (name is None or c.name == name)]
        return found[0] if found else None

    def get(self, name, missing=None):
        return self.values.get(name, missing)

    def rgb(self, name, missing):
        return np.broadcast_to(np.asarray(self.values.get(name, missing), float), 3)


def read_scene(path, definitions=()):
    """The <scene> with <default>s and references filled in; `definitions` gives $names their values, as (name, value)."""
    path = Path(path)
    root = ElementTree.parse(path).getroot()
    names = {e.get("name"): e.get("value") for e in root.findall("default")}
    names.update(definitions)
    known = {}

    def text(value):
        return re.sub(r"\$(\w+)", lambda m: names[m[1]], value)

    def item(element):
        one = Item(element.tag, element.get("type", ""), element.get("name", ""))
        if "id" in element.attrib:
            known[element.get("id")] = one
        for child in element:
            value = text(child.get("value", ""))
            if child.tag in ("float", "integer"):
                one.values[child.get("name")] = float(value) if child.tag == "float" else int(value)
            elif child.tag == "boolean":
                one.values[child.get("name")] = value == "true"
            elif child.tag == "string":
                is_file = child.get("name") == "filename"
                one.values[child.get("name")] = str(path.parent / value) if is_file else value
            elif child.tag in ("rgb", "point", "vector"):
                one.values[child.get("name")] = np.array([float(v) for v in value.split()])
            elif child.tag == "transform":
                one.values[child.get("name")] = transform(child)
            elif child.tag == "ref":
                one.children.append(known[child.get("id")])
            elif child.tag != "default":
                one.children.append(item(child))
        return one

    return item(root)


# --- transforms ----------------------------------------------------------------------------

def transform(element):
    matrix = np.eye(4)
    for step in element:
        matrix = one_step(step) @ matrix
    return matrix


def triple(step, attribute, missing=None):
    return np.array([float(v) for v in step.get(attribute, missing).split()])


def one_step(step):
    m = np.eye(4)
    if step.tag == "matrix":
        return triple(step, "value").reshape(4, 4)
    if step.tag == "translate":
        m[:3, 3] = triple(step, "value")
    elif step.tag == "scale":
        m[:3, :3] = np.diag(np.broadcast_to(triple(step, "value"), 3))
    elif step.tag == "rotate":
        m[:3, :3] = rotation(np.array([float(step.get(axis, "0")) for axis in "xyz"]), np.radians(float(step.get("angle"))))
    elif step.tag == "lookat":
        m = look_at(triple(step, "origin"), triple(step, "target"), triple(step, "up", "0 1 0"))
    else:
        raise Unknown(f"a <{step.tag}> in a transform")
    return m


def rotation(axis, angle):
    """By Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def look_at(origin, target, up):
    """+z looks at the target, +x to the left."""
    forward = (target - origin) / np.linalg.norm(target - origin)
    left = np.cross(up, forward)
    left /= np.linalg.norm(left)
    m = np.eye(4)
    m[:3] = np.stack([left, np.cross(forward, left), forward, origin], -1)
    return m


# --- shapes --------------------------------------------------------------------------------

@dataclass
class Mesh:
    """Polygons of one size around their outside counter-clockwise; where smooth, normals are to be interpolated."""
    positions: np.ndarray
    faces: np.ndarray
    smooth: bool


def read_ply(path):
    """Binary, little-endian, vertices of floats only, triangles only: positions, triangles, whether it has normals."""
    data = Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode()
    vertices, faces = (int(re.search(rf"element {what} (\d+)", header)[1]) for what in ("vertex", "face"))
    properties = re.findall(r"property float (\w+)", header)
    table = np.frombuffer(data, "<f4", vertices * len(properties), end).reshape(vertices, -1)
    corners = np.frombuffer(data, [("count", "u1"), ("corners", "<i4", 3)], faces, end + table.nbytes)
    if np.any(corners["count"] != 3):
        raise Unknown(f"{path}: faces that are no triangles")
    return table[:, :3], corners["corners"], "nx" in properties


def cube():
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    return corners, np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def ball(columns=192, rows=96):
    """A unit sphere of flat quads, thin ones at the poles; they are to be shaded smooth."""
    theta, phi = np.pi * (np.arange(rows + 1)) / rows, 2 * np.pi * np.arange(columns) / columns
    ring = np.stack([np.sin(theta)[1:-1, None] * np.cos(phi), np.sin(theta)[1:-1, None] * np.sin(phi),
                     np.cos(theta)[1:-1, None] + 0 * phi], -1).reshape(-1, 3)
    positions = np.vstack([ring, (0, 0, 1), (0, 0, -1)])
    i, j = np.meshgrid(np.arange(rows - 2), np.arange(columns), indexing="ij")
    k = (j + 1) % columns
    upper, lower = i * columns, (i + 1) * columns
    faces = np.concatenate([np.stack([upper + j, lower + j, lower + k], -1).reshape(-1, 3),
                            np.stack([upper + j, lower + k, upper + k], -1).reshape(-1, 3)])
    j, k, last = np.arange(columns), (np.arange(columns) + 1) % columns, (rows - 2) * columns
    top, bottom = len(ring), len(ring) + 1
    caps = np.concatenate([np.stack([0 * j + top, j, k], -1), np.stack([0 * j + bottom, last + k, last + j], -1)])
    return positions, np.concatenate([faces, caps])


def disk(segments=256):
    phi = 2 * np.pi * np.arange(segments) / segments
    return np.stack([np.cos(phi), np.sin(phi), 0 * phi], -1), np.arange(segments)[None]


def shape_mesh(shape):
    """The shape's surface in world space."""
    smooth = False
    if shape.type == "rectangle":
        positions, faces = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float), np.array([(0, 1, 2, 3)])
    elif shape.type == "cube":
        positions, faces = cube()
    elif shape.type == "disk":
        positions, faces = disk()
    elif shape.type == "sphere":
        positions, faces = ball()
        positions = positions * shape.get("radius", 1.0) + shape.get("center", np.zeros(3))
        smooth = True
    elif shape.type == "ply":
        positions, faces, smooth = read_ply(shape.get("filename"))
        smooth = smooth and not shape.get("face_normals", False)
    else:
        raise Unknown(f"the shape {shape.type}")
    to_world = shape.get("to_world", np.eye(4))
    positions = positions @ to_world[:3, :3].T + to_world[:3, 3]
    if (np.linalg.det(to_world[:3, :3]) < 0) != shape.get("flip_normals", False):
        faces = faces[:, ::-1]
    return Mesh(positions, faces, smooth)
