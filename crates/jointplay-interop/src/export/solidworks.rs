//! A motion for SolidWorks: time and value for each motor, and a macro that loads them.

use std::cell::Cell as Slot;
use std::collections::BTreeSet;
use std::fmt::Write as _;

use jointplay_cell::CellError;
use jointplay_cell::robot::AxisKind;
use jointplay_cell::trajectory::Sample;
use jointplay_cell::workcell::Cell;
use jointplay_core::virtualization::{VirtualJointKind, Virtualization, built_in};

use super::curve_reduction::reduced;
use super::error::Error;
use super::gltf::check_tolerance;
use super::motion_export::MotionExport;
use super::samples::turns;
use jointplay_format::units::{deg, mm};

/// Name of the macro's file; if the motion has violations, `NOT-SAFE-` precedes this name and those of the motors' files.
pub const MACRO: &str = "load-motors.bas";
/// Prefix of the files of a motion with violations; the files themselves have no room for a comment.
const MARK: &str = "NOT-SAFE-";

/// A file `motor-NAME.csv` for each axis and each virtual joint of the platform with lines `time,value` in s and mm or degrees, and [`MACRO`], as names and contents.
///
/// The macro assigns the motions to the motors of a motion study that have the names of the axes, or `play u1` and so on for virtual joints.
/// It makes the study and motors that are missing, motors along reference axes named `jp:NAME` of the moved parts.
///
/// # Arguments
/// * `rate` – samples per second; the last line is the end of the motion (Hz)
/// * `tolerance` – largest deviation of linear interpolation between lines from the samples, of the farthest point that an axis turns (m)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`], [`Error::Tolerance`], [`Error::Placing`]
pub fn solidworks(
    motion_export: &MotionExport<'_>,
    rate: f64,
    tolerance: f64,
) -> Result<Vec<(String, String)>, Error> {
    let motors = motors(motion_export).into_iter().enumerate();
    let text = |(index, name): (usize, String)| {
        let mut bytes = Vec::new();
        let written = motor(motion_export, rate, tolerance, index, &mut bytes)?;
        written.expect("writing into memory does not fail");
        Ok((name, String::from_utf8(bytes).expect("numbers are UTF-8")))
    };
    let mut files = motors.map(text).collect::<Result<Vec<_>, Error>>()?;
    files.push(loader(motion_export));
    Ok(files)
}

/// Names of the motors' files: axes in their order, then virtual joints.
#[must_use]
pub fn motors(motion_export: &MotionExport<'_>) -> Vec<String> {
    let mut names = names(motion_export.cell, mark(motion_export));
    names.pop();
    names
}

/// Writes the file of one motor.
///
/// # Arguments
/// * `index` – of the motor among [`motors`]
/// * `rate` – samples per second; the last line is the end of the motion (Hz)
/// * `tolerance` – largest deviation of linear interpolation between lines from the samples, of the farthest point that an axis turns (m)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`], [`Error::Tolerance`], [`Error::Placing`]; within, those of the writer
///
/// # Panics
/// If there is no such motor.
pub fn motor(
    motion_export: &MotionExport<'_>,
    rate: f64,
    tolerance: f64,
    index: usize,
    writer: &mut dyn std::io::Write,
) -> Result<std::io::Result<()>, Error> {
    motion_export.check_rate(rate)?;
    check_tolerance(tolerance)?;
    let cell = motion_export.cell;
    let curve = curves(cell).swap_remove(index);
    let unit: fn(f64) -> f64 = if curve.turns { deg } else { mm };
    let allowed = unit(if curve.turns { tolerance / curve.reach } else { tolerance });
    let failure = Slot::new(None);
    let gpr = cell.robot.gpr.clone().without_limit_checks();
    let value = |at: &Sample| -> Result<f64, jointplay_core::Error> {
        match curve.source {
            Source::Axis(axis) => Ok(at.positions[axis]),
            Source::Play(joint) => {
                let rods = [at.positions[0], at.positions[1], at.positions[2]];
                let pose = cell.robot.model.forward(&gpr, rods)?;
                Ok(gpr.virtual_displacements(&pose, virtualization(cell))[joint])
            }
        }
    };
    let points = motion_export.motion.samples(rate).map_while(|at| match value(&at) {
        Ok(value) => Some((at.time, unit(value))),
        Err(error) => {
            let source = Box::new(CellError::from(error));
            failure.set(Some(Error::Placing { time: at.time, source }));
            None
        }
    });
    // All digits: the last line must be the exact end of the motion.
    let mut lines = reduced(points, allowed);
    let written = lines.try_for_each(|(time, value)| writeln!(writer, "{time},{value}"));
    match failure.take() {
        Some(error) => Err(error),
        None => Ok(written),
    }
}

