Attribute VB_Name = "Jointplay"
' jointplay for 64-bit VBA: the functions of jointplay.h, whose comments describe them.
' Lengths are in metres and angles in radians.
' Pass the first element of an array, rods(0); a text is an array of bytes in UTF-8, ended by 0: see JpBytes.

Option Explicit

Public Const JP_OK As Long = 0
Public Const JP_NO_ANSWER As Long = 1
Public Const JP_BAD_INPUT As Long = 2
Public Const JP_INTERNAL As Long = 3
Public Const JP_RADIAL As Long = 0
Public Const JP_POLAR As Long = 1
Public Const JP_OFFSET As Long = 2
Public Const JP_PLANAR As Long = 3
Public Const JP_MAX_VIRTUAL_JOINTS As Long = 6

Public Declare PtrSafe Function jp_version Lib "jointplay.dll" () As LongPtr
Public Declare PtrSafe Function jp_last_error Lib "jointplay.dll" (ByRef text As Byte, ByVal size As LongPtr) As LongPtr
Public Declare PtrSafe Sub jp_text_free Lib "jointplay.dll" (ByVal text As LongPtr)

Public Declare PtrSafe Function jp_virtual_joint_count Lib "jointplay.dll" (ByVal virtualization As Long) As LongPtr

Public Declare PtrSafe Function jp_robot_paper Lib "jointplay.dll" (ByRef robot As LongPtr) As Long
Public Declare PtrSafe Function jp_robot_parse Lib "jointplay.dll" (ByRef toml As Byte, ByRef robot As LongPtr) As Long
Public Declare PtrSafe Sub jp_robot_free Lib "jointplay.dll" (ByVal robot As LongPtr)
Public Declare PtrSafe Function jp_robot_working_height Lib "jointplay.dll" (ByVal robot As LongPtr) As Double
Public Declare PtrSafe Function jp_robot_inverse Lib "jointplay.dll" (ByVal robot As LongPtr, ByVal azimuth As Double, ByVal tilt As Double, ByVal height As Double, ByRef rods As Double) As Long
Public Declare PtrSafe Function jp_robot_forward Lib "jointplay.dll" (ByVal robot As LongPtr, ByVal virtualization As Long, ByRef rods As Double, ByRef pose As Double, ByRef virtual_joints As Double, ByRef tilt As Double) As Long
Public Declare PtrSafe Function jp_robot_forward_many Lib "jointplay.dll" (ByVal robot As LongPtr, ByVal virtualization As Long, ByVal size As LongPtr, ByRef rods As Double, ByRef poses As Double, ByRef virtual_joints As Double, ByRef codes As Long) As Long
Public Declare PtrSafe Function jp_robot_limits Lib "jointplay.dll" (ByVal robot As LongPtr, ByRef rods As Double, ByRef exceeded As Long) As Long
Public Declare PtrSafe Function jp_robot_jacobian Lib "jointplay.dll" (ByVal robot As LongPtr, ByVal virtualization As Long, ByRef rods As Double, ByRef jacobian As Double, ByRef virtual_joints As Double) As Long
Public Declare PtrSafe Function jp_robot_json Lib "jointplay.dll" (ByVal robot As LongPtr, ByRef request As Byte, ByRef answer As LongPtr) As Long

Public Declare PtrSafe Function jp_mechanism_parse Lib "jointplay.dll" (ByRef toml As Byte, ByRef mechanism As LongPtr) As Long
Public Declare PtrSafe Function jp_mechanism_catalogue Lib "jointplay.dll" (ByRef name As Byte, ByRef mechanism As LongPtr) As Long
Public Declare PtrSafe Sub jp_mechanism_free Lib "jointplay.dll" (ByVal mechanism As LongPtr)
Public Declare PtrSafe Function jp_mechanism_coordinate_count Lib "jointplay.dll" (ByVal mechanism As LongPtr) As LongPtr
Public Declare PtrSafe Function jp_mechanism_joint_coordinate_count Lib "jointplay.dll" (ByVal mechanism As LongPtr) As LongPtr
Public Declare PtrSafe Function jp_mechanism_coordinate_name Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByVal size_coordinate As LongPtr) As LongPtr
Public Declare PtrSafe Function jp_mechanism_coordinate_is_angle Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByVal size_coordinate As LongPtr) As Long
Public Declare PtrSafe Function jp_mechanism_drive_count Lib "jointplay.dll" (ByVal mechanism As LongPtr) As LongPtr
Public Declare PtrSafe Function jp_mechanism_drive_coordinate Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByVal size_drive As LongPtr) As Long
Public Declare PtrSafe Function jp_mechanism_link_count Lib "jointplay.dll" (ByVal mechanism As LongPtr) As LongPtr
Public Declare PtrSafe Function jp_mechanism_link_name Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByVal size_link As LongPtr) As LongPtr
Public Declare PtrSafe Function jp_mechanism_home Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByRef positions As Double) As Long
Public Declare PtrSafe Function jp_mechanism_positions Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByRef drives As Double, ByRef positions As Double) As Long
Public Declare PtrSafe Function jp_mechanism_link_poses Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByRef positions As Double, ByRef poses As Double) As Long
Public Declare PtrSafe Function jp_mechanism_jacobian Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByRef positions As Double, ByVal size_link As LongPtr, ByRef jacobian As Double, ByRef rates As Double) As Long
Public Declare PtrSafe Function jp_mechanism_json Lib "jointplay.dll" (ByVal mechanism As LongPtr, ByRef request As Byte, ByRef answer As LongPtr) As Long

' A text of ASCII characters as bytes, ended by 0.
Public Function JpBytes(ByVal text As String) As Byte()
    JpBytes = StrConv(text & vbNullChar, vbFromUnicode)
End Function

' The last error of the calling thread.
Public Function JpLastError() As String
    Dim bytes(0 To 999) As Byte, i As Long
    jp_last_error bytes(0), 1000
    For i = 0 To 999
        If bytes(i) = 0 Then Exit For
        JpLastError = JpLastError & Chr$(bytes(i))
    Next
End Function

' Pose of the platform of the paper's robot for three rods (m), as an example: the shift of its origin in µm.
Public Sub JpExample()
    Dim robot As LongPtr, rods(0 To 2) As Double, pose(0 To 15) As Double
    Dim joints(0 To JP_MAX_VIRTUAL_JOINTS - 1) As Double, tilt(0 To 2) As Double
    If jp_robot_paper(robot) <> JP_OK Then Err.Raise vbObjectError, , JpLastError()
    rods(0) = 0.4977: rods(1) = 0.5005: rods(2) = 0.5018
    If jp_robot_forward(robot, JP_RADIAL, rods(0), pose(0), joints(0), tilt(0)) <> JP_OK Then Err.Raise vbObjectError, , JpLastError()
    Debug.Print 1000000# * pose(3), 1000000# * pose(7)
    jp_robot_free robot
End Sub
