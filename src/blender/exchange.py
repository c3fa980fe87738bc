"""The mesh on its way to the tool and back.

The tool gets an OBJ of the mesh without shape keys and modifiers, in metres, y up, as it stands in the scene. What comes back
is the sidecar, whose points are found again by their positions.
"""

import json
import math
import struct

import bpy
from mathutils import Matrix, Vector
from mathutils.kdtree import KDTree

# Distance within which a point of the sidecar is a vertex, relative to the size of the garment.
POSITION_TOLERANCE = 1e-5

TO_Y_UP = Matrix(((1, 0, 0), (0, 0, 1), (0, -1, 0)))


class ExchangeError(Exception):
    """Something that the user can mend; its text says how."""


def base_positions(mesh):
    """Positions of the vertices without shape keys, in the coordinates of the object."""
    if mesh.shape_keys:
        return [point.co.copy() for point in mesh.shape_keys.reference_key.data]
    return [vertex.co.copy() for vertex in mesh.vertices]


def scene_positions(obj):
    """Positions of the vertices in the scene [m], y up."""
    scale = bpy.context.scene.unit_settings.scale_length or 1.0
    return [TO_Y_UP @ (obj.matrix_world @ x) * scale for x in base_positions(obj.data)]


def write_obj(obj, path):
    """Writes the mesh of `obj`, with its active texture coordinates."""
    mesh = obj.data
    if not mesh.polygons:
        raise ExchangeError(f"{obj.name} has no faces")
    uv = mesh.uv_layers.active
    with open(path, "w", encoding="utf-8") as file:
        for x in scene_positions(obj):
            file.write(f"v {x.x:.9g} {x.y:.9g} {x.z:.9g}\n")
        if uv:
            for entry in uv.data:
                file.write(f"vt {entry.uv.x:.7g} {entry.uv.y:.7g}\n")
        for polygon in mesh.polygons:
            corners = [
                f"{mesh.loops[k].vertex_index + 1}/{k + 1}" if uv else f"{mesh.loops[k].vertex_index + 1}"
                for k in polygon.loop_indices
            ]
            file.write(f"f {' '.join(corners)}\n")


def write_body(obj, path):
    """Writes `obj`, its armature and animations as GLB."""
    chosen = {obj} | {m.object for m in obj.modifiers if m.type == "ARMATURE" and m.object}
    if obj.parent and obj.parent.type == "ARMATURE":
        chosen.add(obj.parent)
    view_layer = bpy.context.view_layer
    selected, active = [o for o in view_layer.objects if o.select_get()], view_layer.objects.active
    try:
        for other in selected:
            other.select_set(False)
        for other in chosen:
            other.select_set(True)
        bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB", use_selection=True, export_yup=True,
                                  export_materials="NONE", export_morph=False)
    finally:
        for other in chosen:
            other.select_set(False)
        for other in selected:
            other.select_set(True)
        view_layer.objects.active = active


def displacements(obj, sidecar):
    """Displacement per vertex in the coordinates of `obj` from a sidecar that was made of it."""
    positions = scene_positions(obj)
    points = [Vector(x) for x in sidecar["mesh"]["points_m"]]
    moves = [Vector(d) for d in sidecar["points"]["displacement_m"]]
    tree = KDTree(len(points))
    for index, x in enumerate(points):
        tree.insert(x, index)
    tree.balance()
    size = max((max(x[k] for x in points) - min(x[k] for x in points) for k in range(3)), default=0.0)
    scale = bpy.context.scene.unit_settings.scale_length or 1.0
    back = obj.matrix_world.to_3x3().inverted_safe() @ TO_Y_UP.inverted() * (1 / scale)
    out, missing = [], 0
    used = {v for edge in obj.data.edges for v in edge.vertices}
    for v, x in enumerate(positions):
        _, index, distance = tree.find(x)
        near = index is not None and distance <= POSITION_TOLERANCE * max(size, 1e-6) + 1e-6
        missing += not near and v in used
        out.append(back @ moves[index] if near else Vector())
    if missing:
        raise ExchangeError(f"{missing} vertices of {obj.name} are not in the result: was it changed during the bake?")
    return out


def add_shape_key(obj, moves, name="Worn"):
    """Adds the worn shape as a shape key with value 1, and shades the mesh smooth."""
    mesh = obj.data
    base = base_positions(mesh)
    if not mesh.shape_keys:
        obj.shape_key_add(name="Basis", from_mix=False)
    key = mesh.shape_keys.key_blocks.get(name) or obj.shape_key_add(name=name, from_mix=False)
    for point, x, d in zip(key.data, base, moves):
        point.co = x + d
    key.value = 1.0
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    obj.active_shape_key_index = mesh.shape_keys.key_blocks.find(name)
    mesh.update()
    return key


def png_of_wrinkles(path):
    """The normal map in the GLB file `path`, or None."""
    data = open(path, "rb").read()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    binary = data[28 + length:]
    for image in document.get("images", []):
        if image.get("name") == "wrinkles":
            view = document["bufferViews"][image["bufferView"]]
            start = view.get("byteOffset", 0)
            return binary[start:start + view["byteLength"]]
    return None


def add_normal_map(obj, png, folder):
    """Puts a normal map into the materials of `obj`; one is made if there is none."""
    path = folder / "wrinkles.png"
    path.write_bytes(png)
    image = bpy.data.images.load(str(path))
    image.name = f"{obj.name} wrinkles"
    image.colorspace_settings.name = "Non-Color"
    image.pack()
    if not obj.data.materials:
        obj.data.materials.append(bpy.data.materials.new(f"{obj.name} cloth"))
    for material in filter(None, obj.data.materials):
        material.use_nodes = True
        tree = material.node_tree
        shader = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
        if not shader:
            continue
        texture = tree.nodes.get("crease wrinkles") or tree.nodes.new("ShaderNodeTexImage")
        texture.name = texture.label = "crease wrinkles"
        texture.image = image
        texture.location = shader.location + Vector((-620, -300))
        normal = tree.nodes.get("crease normal") or tree.nodes.new("ShaderNodeNormalMap")
        normal.name = normal.label = "crease normal"
        normal.location = shader.location + Vector((-280, -300))
        if obj.data.uv_layers.active:
            normal.uv_map = obj.data.uv_layers.active.name
        tree.links.new(texture.outputs["Color"], normal.inputs["Color"])
        tree.links.new(normal.outputs["Normal"], shader.inputs["Normal"])
    return image


def keep_sidecar(obj, text):
    """Keeps the memory with the object, as a text of the .blend file, for a transfer."""
    name = obj.get("crease_sidecar", f"{obj.name}.crease.json")
    block = bpy.data.texts.get(name) or bpy.data.texts.new(name)
    block.from_string(text)
    block.use_fake_user = True
    obj["crease_sidecar"] = block.name


def sidecar_text(obj):
    """The memory that was kept with the object."""
    block = bpy.data.texts.get(obj.get("crease_sidecar", ""))
    if not block:
        raise ExchangeError(f"{obj.name} has no memory: bake it first")
    return block.as_string()


def largest_move(moves):
    return max((math.sqrt(d.dot(d)) for d in moves), default=0.0)
