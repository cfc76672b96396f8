"""Runs in Blender: shows a Mitsuba scene to Cycles as it is, and renders it.

Usage: blender -b --factory-startup --python cycles_render.py -- SCENE OUT.exr --spp N [--seed N] [--threads N] [-D NAME=VALUE]

Prints one line, "cycles: " and JSON: processor seconds of a sample per pixel, and of what a render does besides (synchronising the
scene, building trees); and what Cycles cannot express. Written for Blender 3.4, whose Cycles has no light tree.
"""
import argparse
import json
import math
import os
import sys
from pathlib import Path

import bpy
import mathutils
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from mitsuba_scene import Unknown, read_scene, shape_mesh

notes = []  # what is only like the original


def note(text):
    if text not in notes:
        notes.append(text)


def colour(rgb):
    return (*map(float, rgb), 1.0)


# --- materials -----------------------------------------------------------------------------

class Shader:
    """The nodes of one material, lamp or world."""

    def __init__(self, tree):
        self.tree = tree
        self.tree.nodes.clear()

    def node(self, kind, settings=None, **inputs):
        """Inputs by name, underscores for spaces: a number, a colour, or the socket of another node."""
        node = self.tree.nodes.new(kind)
        for key, value in (settings or {}).items():
            setattr(node, key, value)
        for key, value in inputs.items():
            self.connect(value, node.inputs[key.replace("_", " ")])
        return node

    def connect(self, value, socket):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def math(self, operation, a, b=0.0):
        node = self.node("ShaderNodeMath", {"operation": operation})
        self.connect(a, node.inputs[0])
        self.connect(b, node.inputs[1])
        return node.outputs[0]

    def mix(self, weight, first, second):
        node = self.node("ShaderNodeMixShader", Fac=weight)
        self.connect(first, node.inputs[1])
        self.connect(second, node.inputs[2])
        return node.outputs[0]


def fresnel_mean(eta):
    """Of a dielectric's reflectance over a diffuse hemisphere."""
    c = (np.arange(4096) + 0.5) / 4096
    t = 1 - (1 - c * c) / eta**2
    root = np.sqrt(np.maximum(t, 0))
    f = 0.5 * (((eta * c - root) / (eta * c + root))**2 + ((c - eta * root) / (c + eta * root))**2)
    return float(np.mean(np.where(t > 0, f, 1) * 2 * c))


def ior_of(bsdf, missing):
    inside, outside = bsdf.get("int_ior", missing), bsdf.get("ext_ior", 1.000277)
    if isinstance(inside, str) or isinstance(outside, str):
        raise Unknown("an index of refraction by name")
    return inside / outside


def glossy(shader, bsdf):
    if bsdf.get("material", "") != "none":
        note("metals with an index: Cycles 3.4 has metals of one colour only")
    settings, inputs = {"distribution": "SHARP"}, {"Color": colour(bsdf.rgb("specular_reflectance", 1))}
    if bsdf.type == "roughconductor":
        settings = {"distribution": "GGX" if bsdf.get("distribution", "beckmann") == "ggx" else "BECKMANN"}
        inputs["Roughness"] = math.sqrt(bsdf.get("alpha", 0.1))
    return shader.node("ShaderNodeBsdfGlossy", settings, **inputs).outputs[0]


def plastic(shader, bsdf):
    note("plastic: its diffuse part does not darken where light comes in flat; the mean over directions is the same")
    ior = ior_of(bsdf, 1.49)
    base = bsdf.rgb("diffuse_reflectance", 0.5)
    inside = 1 - (1 - fresnel_mean(ior)) / ior**2
    base = base * (1 - fresnel_mean(ior)) / ior**2 / (1 - (base if bsdf.get("nonlinear") else 1) * inside)
    fresnel = shader.node("ShaderNodeFresnel", IOR=ior).outputs[0]
    return shader.mix(fresnel, shader.node("ShaderNodeBsdfDiffuse", Color=colour(base)).outputs[0],
                      shader.node("ShaderNodeBsdfGlossy", {"distribution": "SHARP"}, Color=colour((1, 1, 1))).outputs[0])


