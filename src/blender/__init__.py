"""Wrinkles of wear on the selected garment, by the installed crease tool.

`properties` holds what the user chooses, `script` makes a wear script of it, `exchange` writes and reads the mesh, `tool`
runs the command, `job` joins them, `operators` and `panels` show it. Nothing here simulates.
"""

from . import operators, panels, properties


def register():
    properties.register()
    operators.register()
    panels.register()


def unregister():
    panels.unregister()
    operators.unregister()
    properties.unregister()
