"""Writers of what scripts/make_bench_scenes.py makes: Mitsuba scenes, meshes as PLY, maps as EXR.

The same input gives the same bytes.
"""
import struct
import zlib

import numpy as np

# --- meshes --------------------------------------------------------------------------------

class Mesh:
    """Triangles, counter-clockwise seen from outside; with normals if every part of it has them."""

    def __init__(self, positions=(), triangles=(), normals=None):
        self.positions = np.asarray(positions, float).reshape(-1, 3)
        self.triangles = np.asarray(triangles, int).reshape(-1, 3)
        self.normals = None if normals is None else np.asarray(normals, float).reshape(-1, 3)

    @staticmethod
    def joined(meshes):
        firsts = np.cumsum([0] + [len(m.positions) for m in meshes])
        normals = None if any(m.normals is None for m in meshes) else np.concatenate([m.normals for m in meshes])
        return Mesh(np.concatenate([m.positions for m in meshes]),
                    np.concatenate([m.triangles + first for m, first in zip(meshes, firsts)]), normals)

    def write(self, path):
        vertices = self.positions if self.normals is None else np.hstack([self.positions, self.normals])
        faces = np.empty(len(self.triangles), [("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, self.triangles
        names = "x y z nx ny nz".split()[:vertices.shape[1]]
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}",
                  *(f"property float {name}" for name in names),
                  f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
        path.write_bytes("\n".join(header).encode() + vertices.astype("<f4").tobytes() + faces.tobytes())


def normalized(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def grid(points, close_u, close_v):
    """Smooth triangles over points[u, v], whose outside is dP/du x dP/dv; a closed direction joins its last to its first."""
    def slope(axis, closed):
        if closed:
            return np.roll(points, -1, axis) - np.roll(points, 1, axis)
        return np.gradient(points, axis=axis)
    rows, columns = points.shape[:2]
    i, j = np.meshgrid(np.arange(rows if close_u else rows - 1), np.arange(columns if close_v else columns - 1), indexing="ij")
    i2, j2 = (i + 1) % rows, (j + 1) % columns
    a, b, c, d = (p * columns + q for p, q in ((i, j), (i2, j), (i2, j2), (i, j2)))
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    normals = normalized(np.cross(slope(0, close_u), slope(1, close_v)))
    return Mesh(points, triangles, normals)


def lathe(profile, segments, closed=False):
    """`profile`, points (radius, y), turned around the y axis; outside is to the right of its way. At the axis it is level."""
    profile = np.asarray(profile, float)
    if closed:
        slope = np.roll(profile, -1, 0) - np.roll(profile, 1, 0)
    else:
        slope = np.gradient(profile, axis=0)
    normal = normalized(np.stack([slope[:, 1], -slope[:, 0]], -1))
    if not closed:
        for end in (0, -1):
            if profile[end, 0] == 0:
                normal[end] = 0, np.sign(normal[end, 1])
    angle = 2 * np.pi * np.arange(segments) / segments
    def turned(p):
        return np.stack([p[:, None, 0] * np.cos(angle), p[:, None, 1] + 0 * angle, -p[:, None, 0] * np.sin(angle)], -1)
    rows = len(profile)
    i, j = np.meshgrid(np.arange(rows if closed else rows - 1), np.arange(segments), indexing="ij")
    i2, j2 = (i + 1) % rows, (j + 1) % segments
    a, b, c, d = (p * segments + q for p, q in ((i, j), (i, j2), (i2, j2), (i2, j)))
    # Those on the axis have no area: a circle of points that are one.
    first = np.stack([a, b, c], -1)[profile[i[:, 0], 0] > 0].reshape(-1, 3)
    second = np.stack([a, c, d], -1)[profile[i2[:, 0], 0] > 0].reshape(-1, 3)
    return Mesh(turned(profile), np.concatenate([first, second]), turned_normals(normal, angle))


def turned_normals(normal, angle):
    return np.stack([normal[:, None, 0] * np.cos(angle), normal[:, None, 1] + 0 * angle, -normal[:, None, 0] * np.sin(angle)], -1)


def tube(centres, radii, segments, closed=False):
    """A round rope around a curve that lies in a plane z = const or turns slowly enough for it."""
    slope = np.roll(centres, -1, 0) - np.roll(centres, 1, 0) if closed else np.gradient(centres, axis=0)
    tangent = normalized(slope)
    side = normalized(np.cross(tangent, (0, 0, 1)))
    other = np.cross(tangent, side)
    angle = -2 * np.pi * np.arange(segments) / segments
    points = centres[:, None] + np.broadcast_to(radii, len(centres))[:, None, None] * (
        side[:, None] * np.cos(angle)[:, None] + other[:, None] * np.sin(angle)[:, None])
    return grid(points, closed, True)


# --- maps ----------------------------------------------------------------------------------

def write_exr(path, pixels):
    """Half floats, compressed by ZIP, 16 rows at a time, as the OpenEXR file layout describes it."""
    height, width, _ = pixels.shape
    halves = pixels.astype("<f2")
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name + b"\0" + struct.pack("<i4x2i", 1, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    attributes = [("channels", "chlist", channels), ("compression", "compression", b"\3"), ("dataWindow", "box2i", box),
                  ("displayWindow", "box2i", box), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                  ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))]
    header = struct.pack("<2i", 20000630, 2) + b"".join(
        name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value for name, kind, value in attributes) + b"\0"
    blocks = []
    for first in range(0, height, 16):
        raw = np.ascontiguousarray(halves[first:first + 16, :, ::-1].transpose(0, 2, 1)).tobytes()
        packed = zlib.compress(difference_coded(raw), 9)
        data = packed if len(packed) < len(raw) else raw
        blocks.append(struct.pack("<2i", first, len(data)) + data)
    starts = np.cumsum([len(header) + 8 * len(blocks)] + [len(block) for block in blocks[:-1]])
    path.write_bytes(header + starts.astype("<u8").tobytes() + b"".join(blocks))


def difference_coded(raw):
    """Low bytes first, then high bytes, each as the difference to the one before plus 128."""
    data = np.frombuffer(raw, np.uint8)
    data = np.concatenate([data[0::2], data[1::2]])
    coded = data.copy()
    coded[1:] = data[1:] - data[:-1] + np.uint8(128)
    return coded.tobytes()


def map_directions(width, height):
    """The directions of a map's texels: rows from the zenith to the nadir, the first and the last at the poles."""
    azimuth = 2 * np.pi * (np.arange(width) + 0.5) / width
    theta = (np.pi * np.arange(height) / (height - 1))[:, None]
    return np.stack([np.sin(theta) * np.sin(azimuth), np.cos(theta) + 0 * azimuth, -np.sin(theta) * np.cos(azimuth)], -1)


# --- scenes --------------------------------------------------------------------------------

def numbers(values):
    return " ".join("0" if f"{v:.6g}" == "-0" else f"{v:.6g}" for v in np.ravel(values))


def rgb(name, value):
    return f'<rgb name="{name}" value="{numbers(np.broadcast_to(value, 3))}"/>'


def diffuse(reflectance):
    return f'<bsdf type="diffuse">{rgb("reflectance", reflectance)}</bsdf>'


def twosided(bsdf):
    return f'<bsdf type="twosided">{bsdf}</bsdf>'


def metal(reflectance, alpha=None):
    """A conductor that reflects the same at all angles; smooth without alpha."""
    inner = f'<string name="material" value="none"/>{rgb("specular_reflectance", reflectance)}'
    if alpha is None:
        return f'<bsdf type="conductor">{inner}</bsdf>'
    return f'<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="{alpha}"/>{inner}</bsdf>'


def plastic(reflectance, ior=1.5):
    return (f'<bsdf type="plastic"><float name="int_ior" value="{ior}"/><float name="ext_ior" value="1"/>'
            f'{rgb("diffuse_reflectance", reflectance)}</bsdf>')


def glossy(reflectance, weight, alpha, tint=0.9):
    """Diffuse, with a share of rough metal in it: a polish whose two parts any renderer can mix in the same way."""
    return f'<bsdf type="blendbsdf"><float name="weight" value="{weight}"/>{diffuse(reflectance)}{metal(tint, alpha)}</bsdf>'


def dielectric(inside, outside=1.0):
    return f'<bsdf type="dielectric"><float name="int_ior" value="{inside}"/><float name="ext_ior" value="{outside}"/></bsdf>'


def area(radiance):
    return f'<emitter type="area">{rgb("radiance", radiance)}</emitter>'


def named(bsdf, name):
    return bsdf.replace(">", f' id="{name}">', 1)


def ref(name):
    return f'<ref id="{name}"/>'


def shape(kind, *content):
    return f'<shape type="{kind}">' + "".join(content) + "</shape>"


def placed(*steps):
    return '<transform name="to_world">' + "".join(steps) + "</transform>"


def translate(v):
    return f'<translate value="{numbers(v)}"/>'


def rotate_y(degrees):
    return f'<rotate y="1" angle="{numbers([degrees])}"/>'


def scale(v):
    return f'<scale value="{numbers(v)}"/>'


def rectangle(centre, u, v, *content):
    """A parallelogram with edges u and v; its front, and what it emits, is on the side of u x v."""
    u, v = np.asarray(u, float), np.asarray(v, float)
    columns = np.stack([u / 2, v / 2, normalized(np.cross(u, v)), np.asarray(centre, float)], -1)
    return shape("rectangle", placed(f'<matrix value="{numbers(np.vstack([columns, (0, 0, 0, 1)]))}"/>'), *content)


def square_lamp(centre, target, edge, radiance):
    """A square that shines towards a point."""
    forward = normalized(np.subtract(target, centre))
    u = normalized(np.cross(forward, (0, 0, 1) if abs(forward[1]) > 0.9 else (0, 1, 0)))
    return rectangle(centre, u * edge, np.cross(forward, u) * edge, area(radiance))


def box(low, high, *content):
    low, high = np.asarray(low, float), np.asarray(high, float)
    return shape("cube", placed(scale((high - low) / 2), translate((high + low) / 2)), *content)


def sphere(centre, radius, *content):
    return shape("sphere", f'<point name="center" value="{numbers(centre)}"/><float name="radius" value="{radius}"/>', *content)


def ply(filename, *content):
    return shape("ply", f'<string name="filename" value="{filename}"/>', *content)


def look_at(origin, target):
    return f'<lookat origin="{numbers(origin)}" target="{numbers(target)}" up="0 1 0"/>'


def sky(filename, brightness=1):
    return f'<emitter type="envmap"><string name="filename" value="{filename}"/><float name="scale" value="{brightness}"/></emitter>'


def write_scene(path, comment, origin, target, fov, parts, max_depth=33, integrator="path"):
    """480 x 360 pixels; max_depth counts segments: one more than bounces. `fov` is horizontal, in degrees."""
    text = f"""<!-- {comment}
     Written by scripts/make_bench_scenes.py; change that, not this. -->
<scene version="3.0.0">
  <integrator type="{integrator}"><integer name="max_depth" value="{max_depth}"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="{numbers([fov])}"/>
    <string name="fov_axis" value="x"/>
    {placed(look_at(origin, target))}
    <sampler type="independent"><integer name="sample_count" value="64"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="480"/>
      <integer name="height" value="360"/>
      <rfilter type="box"/>
    </film>
  </sensor>
"""
    path.write_text(text + "".join(f"  {part}\n" for part in parts) + "</scene>\n")
