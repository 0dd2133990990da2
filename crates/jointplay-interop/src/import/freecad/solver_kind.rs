//! Kinds of joints of FreeCAD's solver by their names in its files.

/// All kinds of joints that a file may have.
const KINDS: [&str; 28] = [
    "AngleJoint",
    "AtPointJoint",
    "CompoundJoint",
    "ConstantVelocityJoint",
    "ConstVelJoint",
    "CylSphJoint",
    "CylindricalJoint",
    "FixedJoint",
    "GearJoint",
    "InLineJoint",
    "InPlaneJoint",
    "LineInPlaneJoint",
    "NoRotationJoint",
    "ParallelAxesJoint",
    "PerpendicularJoint",
    "PlanarJoint",
    "PointInLineJoint",
    "PointInPlaneJoint",
    "RackPinionJoint",
    "RevCylJoint",
    "RevRevJoint",
    "RevoluteJoint",
    "ScrewJoint",
    "SphSphJoint",
    "SphericalJoint",
    "SphericalSphericalJoint",
    "TranslationalJoint",
    "UniversalJoint",
];
/// Number of letters that FreeCAD 1.0 cuts off on Linux, where it appends an `E`: it cuts names as another compiler mangles them.
const CUT: usize = 4;

/// The kind of a name in a file, which may be cut.
///
/// # Errors
/// All kinds that the cut name may mean.
pub(super) fn solver_kind(name: &str) -> Result<&str, Vec<&'static str>> {
    if KINDS.contains(&name) {
        return Ok(name);
    }
    let Some(cut) = name.strip_suffix('E') else { return Ok(name) };
    let is_cut = |kind: &&&'static str| kind.get(CUT..) == Some(cut);
    let found: Vec<&'static str> = KINDS.iter().filter(is_cut).copied().collect();
    match found[..] {
        [] => Ok(name),
        [kind] => Ok(kind),
        _ => Err(found),
    }
}
