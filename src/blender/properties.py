"""What the user chooses: settings of a garment, and the list of actions of its script."""

import bpy
from bpy.props import (BoolProperty, CollectionProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty,
                       PointerProperty, StringProperty)

FABRICS = [
    ("kow-tshirt", "T-shirt", "T-shirt of the paper of Kim, Oh and Wohn"),
    ("cotton-poplin", "Cotton poplin", "Shirt cotton"),
    ("cotton-poplin-resin", "Cotton poplin, non-iron", "Shirt cotton with a resin finish"),
    ("denim", "Denim", "Trouser cotton"),
    ("linen", "Linen", "Linen"),
    ("wool-summer-suiting", "Wool, summer suiting", "Light wool"),
    ("wool-winter-flannel", "Wool, winter flannel", "Heavy wool"),
    ("silk-habotai", "Silk habotai", "Lining silk"),
    ("polyester-georgette", "Polyester georgette", "Sheer polyester"),
    ("polyester-taffeta", "Polyester taffeta", "Crisp polyester"),
    ("viscose-challis", "Viscose challis", "Soft viscose"),
    ("polycotton-shirting", "Polycotton shirting", "Shirt blend"),
    ("cotton-jersey", "Cotton jersey", "T-shirt knit"),
    ("interlock-ponte", "Interlock ponte", "Firm knit"),
]

ACTIONS = [
    ("lay", "Lay", "Lay the garment flat"),
    ("fold", "Fold", "Turn one side of a line over the rest"),
    ("press", "Press", "Press straight down"),
    ("unfold", "Unfold", "Open all folds"),
    ("hold", "Hold", "Keep everything as it is held"),
    ("settle", "Settle", "Release and come to rest"),
    ("hang", "Hang", "Hang by the highest points"),
    ("crumple", "Crumple", "Squeeze into a ball"),
    ("release", "Release", "Release everything at once"),
    ("bend", "Bend", "Bend a joint of the body"),
    ("play", "Play", "Play an animation of the body"),
]

QUALITIES = [
    ("draft", "Draft", "Fast, for a first look"),
    ("standard", "Standard", "For results"),
    ("reference", "Reference", "Slow, for comparisons"),
]


class CreaseAction(bpy.types.PropertyGroup):
    """One action of a wear script; only the fields of its kind are used."""

    kind: EnumProperty(name="Action", items=ACTIONS, default="fold")
    facing: EnumProperty(name="Facing up", default="front", items=[
        (name, name.capitalize(), f"The {name} of the garment looks up")
        for name in ("front", "back", "left", "right", "up", "down")])
    line_from: FloatVectorProperty(
        name="From", size=2, default=(0.5, 0.0), min=-10.0, max=10.0,
        description="Fraction of the bounding box: 0, 0 at the lower left, 1, 1 at the upper right")
    line_to: FloatVectorProperty(name="To", size=2, default=(0.5, 1.0), min=-10.0, max=10.0,
                                 description="A second point of the line")
    side: EnumProperty(name="Side", default="left", description="Part that is turned over", items=[
        (name, name.capitalize(), "") for name in ("left", "right", "upper", "lower")])
    angle: FloatProperty(name="Angle", default=180.0, min=1.0, max=180.0, description="Degrees")
    over: FloatProperty(name="Over", default=2.0, min=0.01, soft_max=20.0, description="Seconds")
    hold: FloatProperty(name="Hold", default=5.0, min=0.0, soft_max=600.0, description="Seconds")
    duration: FloatProperty(name="For", default=5.0, min=0.01, soft_max=600.0, description="Seconds")
    pressure: FloatProperty(name="Pressure", default=200.0, min=1.0, soft_max=10000.0,
                            description="Pascals: 200 under a pile of shirts, 2000 under a hand, 4000 under an iron")
    to: FloatProperty(name="To", default=0.4, min=0.05, max=0.95, description="Size of the ball, relative to the garment")
    joint: StringProperty(name="Joint", description="Bone of the body's armature")
    axis: EnumProperty(name="Axis", default="x", items=[(a, a.upper(), "") for a in "xyz"])
    clip: StringProperty(name="Clip", description="Animation of the body")
    repeat: IntProperty(name="Repeat", default=1, min=1, max=1000)


class CreaseSettings(bpy.types.PropertyGroup):
    """Settings of one garment."""

    fabric: EnumProperty(name="Fabric", items=FABRICS, default="cotton-jersey")
    quality: EnumProperty(name="Quality", items=QUALITIES, default="standard")
    source: EnumProperty(name="Wear", default="actions", items=[
        ("actions", "Actions", "The list below"),
        ("file", "File", "A wear script, crease-wear/1"),
    ])
    script_file: StringProperty(name="Script", subtype="FILE_PATH")
    actions: CollectionProperty(type=CreaseAction)
    active_action: IntProperty(name="Active action")
    body: PointerProperty(name="Body", type=bpy.types.Object, description="Body that wears the garment; needed by bend and play",
                          poll=lambda self, other: other.type == "MESH" and other.data is not self.id_data.data)
    use_normal_map: BoolProperty(name="Normal map", default=False,
                                 description="Simulate a finer mesh and write its fine wrinkles into a normal map")
    resolution: FloatProperty(name="Resolution", default=8.0, min=1.0, soft_max=50.0,
                              description="Edge length of the finer mesh in millimetres")
    texels: EnumProperty(name="Size", default="2048", items=[(str(n), f"{n} px", "") for n in (1024, 2048, 4096)])
    transfer_from: PointerProperty(name="From", type=bpy.types.Object, description="Garment that was baked before",
                                   poll=lambda self, other: other.type == "MESH" and "crease_sidecar" in other)


class CreasePreferences(bpy.types.AddonPreferences):
    """Where the tool is."""

    bl_idname = __package__

    command: StringProperty(name="Command", subtype="FILE_PATH",
                            description="The crease tool; empty: `crease` of the search path, or the crease-bake package")

    def draw(self, context):
        self.layout.prop(self, "command")
        self.layout.label(text="Install it with: pip install crease-bake")


CLASSES = (CreaseAction, CreaseSettings, CreasePreferences)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.crease = PointerProperty(type=CreaseSettings)


def unregister():
    del bpy.types.Object.crease
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
