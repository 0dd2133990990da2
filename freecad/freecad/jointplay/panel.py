"""The panel with results and motions. All computations are in the modules without a window."""

from __future__ import annotations

import FreeCAD as App
import FreeCADGui as Gui
from PySide import QtCore, QtGui

import jointplay as jp

from . import analysis
from .linkage import Linkage, OpenLinkages

#: Time between two configurations of a motion (ms).
INTERVAL_MS = 40


class Panel:
    """Task panel: a text with results, drives, a table, and the factor of play."""

    def __init__(self):
        self.linkages = OpenLinkages()
        self.timer = None
        self.form = QtGui.QWidget()
        self.form.setWindowTitle("Jointplay")
        layout = QtGui.QFormLayout(self.form)
        self.drives = QtGui.QLineEdit()
        self.drives.setPlaceholderText("rod 1=2.5, rod 2=-1")
        layout.addRow("Drives (mm, °)", self.drives)
        self.factor = QtGui.QDoubleSpinBox()
        self.factor.setRange(1.0, 100000.0)
        layout.addRow("Play scale ×", self.factor)
        for text, action in [
            ("Mechanism file…", self.open_mechanism),
            ("Mobility", self.mobility),
            ("Suggest virtual joints", self.suggest),
            ("Play motion of drives", self.play_drives),
            ("Play motion of a table…", self.play_table),
            ("Show play", self.show_play),
            ("Parts as drawn", self.restore),
        ]:
            button = QtGui.QPushButton(text)
            button.clicked.connect(lambda *_, run=action: self.attempt(run))
            layout.addRow(button)
        self.text = QtGui.QPlainTextEdit()
        self.text.setReadOnly(True)
        self.text.setFont(QtGui.QFontDatabase.systemFont(QtGui.QFontDatabase.FixedFont))
        layout.addRow(self.text)

    def attempt(self, action):
        """Runs an action; its error is shown in the panel."""
        try:
            action()
        except (ValueError, OSError, jp.JointplayError) as error:
            self.text.setPlainText(str(error))

    def document(self) -> App.Document:
        """The active document."""
        if App.ActiveDocument is None:
            raise ValueError("open a document with an assembly first")
        return App.ActiveDocument

    def linked(self) -> Linkage:
        """The linkage of the active document."""
        return self.linkages.linkage(self.document())

    def open_mechanism(self):
        path, _ = QtGui.QFileDialog.getOpenFileName(self.form, "Mechanism file", "", "Mechanisms (*.toml)")
        if path:
            self.stop()
            mechanism = jp.Mechanism.from_file(path)
            linked = self.linkages.set(self.document(), mechanism)
            self.text.setPlainText(f"{mechanism.name}; links without a part: {linked.unmatched}")

    def mobility(self):
        self.text.setPlainText(analysis.mobility_text(self.linked().mechanism))

    def suggest(self):
        commands = analysis.displacements(self.drives.text())
        self.text.setPlainText(str(analysis.suggestions(self.linked().mechanism, commands)))

    def play_drives(self):
        drives = analysis.displacements(self.drives.text())
        self.run(analysis.drive(self.linked().mechanism, drives))

    def play_table(self):
        path, _ = QtGui.QFileDialog.getOpenFileName(self.form, "Table", "", "Tables (*.csv)")
        if path:
            self.run(analysis.table(self.linked().mechanism, path))

    def show_play(self):
        drives = analysis.displacements(self.drives.text())
        configurations = analysis.drive(self.linked().mechanism, drives, steps=1)
        self.linked().show(configurations[-1], self.factor.value())

    def run(self, configurations):
        self.stop()
        steps = analysis.play(self.linked(), configurations, self.factor.value())
        self.timer = QtCore.QTimer()
        self.timer.timeout.connect(lambda: self.stop() if next(steps, None) is None else Gui.updateGui())
        self.timer.start(INTERVAL_MS)

    def stop(self):
        if self.timer is not None:
            self.timer.stop()
            self.timer = None

    def restore(self):
        self.stop()
        self.linkages.restore()

    def accept(self):
        self.stop()
        return True

    def reject(self):
        self.restore()
        return True


_panel = None


def panel() -> Panel:
    """The panel, opened where it is not."""
    global _panel
    if _panel is None or Gui.Control.activeDialog() is False:
        _panel = Panel()
        Gui.Control.showDialog(_panel)
    return _panel
