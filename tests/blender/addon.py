"""The Blender add-on without a window: registered, baked with, transferred with, cancelled, unregistered.

    CREASE_COMMAND=target/debug/crease python tests/blender/addon.py

Needs Blender as a module (PyPI: bpy, 4.2 or later) and the crease tool. `.ci/run` runs it where bpy is installed.
"""

import importlib.util
import json
import math
import os
import sys
import time
import unittest
from pathlib import Path

import bpy
from mathutils import Vector

ROOT = Path(__file__).resolve().parents[2]
os.environ["CREASE_COMMAND"] = os.path.abspath(os.environ.get("CREASE_COMMAND", ROOT / "target/debug/crease"))


def load_addon():
    """The add-on as a package with the name that Blender gives to extensions of the disk."""
    folder = ROOT / "src/blender"
    name = "bl_ext_user_default_crease"
    spec = importlib.util.spec_from_file_location(name, folder / "__init__.py", submodule_search_locations=[str(folder)])
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


ADDON = load_addon()


def import_draft():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(ROOT / "garments/tshirt-draft.glb"))
    obj = next(obj for obj in bpy.data.objects if obj.type == "MESH")
    bpy.context.view_layer.objects.active = obj
    return obj


def sheet(cells=12, size=0.3, name="sheet"):
    """A square of cloth in the plane z = 0, with texture coordinates, turned and moved in the scene."""
    vertices = [(size * i / cells, size * j / cells, 0) for j in range(cells + 1) for i in range(cells + 1)]
    row = cells + 1
    faces = [(a, a + 1, a + row + 1, a + row) for j in range(cells) for a in range(j * row, j * row + cells)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    uv = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        x = vertices[loop.vertex_index]
        uv.data[loop.index].uv = (x[0] / size, x[1] / size)
    obj = bpy.data.objects.new(name, mesh)
    obj.location = (1, 2, 0.5)
    obj.rotation_euler = (0, 0, 0.7)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    return obj


def fold_once(obj):
    settings = obj.crease
    settings.actions.clear()
    for kind in ("lay", "fold", "press", "unfold", "settle"):
        action = settings.actions.add()
        action.kind = kind
        if kind == "lay":
            action.facing = "up"
        if kind == "press":
            action.pressure, action.duration = 2000.0, 10.0
    settings.quality = "draft"


def moves(obj):
    keys = obj.data.shape_keys.key_blocks
    return [key.co - base.co for key, base in zip(keys["Worn"].data, keys["Basis"].data)]


def largest(vectors):
    return max(v.length for v in vectors)


class AddOn(unittest.TestCase):
    def setUp(self):
        ADDON.register()

    def tearDown(self):
        ADDON.unregister()
        self.assertFalse(hasattr(bpy.types.Object, "crease"))
        self.assertFalse(hasattr(bpy.types, "CREASE_PT_garment"))

    def test_a_bake_of_the_draft_gives_a_smooth_shape_key(self):
        obj = import_draft()
        bpy.ops.crease.preset(name="fold-thrice")
        self.assertEqual(len(obj.crease.actions), 7)
        obj.crease.quality = "draft"
        self.assertEqual(bpy.ops.crease.bake(), {"FINISHED"})
        key = obj.data.shape_keys.key_blocks["Worn"]
        self.assertEqual(key.value, 1.0)
        # The folds are to be seen, and the garment is where it was.
        self.assertGreater(largest(moves(obj)), 0.005)
        self.assertLess(largest(moves(obj)), 0.3)
        self.assertTrue(all(polygon.use_smooth for polygon in obj.data.polygons))
        # Vertices at one place stay at one place: the seams are closed.
        places = {}
        for base, point in zip(obj.data.shape_keys.key_blocks["Basis"].data, key.data):
            first = places.setdefault(tuple(round(x, 6) for x in base.co), point.co.copy())
            self.assertLess((first - point.co).length, 1e-5)
        # The normals of the shaded shape differ between faces by less than its faces do: it is smooth.
        shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        corner = [Vector(n.vector) for n in shape.corner_normals]
        across = [
            math.degrees(corner[k].angle(polygon.normal))
            for polygon in shape.polygons for k in polygon.loop_indices
        ]
        self.assertGreater(max(across), 3.0)

    def test_what_is_kept_suits_a_transfer_to_another_mesh(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        source = sheet()
        fold_once(source)
        self.assertEqual(bpy.ops.crease.bake(), {"FINISHED"})
        sidecar = json.loads(bpy.data.texts[source["crease_sidecar"]].as_string())
        self.assertEqual(sidecar["format"], "crease-sidecar/1")
        target = sheet(cells=24, name="target")
        target.crease.transfer_from = source
        self.assertEqual(bpy.ops.crease.transfer(), {"FINISHED"})
        self.assertGreater(largest(moves(target)), 0.0005)
        hinges = json.loads(bpy.data.texts[target["crease_sidecar"]].as_string())["hinges"]
        change = [abs(r - s) for r, s in zip(hinges["rest_angle_rad"], hinges["source_angle_rad"])]
        self.assertGreater(max(change), 0.3)

    def test_fold_lines_are_where_they_were_drawn(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        obj = sheet(cells=20)
        fold_once(obj)
        obj.crease.actions[1].line_from = (0.25, 0.0)
        obj.crease.actions[1].line_to = (0.25, 1.0)
        self.assertEqual(bpy.ops.crease.bake(), {"FINISHED"})
        sidecar = json.loads(bpy.data.texts[obj["crease_sidecar"]].as_string())
        points, hinges = sidecar["mesh"]["points_m"], sidecar["hinges"]
        change = [abs(r - s) for r, s in zip(hinges["rest_angle_rad"], hinges["source_angle_rad"])]
        strongest = max(range(len(change)), key=change.__getitem__)
        a, b = (Vector(points[p]) for p in hinges["points"][strongest][:2])
        low = min(x[0] for x in points)
        size = max(x[0] for x in points) - low
        self.assertLess(abs((0.5 * (a.x + b.x) - low) / size - 0.25), 0.08)

    def test_a_normal_map_goes_into_the_material(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        obj = sheet(cells=8)
        fold_once(obj)
        obj.crease.use_normal_map, obj.crease.resolution, obj.crease.texels = True, 12.0, "1024"
        self.assertEqual(bpy.ops.crease.bake(), {"FINISHED"})
        nodes = obj.data.materials[0].node_tree.nodes
        image = nodes["crease wrinkles"].image
        self.assertEqual(tuple(image.size), (1024, 1024))
        self.assertEqual(image.colorspace_settings.name, "Non-Color")
        shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
        self.assertEqual(shader.inputs["Normal"].links[0].from_node.type, "NORMAL_MAP")

    def test_a_cancelled_bake_leaves_the_object_as_it_was(self):
        obj = import_draft()
        bpy.ops.crease.preset(name="fold-thrice")
        job = sys.modules[f"{ADDON.__name__}.job"].Job.bake(obj)
        time.sleep(1.0)
        self.assertFalse(job.poll())
        job.cancel()
        self.assertIsNotNone(job.process.process.poll())
        self.assertFalse(job.folder.exists())
        self.assertIsNone(obj.data.shape_keys)

    def test_mistakes_are_said(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        obj = sheet()
        for prepare, words in (
            (lambda: obj.crease.actions.clear(), "list of actions is empty"),
            (lambda: setattr(obj.crease.actions.add(), "kind", "bend"), "body"),
        ):
            prepare()
            with self.assertRaisesRegex(RuntimeError, words):
                bpy.ops.crease.bake()

    def test_actions_are_edited(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        obj = sheet()
        bpy.ops.crease.edit_actions(edit="add")
        bpy.ops.crease.edit_actions(edit="add")
        obj.crease.actions[0].kind = "lay"
        bpy.ops.crease.edit_actions(edit="up")
        self.assertEqual([action.kind for action in obj.crease.actions], ["fold", "lay"])
        bpy.ops.crease.edit_actions(edit="remove")
        self.assertEqual([action.kind for action in obj.crease.actions], ["lay"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]], verbosity=2)
