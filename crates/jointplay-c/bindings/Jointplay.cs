// jointplay for C#: the functions of jointplay.h, and two classes over them.
// Lengths are in metres and angles in radians. Compile this file with your program.

using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Jointplay
{
    /// <summary>The functions of jointplay.h, whose comments describe them.</summary>
    public static class Native
    {
        public const int JP_OK = 0;
        public const int JP_NO_ANSWER = 1;
        public const int JP_BAD_INPUT = 2;
        public const int JP_INTERNAL = 3;
        public const int JP_RADIAL = 0;
        public const int JP_POLAR = 1;
        public const int JP_OFFSET = 2;
        public const int JP_PLANAR = 3;
        public const int JP_MAX_VIRTUAL_JOINTS = 6;

        const string Library = "jointplay";
        const CallingConvention C = CallingConvention.Cdecl;

        [DllImport(Library, CallingConvention = C)] public static extern IntPtr jp_version();
        [DllImport(Library, CallingConvention = C)] public static extern UIntPtr jp_last_error([Out] byte[] text, UIntPtr size);
        [DllImport(Library, CallingConvention = C)] public static extern void jp_text_free(IntPtr text);

        [DllImport(Library, CallingConvention = C)] public static extern UIntPtr jp_virtual_joint_count(int virtualization);

        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_paper(out IntPtr robot);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_parse([In] byte[] toml, out IntPtr robot);
        [DllImport(Library, CallingConvention = C)] public static extern void jp_robot_free(IntPtr robot);
        [DllImport(Library, CallingConvention = C)] public static extern double jp_robot_working_height(IntPtr robot);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_inverse(IntPtr robot, double azimuth, double tilt, double height, [Out] double[] rods);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_forward(IntPtr robot, int virtualization, [In] double[] rods, [Out] double[] pose, [Out] double[] virtual_joints, [Out] double[] tilt);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_forward_many(IntPtr robot, int virtualization, UIntPtr count, [In] double[] rods, [Out] double[] poses, [Out] double[] virtual_joints, [Out] int[] codes);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_limits(IntPtr robot, [In] double[] rods, [Out] int[] exceeded);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_jacobian(IntPtr robot, int virtualization, [In] double[] rods, [Out] double[] jacobian, [Out] double[] virtual_joints);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_robot_json(IntPtr robot, [In] byte[] request, out IntPtr answer);

        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_parse([In] byte[] toml, out IntPtr mechanism);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_catalogue([In] byte[] name, out IntPtr mechanism);
        [DllImport(Library, CallingConvention = C)] public static extern void jp_mechanism_free(IntPtr mechanism);
        [DllImport(Library, CallingConvention = C)] public static extern UIntPtr jp_mechanism_coordinate_count(IntPtr mechanism);
        [DllImport(Library, CallingConvention = C)] public static extern UIntPtr jp_mechanism_joint_coordinate_count(IntPtr mechanism);
        [DllImport(Library, CallingConvention = C)] public static extern IntPtr jp_mechanism_coordinate_name(IntPtr mechanism, UIntPtr coordinate);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_coordinate_is_angle(IntPtr mechanism, UIntPtr coordinate);
        [DllImport(Library, CallingConvention = C)] public static extern UIntPtr jp_mechanism_drive_count(IntPtr mechanism);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_drive_coordinate(IntPtr mechanism, UIntPtr drive);
        [DllImport(Library, CallingConvention = C)] public static extern UIntPtr jp_mechanism_link_count(IntPtr mechanism);
        [DllImport(Library, CallingConvention = C)] public static extern IntPtr jp_mechanism_link_name(IntPtr mechanism, UIntPtr link);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_home(IntPtr mechanism, [Out] double[] positions);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_positions(IntPtr mechanism, [In] double[] drives, [In, Out] double[] positions);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_link_poses(IntPtr mechanism, [In] double[] positions, [Out] double[] poses);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_jacobian(IntPtr mechanism, [In] double[] positions, UIntPtr link, [Out] double[] jacobian, [Out] double[] rates);
        [DllImport(Library, CallingConvention = C)] public static extern int jp_mechanism_json(IntPtr mechanism, [In] byte[] request, out IntPtr answer);

        /// <summary>A text of .NET as UTF-8 with its NUL.</summary>
        public static byte[] Utf8(string text)
        {
            if (text.IndexOf('\0') >= 0) throw new ArgumentException("the text contains a NUL");
            return Encoding.UTF8.GetBytes(text + "\0");
        }

        /// <summary>A text of the library; null for NULL.</summary>
        public static string Text(IntPtr text)
        {
            if (text == IntPtr.Zero) return null;
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0) length++;
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        /// <summary>Throws the last error for any code but JP_OK.</summary>
        public static void Check(int code)
        {
            if (code == JP_OK) return;
            var bytes = new byte[(int)jp_last_error(null, UIntPtr.Zero)];
            jp_last_error(bytes, (UIntPtr)bytes.Length);
            throw new JointplayException(code, Encoding.UTF8.GetString(bytes, 0, bytes.Length - 1));
        }

        /// <summary>Takes an answer in JSON.</summary>
        internal static string Take(int code, IntPtr answer)
        {
            Check(code);
            try { return Text(answer); }
            finally { jp_text_free(answer); }
        }
    }

    /// <summary>An error of the library.</summary>
    public sealed class JointplayException : Exception
    {
        public readonly int Code;
        public JointplayException(int code, string text) : base(text) { Code = code; }
    }

    /// <summary>A handle that is freed exactly once, by Dispose or by the finalizer.</summary>
    public abstract class Handle : SafeHandle
    {
        protected Handle() : base(IntPtr.Zero, true) { }
        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
        /// <summary>The pointer, for calls of Native; keep this object alive during the call.</summary>
        public IntPtr Pointer
        {
            get
            {
                if (IsClosed) throw new ObjectDisposedException(GetType().Name);
                return handle;
            }
        }
    }

    /// <summary>A three-rod robot.</summary>
    public sealed class Robot : Handle
    {
        /// <summary>The robot of the paper.</summary>
        public Robot() { IntPtr made; Native.Check(Native.jp_robot_paper(out made)); SetHandle(made); }

        /// <summary>The robot of the text of a robot file (TOML).</summary>
        public Robot(string toml) { IntPtr made; Native.Check(Native.jp_robot_parse(Native.Utf8(toml), out made)); SetHandle(made); }

        protected override bool ReleaseHandle() { Native.jp_robot_free(handle); return true; }

        public double WorkingHeight
        {
            get { var height = Native.jp_robot_working_height(Pointer); GC.KeepAlive(this); return height; }
        }

        public double[] Inverse(double azimuth, double tilt, double height)
        {
            var rods = new double[3];
            Native.Check(Native.jp_robot_inverse(Pointer, azimuth, tilt, height, rods));
            GC.KeepAlive(this);
            return rods;
        }

        /// <summary>Pose by rows, 16 numbers, and displacements of the virtual joints.</summary>
        public double[] Forward(int virtualization, double[] rods, out double[] virtualJoints)
        {
            if (rods.Length != 3) throw new ArgumentException("3 rods are needed");
            var pose = new double[16];
            virtualJoints = new double[Native.JP_MAX_VIRTUAL_JOINTS];
            Native.Check(Native.jp_robot_forward(Pointer, virtualization, rods, pose, virtualJoints, null));
            GC.KeepAlive(this);
            return pose;
        }

        public string Json(string request)
        {
            IntPtr answer;
            var code = Native.jp_robot_json(Pointer, Native.Utf8(request), out answer);
            GC.KeepAlive(this);
            return Native.Take(code, answer);
        }
    }

    /// <summary>A mechanism with loops.</summary>
    public sealed class Mechanism : Handle
    {
        Mechanism(IntPtr made) { SetHandle(made); }

        /// <summary>The mechanism of the text of a mechanism file (TOML).</summary>
        public static Mechanism Parse(string toml)
        {
            IntPtr made;
            Native.Check(Native.jp_mechanism_parse(Native.Utf8(toml), out made));
            return new Mechanism(made);
        }

        public static Mechanism Catalogue(string name)
        {
            IntPtr made;
            Native.Check(Native.jp_mechanism_catalogue(Native.Utf8(name), out made));
            return new Mechanism(made);
        }

        protected override bool ReleaseHandle() { Native.jp_mechanism_free(handle); return true; }

        public int CoordinateCount
        {
            get { var count = (int)Native.jp_mechanism_coordinate_count(Pointer); GC.KeepAlive(this); return count; }
        }

        public int DriveCount
        {
            get { var count = (int)Native.jp_mechanism_drive_count(Pointer); GC.KeepAlive(this); return count; }
        }

        public int LinkCount
        {
            get { var count = (int)Native.jp_mechanism_link_count(Pointer); GC.KeepAlive(this); return count; }
        }

        public string LinkName(int link)
        {
            var name = Native.Text(Native.jp_mechanism_link_name(Pointer, (UIntPtr)link));
            GC.KeepAlive(this);
            return name;
        }

        public double[] Home()
        {
            var positions = new double[CoordinateCount];
            Native.Check(Native.jp_mechanism_home(Pointer, positions));
            GC.KeepAlive(this);
            return positions;
        }

        /// <summary>Solves for the positions, which hold a configuration nearby.</summary>
        public void Solve(double[] drives, double[] positions)
        {
            if (drives.Length != DriveCount) throw new ArgumentException(DriveCount + " drives are needed");
            if (positions.Length != CoordinateCount) throw new ArgumentException(CoordinateCount + " positions are needed");
            Native.Check(Native.jp_mechanism_positions(Pointer, drives, positions));
            GC.KeepAlive(this);
        }

        /// <summary>Poses of all links by rows, 16 numbers for each.</summary>
        public double[] LinkPoses(double[] positions)
        {
            if (positions.Length != CoordinateCount) throw new ArgumentException(CoordinateCount + " positions are needed");
            var poses = new double[16 * LinkCount];
            Native.Check(Native.jp_mechanism_link_poses(Pointer, positions, poses));
            GC.KeepAlive(this);
            return poses;
        }

        public string Json(string request)
        {
            IntPtr answer;
            var code = Native.jp_mechanism_json(Pointer, Native.Utf8(request), out answer);
            GC.KeepAlive(this);
            return Native.Take(code, answer);
        }
    }
}
