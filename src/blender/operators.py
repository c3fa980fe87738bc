"""Operators: bake and transfer in the background, and edits of the list of actions."""

import time

import bpy
from bpy.props import EnumProperty

from . import exchange, job, script, tool

FAILURES = (exchange.ExchangeError, tool.ToolError, OSError, ValueError)
# Time between two looks at the tool [s].
INTERVAL = 0.2


class Running:
    """The job that runs, of which there is one at most."""

    job = None
    cancelled = False


def redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class JobOperator:
    """Starts a job and waits for it while Blender stays usable; without a window it waits until the end."""

    bl_options = {"REGISTER", "UNDO"}
    timer = None

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH" and Running.job is None

    def invoke(self, context, _event):
        try:
            Running.job, Running.cancelled = self.start(context.object), False
        except FAILURES as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(INTERVAL, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if Running.cancelled:
            Running.job.cancel()
            self.report({"INFO"}, "Cancelled")
            return self.end(context, {"CANCELLED"})
        if not Running.job.poll():
            context.window_manager.progress_update(100 * Running.job.process.fraction)
            redraw()
            return {"PASS_THROUGH"}
        return self.end(context, self.take())

    def execute(self, context):
        try:
            Running.job = self.start(context.object)
            while not Running.job.poll():
                time.sleep(INTERVAL)
        except FAILURES as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        result = self.take()
        Running.job = None
        return result

    def take(self):
        try:
            self.report({"INFO"}, Running.job.finish())
            return {"FINISHED"}
        except FAILURES as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def end(self, context, result):
        Running.job = None
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        redraw()
        return result


class CREASE_OT_bake(JobOperator, bpy.types.Operator):
    """Simulate the wear of the active garment and add its wrinkles as a shape key"""

    bl_idname = "crease.bake"
    bl_label = "Bake Wear"

    def start(self, obj):
        return job.Job.bake(obj)


class CREASE_OT_transfer(JobOperator, bpy.types.Operator):
    """Put the wrinkles of another garment on the active one"""

    bl_idname = "crease.transfer"
    bl_label = "Transfer Wrinkles"

    def start(self, obj):
        return job.Job.transfer(obj)


class CREASE_OT_cancel(bpy.types.Operator):
    """End the running bake; the garment stays as it was"""

    bl_idname = "crease.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, _context):
        return Running.job is not None

    def execute(self, _context):
        Running.cancelled = True
        return {"FINISHED"}


class CREASE_OT_edit_actions(bpy.types.Operator):
    """Add, remove or move an action"""

    bl_idname = "crease.edit_actions"
    bl_label = "Edit Actions"
    bl_options = {"REGISTER", "UNDO"}

    edit: EnumProperty(items=[(name, name.capitalize(), "") for name in ("add", "remove", "up", "down")])

    @classmethod
    def poll(cls, context):
        return context.object is not None

    def execute(self, context):
        settings = context.object.crease
        index, count = settings.active_action, len(settings.actions)
        if self.edit == "add":
            settings.actions.add()
            settings.actions.move(count, min(index + 1, count))
            settings.active_action = min(index + 1, count)
        elif self.edit == "remove" and count:
            settings.actions.remove(index)
            settings.active_action = max(0, min(index, count - 2))
        elif self.edit in ("up", "down"):
            to = index + (1 if self.edit == "down" else -1)
            if 0 <= to < count:
                settings.actions.move(index, to)
                settings.active_action = to
        return {"FINISHED"}


class CREASE_OT_preset(bpy.types.Operator):
    """Replace the list of actions"""

    bl_idname = "crease.preset"
    bl_label = "Script Preset"
    bl_options = {"REGISTER", "UNDO"}

    name: EnumProperty(items=[(name, name.replace("-", " ").capitalize(), "") for name in script.PRESETS])

    @classmethod
    def poll(cls, context):
        return context.object is not None

    def execute(self, context):
        script.set_preset(context.object.crease, self.name)
        return {"FINISHED"}


CLASSES = (CREASE_OT_bake, CREASE_OT_transfer, CREASE_OT_cancel, CREASE_OT_edit_actions, CREASE_OT_preset)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    if Running.job:
        Running.job.cancel()
        Running.job = None
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
