"""Mobility, virtual joints and motions of assemblies in FreeCAD, over the Python package ``jointplay``."""