def surface(shader, bsdf):
    """The socket of a closure; None where light goes straight through."""
    if bsdf.type == "twosided":
        return surface(shader, bsdf.child("bsdf"))
    if bsdf.type == "diffuse":
        return shader.node("ShaderNodeBsdfDiffuse", Color=colour(bsdf.rgb("reflectance", 0.5))).outputs[0]
    if bsdf.type in ("conductor", "roughconductor"):
        return glossy(shader, bsdf)
    if bsdf.type == "dielectric":
        return shader.node("ShaderNodeBsdfGlass", {"distribution": "SHARP"}, Color=colour((1, 1, 1)), IOR=ior_of(bsdf, 1.5046)).outputs[0]
    if bsdf.type == "plastic":
        return plastic(shader, bsdf)
    if bsdf.type == "blendbsdf":
        return shader.mix(bsdf.get("weight"), *(surface(shader, inner) for inner in bsdf.children))
    if bsdf.type == "principled":
        note("principled: Cycles has the edition of 2012")
        return shader.node("ShaderNodeBsdfPrincipled", Base_Color=colour(bsdf.rgb("base_color", 0.5)), Roughness=bsdf.get("roughness", 0.5),
                           Metallic=bsdf.get("metallic", 0.0)).outputs[0]
    if bsdf.type == "null":
        return None
    raise Unknown(f"the bsdf {bsdf.type}")


def volume(shader, medium):
    sigma, albedo = medium.rgb("sigma_t", 1), medium.rgb("albedo", 0.75)
    if medium.type != "homogeneous" or np.ptp(sigma) > 0:
        raise Unknown("a medium that is not grey and homogeneous")
    phase = medium.child("phase")
    g = phase.get("g", 0.8) if phase is not None and phase.type == "hg" else 0.0
    density = float(sigma[0]) * medium.get("scale", 1.0)
    scatter = shader.node("ShaderNodeVolumeScatter", Color=colour(albedo), Density=density, Anisotropy=g)
    absorb = shader.node("ShaderNodeVolumeAbsorption", Color=colour(albedo), Density=density)
    add = shader.node("ShaderNodeAddShader")
    shader.connect(scatter.outputs[0], add.inputs[0])
    shader.connect(absorb.outputs[0], add.inputs[1])
    return add.outputs[0]


def material_of(shape):
    material = bpy.data.materials.new("material")
    material.use_nodes = True
    material.cycles.homogeneous_volume = True
    material.cycles.volume_sampling = "MULTIPLE_IMPORTANCE"
    shader = Shader(material.node_tree)
    output = shader.node("ShaderNodeOutputMaterial")
    bsdf, emitter, medium = shape.child("bsdf"), shape.child("emitter"), shape.child("medium", "interior")
    if emitter is not None:
        radiance = emitter.rgb("radiance", 1)
        strength = float(max(radiance))
        closure = shader.node("ShaderNodeEmission", Color=colour(radiance / strength), Strength=strength).outputs[0]
    else:
        closure = shader.node("ShaderNodeBsdfDiffuse", Color=colour((0.5,) * 3)).outputs[0] if bsdf is None else surface(shader, bsdf)
    if closure is not None:
        shader.connect(closure, output.inputs["Surface"])
    if medium is not None:
        shader.connect(volume(shader, medium), output.inputs["Volume"])
    return material


# --- things --------------------------------------------------------------------------------

def add_object(data, matrix=np.eye(4)):
    thing = bpy.data.objects.new("object", data)
    thing.matrix_world = mathutils.Matrix(matrix.tolist())
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_mesh(mesh, material):
    data = bpy.data.meshes.new("mesh")
    data.from_pydata(mesh.positions.tolist(), [], mesh.faces.tolist())
    data.polygons.foreach_set("use_smooth", np.full(len(data.polygons), mesh.smooth))
    data.materials.append(material)
    thing = add_object(data)
    thing.cycles.shadow_terminator_geometry_offset = 0
    thing.cycles.shadow_terminator_offset = 0


def orthonormal(z, x, origin):
    m = np.eye(4)
    x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
    m[:3] = np.stack([x, np.cross(z, x), z, origin], -1)
    return m


