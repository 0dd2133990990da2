//! A motion for SolidWorks: time and value for each motor, and a macro that loads them.

use std::fmt::Write as _;

use jointplay_cell::robot::Axis;
use jointplay_cell::trajectory::Sample;
use jointplay_cell::workcell::Cell;

use super::error::Error;
use super::motion_export::MotionExport;
use super::samples::turns;
use jointplay_format::units::{deg, mm};

/// Name of the macro's file; if the motion has violations, `NOT-SAFE-` precedes this name and those of the motors' files.
pub const MACRO: &str = "load-motors.bas";
/// Prefix of the files of a motion with violations; the files themselves have no room for a comment.
const MARK: &str = "NOT-SAFE-";

/// A file `motor-NAME.csv` for each axis with lines `time,value` in s and mm or degrees, and [`MACRO`], as names and contents.
///
/// The macro assigns the motions to the motors of a motion study that have the names of the axes.
/// It makes the study and motors that are missing, motors along reference axes named `jp:AXIS` of the moved parts.
///
/// # Arguments
/// * `rate` – number of lines per second; the last line is the end of the motion (Hz)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`]
pub fn solidworks(
    motion_export: &MotionExport<'_>,
    rate: f64,
) -> Result<Vec<(String, String)>, Error> {
    let motors = motors(motion_export).into_iter().enumerate();
    let text = |(axis, name): (usize, String)| {
        let mut bytes = Vec::new();
        motor(motion_export, rate, axis, &mut bytes)?.expect("writing into memory does not fail");
        Ok((name, String::from_utf8(bytes).expect("numbers are UTF-8")))
    };
    let mut files = motors.map(text).collect::<Result<Vec<_>, Error>>()?;
    files.push(loader(motion_export));
    Ok(files)
}

/// Names of the motors' files, in the order of the axes.
#[must_use]
pub fn motors(motion_export: &MotionExport<'_>) -> Vec<String> {
    let mut names = names(motion_export.cell, mark(motion_export));
    names.pop();
    names
}

/// Writes the file of one motor.
///
/// # Arguments
/// * `axis` – index of the axis
/// * `rate` – number of lines per second; the last line is the end of the motion (Hz)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`]; within, those of the writer
///
/// # Panics
/// If the robot has no such axis.
pub fn motor(
    motion_export: &MotionExport<'_>,
    rate: f64,
    axis: usize,
    writer: &mut dyn std::io::Write,
) -> Result<std::io::Result<()>, Error> {
    motion_export.check_rate(rate)?;
    let unit: fn(f64) -> f64 =
        if turns(motion_export.cell.robot.axes[axis].kind) { deg } else { mm };
    // All digits: the last line must be the exact end of the motion.
    let mut samples = motion_export.motion.samples(rate);
    let line = |at: Sample| writeln!(writer, "{},{}", at.time, unit(at.positions[axis]));
    Ok(samples.try_for_each(line))
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
    let motor = |axis: &Axis| format!("{mark}motor-{}.csv", file_name(&axis.name));
    let motors = cell.robot.axes.iter().map(motor);
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
    let mut loads = String::new();
    for (axis, file) in motion_export.cell.robot.axes.iter().zip(&motors(motion_export)) {
        let kind = if turns(axis.kind) { "swFmAEMRotationalMotor" } else { "swFmAEMLinearMotor" };
        let (name, file) = (quoted(&axis.name), quoted(file));
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
' Motors are those with the names of the axes. A missing one is made along the reference axis "jp:" and the name,
' which has to be in the part that it moves, and to point in the direction of positive values.
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
    Dim app As Object, manager As Object, folder As String
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
{loads}    study.SetDuration {duration}
    If missing <> "" Then MsgBox "No motor could be given its motion for:" & missing
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
