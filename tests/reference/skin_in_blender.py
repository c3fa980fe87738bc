#!/usr/bin/env python3
"""Vertex positions of a skinned mesh in Blender while a clip plays (requires the PyPI package bpy; used with 5.0.1).

usage: skin_in_blender.py FILE.glb MESH T[,T...] STRIDE OUT.json      every STRIDE-th vertex [m], y up as in the file
"""
import json
import sys

import bpy

path, name, times, stride = sys.argv[1], sys.argv[2], [float(t) for t in sys.argv[3].split(",")], int(sys.argv[4])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=path)
scene = bpy.context.scene
mesh = next(o for o in bpy.data.objects if o.type == "MESH" and name in (o.name.split(".")[0], o.data.name))
poses = []
for time in times:
    frame = time * scene.render.fps / scene.render.fps_base
    scene.frame_set(int(frame), subframe=frame - int(frame))
    shown = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
    positions = [shown.matrix_world @ v.co for v in shown.to_mesh().vertices]
    poses.append({"time_s": time, "points_m": [[round(p.x, 7), round(p.z, 7), round(-p.y, 7)] for p in positions[::stride]]})
json.dump({"vertices": len(positions), "stride": stride, "poses": poses}, open(sys.argv[5], "w"))
