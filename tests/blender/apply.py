"""Blender shades what `--apply` wrote as it is worn: the import of the glTF file has its corner normals.

    CREASE_COMMAND=target/debug/crease python tests/blender/apply.py

Needs bpy (PyPI) and the crease tool. `.ci/run` runs it where Blender is installed.
"""

import json
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
TOOL = os.path.abspath(os.environ.get("CREASE_COMMAND", ROOT / "target/debug/crease"))
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
KINDS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


def read_primitive(path):
    """Positions, normals and triangles of the first primitive of a GLB file, in Blender's axes."""
    content = path.read_bytes()
    length = struct.unpack("<I", content[12:16])[0]
    document = json.loads(content[20 : 20 + length])
    binary = content[28 + length :]

    def accessor(index):
        own = document["accessors"][index]
        view = document["bufferViews"][own["bufferView"]]
        start = view.get("byteOffset", 0) + own.get("byteOffset", 0)
        width = WIDTHS[own["type"]]
        numbers = np.frombuffer(binary, KINDS[own["componentType"]], own["count"] * width, start)
        return numbers.reshape(-1, width)

    primitive = document["meshes"][0]["primitives"][0]
    attributes = primitive["attributes"]
    turned = [np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]) @ accessor(attributes[name]).T for name in ("POSITION", "NORMAL")]
    return turned[0].T, turned[1].T, accessor(primitive["indices"]).reshape(-1, 3)


class Applied(unittest.TestCase):
    def test_corner_normals_are_the_worn_ones(self):
        with tempfile.TemporaryDirectory() as folder:
            worn = Path(folder) / "worn.glb"
            garment = ROOT / "garments/handkerchief.glb"
            bake = [TOOL, "bake", garment, "--wear", "press-crease", "--apply", "--quiet", "-o", worn]
            subprocess.run([str(part) for part in bake], check=True)
            positions, normals, triangles = read_primitive(worn)
            bpy.ops.wm.read_factory_settings(use_empty=True)
            bpy.ops.import_scene.gltf(filepath=str(worn))
        mesh = next(item for item in bpy.data.objects if item.type == "MESH").data
        vertices = np.array([tuple(vertex.co) for vertex in mesh.vertices])
        corners = np.array([loop.vertex_index for loop in mesh.loops])
        own = np.array([tuple(corner.vector) for corner in mesh.corner_normals])
        self.assertLess(np.abs(vertices[corners] - positions[triangles.ravel()]).max(), 1e-6)
        written = normals[triangles.ravel()]
        cosine = (own * written).sum(1) / np.linalg.norm(own, axis=1) / np.linalg.norm(written, axis=1)
        angles = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
        print(f"corner normals: {angles.mean():.4f} degrees from the worn ones in the mean, {angles.max():.3f} at most")
        self.assertLess(angles.mean(), 1.0)
        # The crease is there: the file is not flat.
        self.assertGreater(np.ptp(positions[:, 2]), 5e-3)
        self.assertEqual([key.name for key in mesh.shape_keys.key_blocks], ["Basis", "unworn"])


if __name__ == "__main__":
    unittest.main(argv=["apply.py", "-v"])