def add_rectangle_lamp(shape):
    """A lamp, which Cycles samples by solid angle; its back is black and stops light like the original's."""
    to_world = shape.get("to_world", np.eye(4))
    u, v, origin = to_world[:3, 0], to_world[:3, 1], to_world[:3, 3]
    if abs(u @ v) > 1e-4 * np.linalg.norm(u) * np.linalg.norm(v):
        raise Unknown("a lamp that is a sheared rectangle")
    normal = np.cross(u, v) * (-1 if shape.get("flip_normals", False) else 1)
    radiance = shape.child("emitter").rgb("radiance", 1)
    data = bpy.data.lights.new("lamp", "AREA")
    data.shape = "RECTANGLE"
    data.size, data.size_y = 2 * float(np.linalg.norm(u)), 2 * float(np.linalg.norm(v))
    data.energy = 4 * data.size * data.size_y * float(max(radiance))  # what Blender calls the watts of this radiance
    data.color = radiance / max(radiance)
    lamp = add_object(data, orthonormal(-normal, u, origin))
    lamp.visible_camera = True
    back = shape_mesh(shape)
    back.positions = back.positions - 1e-4 * float(np.linalg.norm(u)) * normal / np.linalg.norm(normal)
    black = bpy.data.materials.new("black")
    black.use_nodes = True
    shader = Shader(black.node_tree)
    output = shader.node("ShaderNodeOutputMaterial")
    shader.connect(shader.node("ShaderNodeBsdfDiffuse", Color=colour((0, 0, 0))).outputs[0], output.inputs["Surface"])
    add_mesh(back, black)


def add_point_lamp(emitter, position, kind="POINT"):
    data = bpy.data.lights.new("lamp", kind)
    intensity = emitter.rgb("intensity", 1)
    data.energy = 4 * math.pi * float(max(intensity))
    data.color = intensity / max(intensity)
    data.shadow_soft_size = 0
    return data, position


def add_spot(emitter):
    """Cycles' own beam falls with the cosine and has another edge: both are undone in nodes."""
    to_world = emitter.get("to_world", np.eye(4))
    data, position = add_point_lamp(emitter, to_world[:3, 3], "SPOT")
    cutoff = math.radians(emitter.get("cutoff_angle", 20.0))
    beam = math.radians(emitter.get("beam_width", math.degrees(cutoff) * 0.75))
    data.spot_size, data.spot_blend = 2 * cutoff, 0
    data.use_nodes = True
    shader = Shader(data.node_tree)
    normal = shader.node("ShaderNodeTexCoord").outputs["Normal"]
    cosine = shader.math("ABSOLUTE", shader.node("ShaderNodeSeparateXYZ", Vector=normal).outputs["Z"])
    fall = shader.math("DIVIDE", shader.math("SUBTRACT", cutoff, shader.math("ARCCOSINE", shader.math("MINIMUM", cosine, 1.0))),
                       max(cutoff - beam, 1e-6))
    strength = shader.math("DIVIDE", shader.math("MINIMUM", shader.math("MAXIMUM", fall, 0.0), 1.0), cosine)
    emission = shader.node("ShaderNodeEmission", Color=colour((1, 1, 1)), Strength=strength)
    output = shader.node("ShaderNodeOutputLight")
    shader.connect(emission.outputs[0], output.inputs["Surface"])
    add_object(data, orthonormal(-to_world[:3, 2], to_world[:3, 0], position))


def add_world(emitter):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    shader = Shader(world.node_tree)
    output = shader.node("ShaderNodeOutputWorld")
    if emitter is None:
        background = shader.node("ShaderNodeBackground", Color=colour((0, 0, 0)))
    elif emitter.type == "constant":
        background = shader.node("ShaderNodeBackground", Color=colour(emitter.rgb("radiance", 1)))
    else:
        background = map_background(shader, emitter, world)
    shader.connect(background.outputs[0], output.inputs["Surface"])


