// The three-rod robot and a mechanism from C#.
// mcs Robot.cs Jointplay.cs -out:Robot.exe
using System;
using System.Globalization;
using System.Text;
using Jointplay;

static class Program
{
    static void Print(string text, params object[] values)
    {
        Console.WriteLine(string.Format(CultureInfo.InvariantCulture, text, values));
    }

    static void Main()
    {
        using (var robot = new Robot())
        {
            double degree = Math.PI / 180.0;
            var rods = robot.Inverse(17 * degree, 1.5 * degree, 0.5);
            Print("rods (mm)            {0:F6} {1:F6} {2:F6}", 1e3 * rods[0], 1e3 * rods[1], 1e3 * rods[2]);
            double[] joints;
            var pose = robot.Forward(Native.JP_RADIAL, rods, out joints);
            Print("shift (um)           {0:F3} {1:F3}", 1e6 * pose[3], 1e6 * pose[7]);
            Print("virtual joints (um)  {0:F3} {1:F3} {2:F3}", 1e6 * joints[0], 1e6 * joints[1], 1e6 * joints[2]);
            var document = robot.Json("{\"kind\": \"mobility\"}");
            Print("mobility in JSON     {0}", document.Contains("\"finite_mobility\":1") ? "1" : "?");
            try { robot.Inverse(0, 2, 0.5); }
            catch (JointplayException error) { Print("error {0}             {1}", error.Code, error.Message.Length > 0 ? "with its text" : ""); }
        }
        using (var mechanism = Mechanism.Catalogue("gpr-mechanism"))
        {
            var positions = mechanism.Home();
            for (int step = 1; step <= 10; step++)
                mechanism.Solve(new double[] { -2.3e-4 * step, 0.5e-4 * step, 1.8e-4 * step }, positions);
            var poses = mechanism.LinkPoses(positions);
            int last = mechanism.LinkCount - 1;
            Print("{0,-20} {1:F3} {2:F3} {3:F3} mm", mechanism.LinkName(last),
                1e3 * poses[16 * last + 3], 1e3 * poses[16 * last + 7], 1e3 * poses[16 * last + 11]);
        }
        // Calls in a loop, with all conversions of .NET.
        using (var robot = new Robot())
        {
            double[] rods = { 0.4977, 0.5005, 0.5018 }, pose = new double[16];
            for (int i = 0; i < 100000; i++)
                Native.Check(Native.jp_robot_forward(robot.Pointer, Native.JP_PLANAR, rods, pose, null, null));
            Print("repeated             {0:F3} {1:F3}", 1e6 * pose[3], 1e6 * pose[7]);
        }
    }
}