/// Source of the motion of a motor.
#[derive(Clone, Copy)]
enum Source {
    /// An axis of the robot.
    Axis(usize),
    /// A virtual joint of the platform.
    Play(usize),
}

/// The curve of a motor.
struct Curve {
    name: String,
    source: Source,
    turns: bool,
    /// Distance that the farthest point moves for each radian (m).
    reach: f64,
}

/// The curves of all motors: axes, then virtual joints of the platform.
fn curves(cell: &Cell) -> Vec<Curve> {
    let axes = cell.robot.axes.iter().enumerate().map(|(axis, described)| Curve {
        name: described.name.clone(),
        source: Source::Axis(axis),
        turns: turns(described.kind),
        reach: reach(cell, axis),
    });
    let plays = virtualization(cell).joints().iter().enumerate().map(|(index, joint)| Curve {
        name: format!("play {}{}", joint.symbol, joint.limb + 1),
        source: Source::Play(index),
        turns: joint.motion == VirtualJointKind::Angular,
        reach: cell.robot.gpr.platform().mean_radius(),
    });
    axes.chain(plays).collect()
}

fn virtualization(cell: &Cell) -> &'static dyn Virtualization {
    let kind = Some(cell.robot.model.virtualization);
    let found = built_in().into_iter().find(|one| one.as_built_in() == kind);
    found.expect("each kind is one of the library's")
}

/// Distance that the farthest point of a wafer moves for each radian of an axis, with all links in one line (m).
fn reach(cell: &Cell, axis: usize) -> f64 {
    let robot = &cell.robot;
    let of_arm = |arm: &jointplay_cell::robot::Arm| {
        let ratios = arm.joints.iter().flat_map(|joint| &joint.drives);
        let ratio = ratios.filter(|one| one.0 == axis).map(|one| one.1.abs()).fold(0.0, f64::max);
        let links = arm.joints.iter().map(|joint| {
            let travel = if joint.kind == AxisKind::Rotary {
                0.0
            } else {
                let drives = joint.drives.iter().map(|&(axis, ratio)| {
                    let axis = &robot.axes[axis];
                    ratio.abs() * axis.min.abs().max(axis.max.abs())
                });
                joint.zero.abs() + drives.sum::<f64>()
            };
            travel + joint.length.hypot(joint.offset)
        });
        let centers =
            arm.effectors.iter().map(|one| one.wafer_center[0].hypot(one.wafer_center[1]));
        let wafer = centers.fold(0.0, f64::max) + 0.5 * cell.wafer.diameter;
        ratio * (links.sum::<f64>() + wafer)
    };
    robot.arms.iter().map(of_arm).fold(robot.gpr.platform().mean_radius(), f64::max)
}

fn mark(motion_export: &MotionExport<'_>) -> &'static str {
    if motion_export.violation_notes.is_empty() { "" } else { MARK }
}

/// Names of all files that [`solidworks`] can return for a cell, with and without violations.
#[must_use]
pub fn solidworks_names(cell: &Cell) -> Vec<String> {
    ["", MARK].into_iter().flat_map(|mark| names(cell, mark)).collect()
}

/// Names of the motors' files, and of the macro.
fn names(cell: &Cell, mark: &str) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let motors = curves(cell).into_iter().map(|curve| {
        // An axis can have the name of a virtual joint, and names can differ by letters that files do not have.
        let mut name = file_name(&curve.name);
        while !taken.insert(name.to_ascii_lowercase()) {
            name.push('_');
        }
        format!("{mark}motor-{name}.csv")
    });
    motors.chain(std::iter::once(format!("{mark}{MACRO}"))).collect()
}

/// A file name that every operating system accepts.
fn file_name(name: &str) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    name.chars().map(plain).collect()
}

/// A string literal of Visual Basic.
fn quoted(text: &str) -> String {
    let plain: String =
        text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    format!("\"{}\"", plain.replace('"', "\"\""))
}

