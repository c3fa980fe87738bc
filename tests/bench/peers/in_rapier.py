"""The scenes in rapier (PyPI `rapier3d`), as soft-body cloth with its default material and self-contacts.

Rapier generates the cloth, with structural, shear and bending edges between the same points; the gripped edge is pinned
and follows kinematic targets. Settings: `step` [s].
"""

from importlib.metadata import version

import numpy as np
import rapier3d
from measure import measure
from scenes import AREA_DENSITY, FRAMES_PER_SECOND, GRAVITY


def start(scene, settings):
    world = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, -GRAVITY))
    steps = round(1.0 / (FRAMES_PER_SECOND * settings["step"]))
    world.integration_parameters.dt = 1.0 / (FRAMES_PER_SECOND * steps)
    world.add_collider(rapier3d.Collider.halfspace((0.0, 0.0, 1.0)))

    corner = scene.points[0]
    du = scene.points[1] - corner
    dv = scene.points[scene.columns] - corner
    builder = rapier3d.SoftBody.cloth(tuple(corner), tuple(du), tuple(dv), scene.columns, scene.rows)
    builder = builder.mass(AREA_DENSITY * scene.width * scene.height).self_contacts(True).can_sleep(False)
    material = builder.current_material
    material.edge_softness = rapier3d.SpringCoefficients(settings["frequency"], 1.0)
    builder = builder.material(material)
    sheet = world.soft_bodies[world.add_soft_body(builder)]
    # The generator numbers the points in its own order.
    generated = np.asarray(sheet.particle_positions, float)
    order = np.lexsort(np.round(generated / 1e-5).T), np.lexsort(np.round(scene.points / 1e-5).T)
    number = np.empty(len(generated), int)
    number[order[1]] = order[0]
    if np.abs(generated[number] - scene.points).max() > 1e-4:
        raise SystemExit("the points of rapier's cloth are not those of the scene")
    gripped = [int(number[k]) for k in scene.gripped]
    for particle in gripped:
        sheet.set_particle_pinned(particle, True)

    def advance(time):
        for k in range(steps):
            at = time + (k + 1 - steps) / (FRAMES_PER_SECOND * steps)
            for particle, position in zip(gripped, scene.gripped_at(at)):
                sheet.set_particle_kinematic_target(particle, tuple(position))
            world.step()
        return np.asarray(sheet.particle_positions)[number]

    return advance


measure(start, version("rapier3d"), clearance=0.005)
