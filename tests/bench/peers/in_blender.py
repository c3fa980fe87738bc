"""The scenes in Blender (PyPI `bpy`), whose cloth presets are read from its own files.

The gripped edge is a pinned vertex group that a hook moves with an empty, which turns about the axis of the fold by
keyframes. Settings: `preset`; `quality` and `collision_quality` [steps] and `distance` [m], Blender's own if left out.
"""

import math
import re
from pathlib import Path

import bpy
from measure import measure
from scenes import FRAMES_PER_SECOND

SUBFRAMES = 2  # Blender's default of 24 frames a second


def read_preset(name):
    """Settings of a cloth preset."""
    for folder in bpy.utils.preset_paths("cloth"):
        path = Path(folder) / f"{name}.py"
        if path.exists():
            return re.findall(r"cloth\.settings\.(\w+) = (\S+)", path.read_text())
    raise SystemExit(f"Blender has no cloth preset {name}")


def add_grip(sheet, scene):
    group = sheet.vertex_groups.new(name="gripped")
    group.add([int(i) for i in scene.gripped], 1.0, "REPLACE")
    hand = bpy.data.objects.new("hand", None)
    bpy.context.collection.objects.link(hand)
    hand.location = (scene.axis[0], 0.0, scene.axis[1])
    for frame in range(round(scene.duration * FRAMES_PER_SECOND * SUBFRAMES) + 1):
        hand.rotation_euler = (0.0, scene.angle(frame / (FRAMES_PER_SECOND * SUBFRAMES)), 0.0)
        hand.keyframe_insert("rotation_euler", frame=frame + 1)
    bpy.context.scene.frame_set(1)
    bpy.context.view_layer.update()
    hook = sheet.modifiers.new("hook", "HOOK")
    hook.object = hand
    hook.vertex_group = group.name
    hook.matrix_inverse = hand.matrix_world.inverted()
    return group


def start(scene, settings):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FRAMES_PER_SECOND * SUBFRAMES
    last = math.ceil(scene.duration * FRAMES_PER_SECOND * SUBFRAMES) + 1
    bpy.context.scene.frame_end = last

    floor_mesh = bpy.data.meshes.new("floor")
    floor_mesh.from_pydata([(-2, -2, 0), (3, -2, 0), (3, 3, 0), (-2, 3, 0)], [], [(0, 1, 2, 3)])
    floor = bpy.data.objects.new("floor", floor_mesh)
    bpy.context.collection.objects.link(floor)
    floor.modifiers.new("collision", "COLLISION")

    mesh = bpy.data.meshes.new("sheet")
    mesh.from_pydata(scene.points.tolist(), [], scene.triangles.tolist())
    sheet = bpy.data.objects.new("sheet", mesh)
    bpy.context.collection.objects.link(sheet)
    group = add_grip(sheet, scene) if len(scene.gripped) else None

    cloth = sheet.modifiers.new("cloth", "CLOTH")
    for name, value in read_preset(settings["preset"]):
        setattr(cloth.settings, name, value == "True" if value in ("True", "False") else type(getattr(cloth.settings, name))(float(value)))
    if group:
        cloth.settings.vertex_group_mass = group.name
    cloth.settings.quality = settings.get("quality", cloth.settings.quality)
    contact = cloth.collision_settings
    contact.use_self_collision = True
    contact.collision_quality = settings.get("collision_quality", contact.collision_quality)
    if "distance" in settings:
        contact.distance_min = contact.self_distance_min = settings["distance"]
        floor.collision.thickness_outer = settings["distance"]
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, last

    def advance(time):
        first = round((time - 1.0 / FRAMES_PER_SECOND) * FRAMES_PER_SECOND * SUBFRAMES) + 1
        for frame in range(first + 1, first + SUBFRAMES + 1):
            bpy.context.scene.frame_set(frame)
        evaluated = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get())
        points = [0.0] * (3 * len(evaluated.data.vertices))
        evaluated.data.vertices.foreach_get("co", points)
        return [points[k : k + 3] for k in range(0, len(points), 3)]

    bpy.context.scene.frame_set(1)
    return advance


measure(start, bpy.app.version_string, clearance=0.02)