def map_background(shader, emitter, world):
    """Mitsuba's maps have their first and last row at the poles; Blender's begin half a row from there."""
    if not np.allclose(emitter.get("to_world", np.eye(4)), np.eye(4)):
        raise Unknown("a turned environment map")
    image = bpy.data.images.load(emitter.get("filename"))
    width, height = image.size
    xyz = shader.node("ShaderNodeSeparateXYZ", Vector=shader.node("ShaderNodeTexCoord").outputs["Generated"]).outputs
    u = shader.math("DIVIDE", shader.math("ARCTAN2", xyz["X"], shader.math("MULTIPLY", xyz["Z"], -1.0)), 2 * math.pi)
    theta = shader.math("ARCCOSINE", shader.math("MAXIMUM", shader.math("MINIMUM", xyz["Y"], 1.0), -1.0))
    v = shader.math("SUBTRACT", 1 - 0.5 / height, shader.math("MULTIPLY", theta, (height - 1) / (height * math.pi)))
    place = shader.node("ShaderNodeCombineXYZ", X=u, Y=v).outputs[0]
    texture = shader.node("ShaderNodeTexImage", {"image": image, "interpolation": "Linear", "extension": "REPEAT"}, Vector=place)
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = max(width, 1024)
    return shader.node("ShaderNodeBackground", Color=texture.outputs["Color"], Strength=emitter.get("scale", 1.0))


def add_camera(sensor):
    data = bpy.data.cameras.new("camera")
    to_world = sensor.get("to_world")
    if sensor.type != "perspective" or sensor.get("fov_axis", "x") != "x":
        raise Unknown("a camera that is not a perspective one with a horizontal fov")
    data.sensor_fit = "HORIZONTAL"
    data.angle_x = math.radians(sensor.get("fov"))
    data.clip_start, data.clip_end = 0.01, 1e4
    bpy.context.scene.camera = add_object(data, orthonormal(-to_world[:3, 2], -to_world[:3, 0], to_world[:3, 3]))


def build(scene):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    infinite = None
    for child in scene.children:
        if child.tag == "shape":
            if child.child("emitter") is not None and child.type == "rectangle":
                add_rectangle_lamp(child)
            else:
                add_mesh(shape_mesh(child), material_of(child))
                if child.type == "sphere":
                    note("spheres are meshes of 36,480 triangles with interpolated normals")
                elif child.type == "ply" and not child.get("face_normals", False):
                    note("normals of meshes are Blender's averages of their faces, not the file's")
        elif child.tag == "emitter" and child.type == "spot":
            add_spot(child)
        elif child.tag == "emitter" and child.type == "point":
            data, position = add_point_lamp(child, child.get("position", child.get("to_world", np.eye(4))[:3, 3]))
            matrix = np.eye(4)
            matrix[:3, 3] = position
            add_object(data, matrix)
        elif child.tag == "emitter" and child.type in ("constant", "envmap"):
            infinite = child
        elif child.tag == "sensor":
            add_camera(child)
        elif child.tag == "emitter":
            raise Unknown(f"the emitter {child.type}")
    add_world(infinite)


# --- rendering -----------------------------------------------------------------------------

def configure(scene, seed, threads):
    """As ../shared/design/measuring.md asks: nothing that makes the picture another one."""
    settings = bpy.context.scene
    render, cycles = settings.render, settings.cycles
    film, integrator = scene.child("sensor").child("film"), scene.child("integrator")
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = film.get("width"), film.get("height"), 100
    render.threads_mode, render.threads = "FIXED", threads
    render.use_persistent_data = True
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode, render.image_settings.color_depth = "RGB", "32"
    settings.view_settings.view_transform = "Raw"
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_guiding = cycles.use_fast_gi = cycles.use_auto_tile = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    bounces = max(integrator.get("max_depth", 1024) - 2, 0)  # of ours, one is the camera's segment, one goes to the light
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces", "transparent_max_bounces"):
        setattr(cycles, name, bounces)
    cycles.seed = seed


def cpu_seconds(samples, path):
    before = os.times()
    bpy.context.scene.cycles.samples = samples
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    after = os.times()
    return after.user + after.system - before.user - before.system


def main():
    parser = argparse.ArgumentParser(prog="cycles_render.py")
    parser.add_argument("scene")
    parser.add_argument("out", type=Path)
    parser.add_argument("--spp", type=int, required=True)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("-D", "--define", action="append", default=[])
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    scene = read_scene(options.scene, [d.split("=", 1) for d in options.define])
    build(scene)
    configure(scene, options.seed, options.threads)
    cpu_seconds(1, options.out)  # builds trees, which persistent data keeps
    once = cpu_seconds(1, options.out)
    full = cpu_seconds(options.spp, options.out)
    per_sample = (full - once) / (options.spp - 1)
    print("cycles: " + json.dumps({"seconds_per_sample": per_sample, "seconds_besides": once - per_sample, "notes": notes}))


main()
