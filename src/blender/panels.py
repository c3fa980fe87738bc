"""The panel in the sidebar of the 3D view."""

import bpy

from .operators import Running

FIELDS = {
    "lay": ("facing",),
    "fold": ("line_from", "line_to", "side", "angle", "over", "hold"),
    "press": ("pressure", "duration"),
    "unfold": ("over",),
    "hold": ("duration",),
    "settle": ("duration",),
    "hang": ("duration",),
    "crumple": ("to", "over", "hold"),
    "release": (),
    "bend": ("joint", "axis", "angle", "over", "hold", "repeat"),
    "play": ("clip", "repeat"),
}


class CREASE_UL_actions(bpy.types.UIList):
    """One action a line."""

    def draw_item(self, _context, layout, _data, item, _icon, _active, _property, _index=0, _flags=0):
        row = layout.row()
        row.prop(item, "kind", text="", emboss=False)
        if item.kind == "fold":
            row.label(text=f"{item.side}, {item.angle:.0f}°")
        elif item.kind == "press":
            row.label(text=f"{item.pressure:.0f} Pa, {item.duration:g} s")
        elif "duration" in FIELDS[item.kind]:
            row.label(text=f"{item.duration:g} s")


class CREASE_PT_garment(bpy.types.Panel):
    """Wear of the active garment."""

    bl_label = "Crease"
    bl_idname = "CREASE_PT_garment"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Crease"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context):
        settings, layout = context.object.crease, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings, "fabric")
        layout.prop(settings, "body")
        layout.prop(settings, "source", expand=True)
        if settings.source == "file":
            layout.prop(settings, "script_file")
        else:
            self.draw_actions(layout, settings)
        layout.prop(settings, "quality")
        layout.prop(settings, "use_normal_map")
        if settings.use_normal_map:
            layout.prop(settings, "resolution")
            layout.prop(settings, "texels")
        if Running.job:
            process = Running.job.process
            layout.progress(factor=process.fraction, text=f"{process.stage} {100 * process.fraction:.0f} %")
            layout.operator("crease.cancel", icon="X")
        else:
            layout.operator("crease.bake", icon="MOD_CLOTH")

    def draw_actions(self, layout, settings):
        layout.operator_menu_enum("crease.preset", "name", text="Preset")
        row = layout.row()
        row.template_list("CREASE_UL_actions", "", settings, "actions", settings, "active_action", rows=4)
        column = row.column(align=True)
        for edit, icon in (("add", "ADD"), ("remove", "REMOVE"), ("up", "TRIA_UP"), ("down", "TRIA_DOWN")):
            column.operator("crease.edit_actions", text="", icon=icon).edit = edit
        if 0 <= settings.active_action < len(settings.actions):
            action = settings.actions[settings.active_action]
            box = layout.box()
            for field in FIELDS[action.kind]:
                box.prop(action, field)


class CREASE_PT_transfer(bpy.types.Panel):
    """Wrinkles of another garment."""

    bl_label = "Transfer"
    bl_parent_id = "CREASE_PT_garment"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(context.object.crease, "transfer_from")
        layout.operator("crease.transfer", icon="MOD_DATA_TRANSFER")


CLASSES = (CREASE_UL_actions, CREASE_PT_garment, CREASE_PT_transfer)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