/// Name and text of the macro.
#[must_use]
pub fn loader(motion_export: &MotionExport<'_>) -> (String, String) {
    let (mut loads, mut plays) = (String::new(), String::new());
    for (curve, file) in curves(motion_export.cell).iter().zip(&motors(motion_export)) {
        let kind = if curve.turns { "swFmAEMRotationalMotor" } else { "swFmAEMLinearMotor" };
        let (name, file) = (quoted(&curve.name), quoted(file));
        let loads = if matches!(curve.source, Source::Axis(_)) { &mut loads } else { &mut plays };
        let _ = writeln!(loads, "    Load {name}, folder & {file}, {kind}");
    }
    let warning = motion_export.warning().map_or_else(String::new, |warning| {
        let shown = quoted(&warning);
        let comment: String = warning.split_whitespace().collect::<Vec<_>>().join(" ");
        format!("    ' {comment}\n    MsgBox {shown}, vbExclamation\n")
    });
    let text = format!(
        r#"Attribute VB_Name = "LoadMotors"
' Assigns the motion in the files of this folder to the motors of a motion study.
' A study of that name has to be a Motion Analysis; without one, it is made.
' Motors are those with the names of the axes, and those of the play of the balls, such as "play u1".
' A missing one is made along the reference axis "jp:" and the name, which has to be in the part that it moves,
' and to point in the direction of positive values. Motors of the play need an assembly whose ball mates leave it free.
' The points are those that linear interpolation needs.
' Times are in s, displacements in mm for linear and in degrees for rotary motors: set the units of the document so.
' Import this file into a new macro, whose references to the libraries of SolidWorks it needs.
Option Explicit

Const STUDY_NAME As String = "Motion Study 1"
' How it interpolates between the points, as in SolidWorks' own examples.
Const SCHEME As Long = 1
' swMotionStudyTypeCosmosMotion
Const MOTION_ANALYSIS As Long = 4
Const AXIS_PREFIX As String = "jp:"

Dim model As Object
Dim study As Object
Dim missing As String

Sub main()
    Dim app As Object, manager As Object, folder As String, undriven As String
    Set app = Application.SldWorks
    Set model = app.ActiveDoc
    If model Is Nothing Then MsgBox "Open the assembly first.": Exit Sub
    Set manager = model.Extension.GetMotionStudyManager()
    If manager Is Nothing Then MsgBox "Switch the add-in SOLIDWORKS Motion on first.": Exit Sub
    Set study = manager.GetMotionStudy(STUDY_NAME)
    If study Is Nothing Then
        Set study = manager.CreateMotionStudy()
        If study Is Nothing Then MsgBox "There is no " & STUDY_NAME & ", and none can be made.": Exit Sub
        study.Activate
        study.StudyType = MOTION_ANALYSIS
    End If
    study.Activate
{warning}    folder = Left(app.GetCurrentMacroPathName(), InStrRev(app.GetCurrentMacroPathName(), "\"))
    missing = ""
{loads}    undriven = missing
    missing = ""
    ' The play of the balls, so that the solver does not choose the displacement of the platform.
{plays}    study.SetDuration {duration}
    If undriven <> "" Then MsgBox "No motor could be given its motion for:" & undriven
    If missing <> "" Then MsgBox "Without these motors the solver chooses the displacement of the platform:" & missing
End Sub

Private Sub Load(name As String, file As String, made As Long)
    Dim features As Variant, feature As Object, motor As Object, kind As String, k As Long
    features = study.GetMotionFeatures()
    If IsArray(features) Then
        For k = LBound(features) To UBound(features)
            Set feature = features(k)
            kind = feature.GetTypeName()
            If (kind = "AEMLinearMotor" Or kind = "AEMRotationalMotor") And feature.Name = name Then
                Set motor = feature.GetDefinition()
                motor.InterpolatedMotor swSimulationMotorDrive_Displacement, SCHEME
                If motor.LoadSplineData(file) Then
                    If feature.ModifyDefinition(motor, model, Nothing) Then Exit Sub
                End If
            End If
        Next k
    End If
    If Not Created(name, file, made) Then missing = missing & " " & name
End Sub

' Makes a motor along the reference axis of its name.
Private Function Created(name As String, file As String, made As Long) As Boolean
    Dim components As Variant, axis As Object, motor As SldWorks.SimulationMotorFeatureData
    Dim loaded(0) As Object, references As Variant, feature As Object, k As Long
    components = model.GetComponents(False)
    If Not IsArray(components) Then Exit Function
    For k = LBound(components) To UBound(components)
        Set axis = components(k).FeatureByName(AXIS_PREFIX & name)
        If Not axis Is Nothing Then
            model.ClearSelection2 True
            If Not axis.Select2(False, 0) Then Exit Function
            Set motor = study.CreateDefinition(made)
            If motor Is Nothing Then Exit Function
            motor.InterpolatedMotor swSimulationMotorDrive_Displacement, SCHEME
            motor.DirectionReference = model.SelectionManager.GetSelectedObject6(1, -1)
            motor.Location = model.SelectionManager.GetSelectedObject6(1, -1)
            Set loaded(0) = model.SelectionManager.GetSelectedObject6(1, -1)
            references = loaded
            motor.LoadReferences = references
            If Not motor.LoadSplineData(file) Then Exit Function
            Set feature = study.CreateFeature(motor)
            If feature Is Nothing Then Exit Function
            feature.Name = name
            Created = True
            Exit Function
        End If
    Next k
End Function
"#,
        duration = motion_export.motion.duration(),
    );
    // Line ends as in files of the Visual Basic editor.
    (format!("{}{MACRO}", mark(motion_export)), text.replace('\n', "\r\n"))
}
