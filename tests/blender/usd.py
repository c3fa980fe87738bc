"""USD scenes as OpenUSD and Blender read them: valid, skinned, with the wear as blend shape and the frames as time samples.

    CREASE_COMMAND=target/debug/crease python tests/blender/usd.py

Needs usd-core and bpy (PyPI) and the crease tool. `.ci/run` runs it where both are installed.
"""

import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

import bpy
import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics, UsdShade, UsdSkel

ROOT = Path(__file__).resolve().parents[2]
TOOL = os.path.abspath(os.environ.get("CREASE_COMMAND", ROOT / "target/debug/crease"))


def crease(*words):
    done = subprocess.run([TOOL, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def png(size):
    """A checkerboard as PNG."""
    chunk = lambda kind, data: (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))
    rows = b"".join(b"\0" + bytes(255 * ((x + y) % 2) for x in range(size) for _ in range(3)) for y in range(size))
    head = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def textured_sheet(cells, side):
    """A GLB of a lying sheet whose material has a texture and a normal map."""
    grid = np.linspace(0, 1, cells + 1, dtype="f4")
    u, v = (axis.ravel() for axis in np.meshgrid(grid, grid))
    points = np.stack([side * u, 0 * u, side * v], axis=1).astype("<f4")
    at = lambda i, j: j * (cells + 1) + i
    corners = [[at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)]
               for j in range(cells) for i in range(cells)]
    blobs = [points.tobytes(), np.stack([u, v], axis=1).astype("<f4").tobytes(), np.array(corners, "<u4").tobytes(), png(4)]
    views, binary = [], b""
    for blob in blobs:
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(blob)})
        binary += blob + bytes(-len(blob) % 4)
    accessor = lambda view, kind, count, component, **more: {
        "bufferView": view, "type": kind, "count": count, "componentType": component, **more}
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "sheet"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "accessors": [accessor(0, "VEC3", len(points), 5126, min=low, max=high), accessor(1, "VEC2", len(points), 5126),
                      accessor(2, "SCALAR", 6 * cells * cells, 5125)],
        "bufferViews": views, "buffers": [{"byteLength": len(binary)}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}], "textures": [{"source": 0}],
        "materials": [{"name": "checked", "normalTexture": {"index": 0}, "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1, 1, 1], "metallicFactor": 0}}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(b"JSON", text), (b"BIN\0", binary)]
    body = b"".join(struct.pack("<I", len(data)) + kind + data for kind, data in chunks)
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


class Scenes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        folder = Path(cls.temporary.name)
        cls.sleeve, cls.cloth, cls.checked = (folder / f"{name}.usda" for name in ("sleeve", "cloth", "checked"))
        memory = ROOT / "garments/memories/elbow.crease.json.gz"
        crease("transfer", memory, "--to", ROOT / "garments/sleeve.glb", "--garment", "sleeve", "--export", "usd",
               "-o", cls.sleeve.with_suffix(".glb"))
        wear = folder / "wear.json"
        wear.write_text(json.dumps({"format": "crease-wear/1", "actions": [
            {"lay": {"facing": "up"}}, {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left"}}, {"unfold": {"all": True}}]}))
        cells = 8
        obj = [f"v {0.3 * i / cells} 0 {0.3 * j / cells}" for j in range(cells + 1) for i in range(cells + 1)]
        at = lambda i, j: j * (cells + 1) + i + 1
        obj += [f"f {at(i, j)} {at(i, j + 1)} {at(i + 1, j + 1)} {at(i + 1, j)}" for j in range(cells) for i in range(cells)]
        mesh = folder / "cloth.obj"
        mesh.write_text("\n".join(obj) + "\n")
        crease("bake", mesh, "--unit", "m", "--wear", wear, "--quality", "draft", "--frames", folder / "frames", "--fps", "4",
               "--fabric", "denim", "--export", "usd", "-o", cls.cloth.with_suffix(".glb"))
        (folder / "checked-in.glb").write_bytes(textured_sheet(cells, 0.3))
        crease("bake", folder / "checked-in.glb", "--wear", wear, "--quality", "draft", "--fabric", "denim", "--export", "usd",
               "-o", cls.checked.with_suffix(".glb"))

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def check(self, stage):
        try:
            from pxr import UsdValidation
        except ImportError:
            return
        context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
        self.assertEqual([error.GetMessage() for error in context.Validate(stage)], [])

    def test_a_skinned_sleeve_is_valid_and_its_blend_shape_is_the_wear(self):
        stage = Usd.Stage.Open(str(self.sleeve))
        self.check(stage)
        self.assertEqual((UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)), (1.0, "Y"))
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Garment/sleeve"))
        before = np.array(mesh.GetPointsAttr().Get())
        offsets = np.array(UsdSkel.BlendShape(stage.GetPrimAtPath("/Garment/sleeve/worn")).GetOffsetsAttr().Get())
        self.assertGreater(np.linalg.norm(offsets, axis=1).max(), 0.005)
        joints = UsdSkel.Skeleton(stage.GetPrimAtPath("/Garment/Skeleton")).GetJointsAttr().Get()
        self.assertIn("elbow", " ".join(joints))
        weights = np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("skel:jointWeights").Get()).reshape(len(before), -1)
        np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-4)
        # Baked by OpenUSD in the pose of the file: the worn shape, nothing else.
        root = UsdSkel.Root(stage.GetPrimAtPath("/Garment"))
        self.assertTrue(UsdSkel.BakeSkinning(root))
        attribute = mesh.GetPointsAttr()
        after = np.array(attribute.Get(attribute.GetTimeSamples()[0] if attribute.GetTimeSamples() else 0))
        np.testing.assert_allclose(after, before + offsets, atol=1e-5)

    def test_materials_have_density_and_thickness(self):
        stage = Usd.Stage.Open(str(self.cloth))
        self.check(stage)
        mesh = next(prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
        self.assertTrue(UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()[0])
        fabric = stage.GetPrimAtPath("/Garment/Materials/Fabric")
        density = UsdPhysics.MaterialAPI(fabric).GetDensityAttr().Get()
        thickness = fabric.GetAttribute("physics:surfaceThickness").Get()
        # Denim: some 400 g/m2, 0.8 mm.
        self.assertTrue(0.3 < density * thickness < 0.6 and 0.0004 < thickness < 0.0015, (density, thickness))

    def test_textures_are_read_beside_the_scene(self):
        stage = Usd.Stage.Open(str(self.checked))
        self.check(stage)
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.usd_import(filepath=str(self.checked), import_guide=False)
        mesh = next(obj for obj in bpy.data.objects if obj.type == "MESH")
        tree = mesh.data.materials[0].node_tree
        images = [node.image for node in tree.nodes if node.type == "TEX_IMAGE"]
        self.assertEqual({os.path.basename(image.filepath) for image in images}, {"checked.texture-0.png"})
        self.assertEqual({tuple(image.size) for image in images}, {(4, 4)})
        surface = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        self.assertTrue(surface.inputs["Base Color"].is_linked and surface.inputs["Normal"].is_linked)

    def test_frames_are_time_samples(self):
        stage = Usd.Stage.Open(str(self.cloth))
        points = UsdGeom.Mesh(stage.GetPrimAtPath("/Garment/Frames")).GetPointsAttr()
        times = points.GetTimeSamples()
        self.assertGreater(len(times), 8)
        self.assertEqual((stage.GetTimeCodesPerSecond(), stage.GetEndTimeCode()), (4.0, times[-1]))
        shapes = [np.array(points.Get(t)) for t in times]
        # The garment is folded half way through: it rises.
        self.assertGreater(max(np.ptp(x[:, 1]) for x in shapes), 0.05)
        extent = UsdGeom.Mesh(stage.GetPrimAtPath("/Garment/Frames")).GetExtentAttr().Get(times[3])
        np.testing.assert_allclose(np.array(extent), [shapes[3].min(axis=0), shapes[3].max(axis=0)], atol=1e-5)

    def test_blender_imports_shape_key_armature_and_texture_coordinates(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.usd_import(filepath=str(self.sleeve), import_guide=False)
        mesh = next(obj for obj in bpy.data.objects if obj.type == "MESH")
        bpy.context.scene.frame_set(0)
        self.assertEqual(mesh.data.shape_keys.key_blocks["worn"].value, 1.0)
        self.assertEqual(list(mesh.data.uv_layers.keys()), ["st"])
        self.assertTrue(mesh.data.materials[0])
        armature = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
        self.assertIn("elbow", " ".join(bone.name for bone in armature.data.bones))
        self.assertIn("elbow", " ".join(group.name for group in mesh.vertex_groups))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]], verbosity=2)
