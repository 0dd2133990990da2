//! A motion for SolidWorks: time and value for each motor, and a macro that loads them.

use std::fmt::Write as _;

use super::samples::turns;
use super::{Error, Recording};
use crate::units::{deg, mm};

/// Name of the macro's file; `NOT-SAFE-` stands before it, and before those of the motors, where something is wrong with the motion.
pub const MACRO: &str = "load-motors.bas";

/// A file `motor-NAME.csv` for each axis with lines `time,value` in s and mm or degrees, and [`MACRO`], as names and contents.
///
/// The macro gives their motion to the motors of a motion study that have the names of the axes.
///
/// # Arguments
/// * `rate` – lines a second; the last line is the end of the motion [Hz]
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`]
pub fn solidworks(recording: &Recording<'_>, rate: f64) -> Result<Vec<(String, String)>, Error> {
    recording.check_rate(rate)?;
    let axes = &recording.cell.robot.axes;
    let mut texts = vec![String::new(); axes.len()];
    for sample in recording.motion.samples(rate) {
        for ((text, axis), &position) in texts.iter_mut().zip(axes).zip(&sample.positions) {
            let value = if turns(axis.kind) { deg(position) } else { mm(position) };
            // Every digit: the end of the last line is the end of the motion.
            let _ = writeln!(text, "{},{value}", sample.time);
        }
    }
    // Lines of numbers have no room for a word: the names say it.
    let mark = if recording.flaws.is_empty() { "" } else { "NOT-SAFE-" };
    let names = axes.iter().map(|axis| format!("{mark}motor-{}.csv", file_name(&axis.name)));
    let mut files: Vec<(String, String)> = names.zip(texts).collect();
    let text = loader(recording, &files);
    files.push((format!("{mark}{MACRO}"), text));
    Ok(files)
}

/// A name that every system takes for a file.
fn file_name(name: &str) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    name.chars().map(plain).collect()
}

/// Text as it may stand in a string of Visual Basic.
fn quoted(text: &str) -> String {
    let plain: String =
        text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    format!("\"{}\"", plain.replace('"', "\"\""))
}

/// The macro.
fn loader(recording: &Recording<'_>, files: &[(String, String)]) -> String {
    let mut loads = String::new();
    for (axis, (file, _)) in recording.cell.robot.axes.iter().zip(files) {
        let _ = writeln!(loads, "    Load {}, folder & {}", quoted(&axis.name), quoted(file));
    }
    let warning = recording.warning().map_or_else(String::new, |warning| {
        let shown = quoted(&warning);
        let comment: String = warning.split_whitespace().collect::<Vec<_>>().join(" ");
        format!("    ' {comment}\n    MsgBox {shown}, vbExclamation\n")
    });
    let text = format!(
        r#"Attribute VB_Name = "LoadMotors"
' Gives the motors of a motion study the motion in the files beside this macro.
' The study has to be a Motion Analysis, and its motors have to have the names of the axes.
' Times are in s, displacements in mm for linear and in degrees for rotary motors: set the units of the document so.
' Import this file into a new macro, whose references to the libraries of SolidWorks it needs.
Option Explicit

Const STUDY_NAME As String = "Motion Study 1"
' How it interpolates between the points, as in SolidWorks' own examples.
Const SCHEME As Long = 1

Dim model As Object
Dim study As Object
Dim missing As String

Sub main()
    Dim app As Object, folder As String
    Set app = Application.SldWorks
    Set model = app.ActiveDoc
    If model Is Nothing Then MsgBox "Open the assembly first.": Exit Sub
    Set study = model.Extension.GetMotionStudyManager().GetMotionStudy(STUDY_NAME)
    If study Is Nothing Then MsgBox "There is no " & STUDY_NAME & ".": Exit Sub
    study.Activate
{warning}    folder = Left(app.GetCurrentMacroPathName(), InStrRev(app.GetCurrentMacroPathName(), "\"))
    missing = ""
{loads}    study.SetDuration {duration}
    If missing <> "" Then MsgBox "No motor could be given its motion for:" & missing
End Sub

Private Sub Load(name As String, file As String)
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
    missing = missing & " " & name
End Sub
"#,
        duration = recording.motion.duration(),
    );
    // As the editor of Visual Basic writes them.
    text.replace('\n', "\r\n")
}
