"""Wear scripts from the list of actions."""

import json

PRESETS = {
    "fold-thrice": [
        {"kind": "lay"},
        {"kind": "fold", "line_from": (0.3, 0.0), "line_to": (0.3, 1.0), "side": "left"},
        {"kind": "fold", "line_from": (0.7, 0.0), "line_to": (0.7, 1.0), "side": "right"},
        {"kind": "fold", "line_from": (0.0, 0.5), "line_to": (1.0, 0.5), "side": "lower"},
        {"kind": "press", "pressure": 200.0, "duration": 30.0},
        {"kind": "unfold"},
        {"kind": "settle", "duration": 3.0},
    ],
    "crumple": [
        {"kind": "crumple", "to": 0.4, "over": 3.0, "hold": 20.0},
        {"kind": "settle", "duration": 3.0},
    ],
}


def numbers(vector):
    """Rounded, because single precision would show in the file."""
    return [round(x, 5) for x in vector]


def action_json(action):
    """The entry of one action."""
    over, hold, duration = (round(x, 4) for x in (action.over, action.hold, action.duration))
    fields = {
        "lay": lambda: {"facing": action.facing},
        "fold": lambda: {"line": [numbers(action.line_from), numbers(action.line_to)], "side": action.side,
                         "angle": round(action.angle, 3), "over": over, "hold": hold},
        "press": lambda: {"pressure": round(action.pressure, 3), "for": duration},
        "unfold": lambda: {"all": True, "over": over},
        "hold": lambda: {"for": duration},
        "settle": lambda: {"for": duration},
        "hang": lambda: {"by": "top", "for": duration},
        "crumple": lambda: {"to": round(action.to, 4), "over": over, "hold": hold},
        "release": dict,
        "bend": lambda: {"joint": action.joint, "axis": action.axis, "angle": round(action.angle, 3), "over": over,
                         "hold": hold, "repeat": action.repeat},
        "play": lambda: {"clip": action.clip, "repeat": action.repeat},
    }
    return {action.kind: fields[action.kind]()}


def script_text(actions):
    """The wear script of a list of actions."""
    return json.dumps({"format": "crease-wear/1", "name": "Blender", "actions": [action_json(a) for a in actions]},
                      indent=1)


def set_preset(settings, name):
    """Replaces the list of actions by a preset."""
    settings.actions.clear()
    for entry in PRESETS[name]:
        action = settings.actions.add()
        for key, value in entry.items():
            setattr(action, key, value)
    settings.active_action = 0
    settings.source = "actions"
