"""Registers the workbench; FreeCAD runs this file at its start."""

import FreeCADGui as Gui


class JointplayWorkbench(Gui.Workbench):
    MenuText = "Jointplay"
    ToolTip = "Mobility, virtual joints and motions of overconstrained assemblies"

    def Initialize(self):
        from freecad.jointplay.commands import register

        names = register()
        self.appendToolbar("Jointplay", names)
        self.appendMenu("Jointplay", names)

    def GetClassName(self):
        return "Gui::PythonWorkbench"


Gui.addWorkbench(JointplayWorkbench())
