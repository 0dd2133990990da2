"""Commands of the workbench."""

from __future__ import annotations

import FreeCAD as App
import FreeCADGui as Gui

#: Names of the commands, their texts, and the methods of the panel that they run.
COMMANDS = [
    ("Jointplay_Mobility", "Mobility", "Degrees of freedom and redundant constraints", "mobility"),
    ("Jointplay_Suggest", "Suggest virtual joints", "Virtual joints that make the drives possible", "suggest"),
    ("Jointplay_PlayMotion", "Play motion", "Move the parts along the drives", "play_drives"),
    ("Jointplay_ShowPlay", "Show play", "Displacements of virtual joints, multiplied by the play scale", "show_play"),
]


class Command:
    def __init__(self, text, hint, method):
        self.text, self.hint, self.method = text, hint, method

    def GetResources(self):
        return {"MenuText": self.text, "ToolTip": self.hint}

    def IsActive(self):
        return App.ActiveDocument is not None

    def Activated(self):
        from .panel import panel

        shown = panel()
        shown.attempt(getattr(shown, self.method))


def register() -> list[str]:
    """Adds the commands to FreeCAD and returns their names."""
    for name, text, hint, method in COMMANDS:
        Gui.addCommand(name, Command(text, hint, method))
    return [name for name, *_ in COMMANDS]
