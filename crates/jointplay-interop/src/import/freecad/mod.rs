//! Assemblies of FreeCAD 1.x, in the text of its solver (ASMT).

pub(super) mod asmt;
mod joint_limits;
mod placed_joint;
