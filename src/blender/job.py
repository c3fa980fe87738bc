"""A bake or a transfer of one object, from its mesh to its shape key. It runs without a window, too."""

import json
import shutil
import tempfile
from pathlib import Path

import bpy

from . import exchange, script, tool


class Job:
    """A run of the tool for the garment `obj`."""

    def __init__(self, obj):
        self.obj_name = obj.name
        self.folder = Path(tempfile.mkdtemp(prefix="crease-"))
        self.mesh, self.out = self.folder / "garment.obj", self.folder / "worn.glb"
        self.process = None
        self.settings = obj.crease

    @classmethod
    def bake(cls, obj):
        """Starts a bake by the settings of `obj`."""
        job = cls(obj)
        return job._start(obj, job._bake_arguments)

    @classmethod
    def transfer(cls, obj):
        """Starts a transfer to `obj` from the garment of its settings."""
        job = cls(obj)
        return job._start(obj, job._transfer_arguments)

    def _start(self, obj, arguments):
        try:
            exchange.write_obj(obj, self.mesh)
            words = [*arguments(), *self._detail_arguments(obj), "-o", self.out, "--unit", "m", "--json"]
            self.process = tool.Process([str(word) for word in words])
        except Exception:
            self.close()
            raise
        return self

    def _bake_arguments(self):
        settings = self.settings
        wear = self.folder / "wear.json"
        if settings.source == "file":
            shutil.copy(bpy.path.abspath(settings.script_file), wear)
        else:
            if not settings.actions:
                raise exchange.ExchangeError("The list of actions is empty")
            wear.write_text(script.script_text(settings.actions), encoding="utf-8")
        words = ["bake", self.mesh, "--wear", wear, "--fabric", settings.fabric, "--quality", settings.quality]
        if settings.body:
            body = self.folder / "body.glb"
            exchange.write_body(settings.body, body)
            words += ["--body", body]
        return words

    def _transfer_arguments(self):
        source = self.settings.transfer_from
        if not source:
            raise exchange.ExchangeError("Choose the garment whose wrinkles are to be transferred")
        sidecar = self.folder / "source.crease.json"
        sidecar.write_text(exchange.sidecar_text(source), encoding="utf-8")
        return ["transfer", sidecar, "--to", self.mesh, "--fabric", self.settings.fabric]

    def _detail_arguments(self, obj):
        if not self.settings.use_normal_map:
            return []
        if not obj.data.uv_layers.active:
            raise exchange.ExchangeError(f"{obj.name} has no texture coordinates, which a normal map needs")
        return ["--resolution", f"{self.settings.resolution:g}", f"--detail-map={self.settings.texels}"]

    def poll(self):
        """True once the tool has ended."""
        return self.process.poll()

    def finish(self):
        """Puts the result on the object; returns a line that describes it."""
        try:
            self.process.check()
            obj = bpy.data.objects.get(self.obj_name)
            if obj is None:
                raise exchange.ExchangeError(f"{self.obj_name} is gone")
            text = self.out.with_suffix(".crease.json").read_text(encoding="utf-8")
            moves = exchange.displacements(obj, json.loads(text))
            exchange.add_shape_key(obj, moves)
            exchange.keep_sidecar(obj, text)
            png = exchange.png_of_wrinkles(self.out) if self.settings.use_normal_map else None
            if png:
                exchange.add_normal_map(obj, png, self.folder)
            warnings = [line for line in json.loads(self.process.report or "{}").get("warnings", [])]
            line = f"{obj.name}: moved by up to {1e3 * exchange.largest_move(moves):.1f} mm"
            return "; ".join([line, *warnings])
        finally:
            self.close()

    def cancel(self):
        """Ends the tool and leaves the object as it was."""
        if self.process:
            self.process.cancel()
        self.close()

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)
