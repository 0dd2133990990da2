// Runs the playback against components that record each call: names, order, and units are compared.
using System;
using System.Collections.Generic;
using System.IO;
using Jointplay.SolidWorks;
using SolidWorks.Interop.sldworks;

internal sealed class Transform : MathTransform
{
    public object ArrayData { get; set; }
}

internal sealed class Component : Component2
{
    private readonly List<string> calls;
    private MathTransform transform;
    public bool Fixed;

    public Component(string name, double[] array, List<string> calls)
    {
        Name2 = name;
        transform = new Transform { ArrayData = array };
        this.calls = calls;
    }

    public string Name2 { get; private set; }
    public MathTransform Transform2
    {
        get { return transform; }
        set { calls.Add("Transform2 " + Name2); transform = value; }
    }
    public double[] Array { get { return (double[])transform.ArrayData; } }
    public bool IsFixed() { return Fixed; }

    /// A point of the component in the assembly, as SolidWorks computes it: the row vector times the matrix.
    public double[] Point(double x, double y, double z)
    {
        double[] a = Array, p = { x, y, z }, found = new double[3];
        for (int i = 0; i < 3; i++) found[i] = p[0] * a[i] + p[1] * a[3 + i] + p[2] * a[6 + i] + a[9 + i];
        return found;
    }
}

internal sealed class Assembly : AssemblyDoc, ModelDoc2, MathUtility, SldWorks, CommandManager, CommandGroup, EquationMgr
{
    public readonly List<KeyValuePair<string, double>> Equations = new List<KeyValuePair<string, double>>();
    public readonly List<string> Messages = new List<string>();
    public string Chosen = "";
    public object Callbacks;
    public EquationMgr GetEquationMgr() { return this; }
    public int GetCount() { return Equations.Count; }
    public string get_Equation(int index) { return Equations[index].Key; }
    public double get_Value(int index) { return Equations[index].Value; }
    public bool SetAddinCallbackInfo2(long module, object callbacks, int cookie)
    {
        Calls.Add("SetAddinCallbackInfo2 " + module + " " + cookie);
        Callbacks = callbacks;
        return true;
    }
    public CommandManager GetCommandManager(int cookie) { Calls.Add("GetCommandManager " + cookie); return this; }
    public CommandGroup CreateCommandGroup2(int user, string title, string tip, string hint, int position, bool ignore, ref int errors)
    {
        Calls.Add("CreateCommandGroup2 " + user + " " + title);
        return this;
    }
    public int RemoveCommandGroup2(int user, bool runtimeOnly) { Calls.Add("RemoveCommandGroup2 " + user + " " + runtimeOnly); return 0; }
    public bool HasMenu { get; set; }
    public bool HasToolbar { get; set; }
    public int AddCommandItem2(string name, int position, string hint, string tip, int image, string callback, string enable, int user, int type)
    {
        Calls.Add("AddCommandItem2 " + callback + " " + user + " " + type);
        return 0;
    }
    public bool Activate() { Calls.Add("Activate " + HasMenu + " " + HasToolbar); return true; }
    public string GetOpenFileName(string title, string initial, string filter, out int options, out string configuration, out string display)
    {
        Calls.Add("GetOpenFileName " + title);
        options = 0;
        configuration = display = "";
        return Chosen;
    }
    public int SendMsgToUser2(string message, int icon, int buttons) { Messages.Add(icon + " " + buttons + " " + message); return 1; }
    public readonly List<string> Calls = new List<string>();
    public readonly List<object> Components = new List<object>();
    public object Active;
    public Assembly() { Active = this; }
    public object ActiveDoc { get { return Active; } }
    public object GetMathUtility() { Calls.Add("GetMathUtility"); return this; }
    public object GetComponents(bool topLevelOnly) { Calls.Add("GetComponents " + topLevelOnly); return Components.ToArray(); }
    public void GraphicsRedraw2() { Calls.Add("GraphicsRedraw2"); }
    public object CreateTransform(object array)
    {
        var numbers = (double[])array;
        if (numbers.Length != 16) throw new Exception("16 numbers are expected");
        Calls.Add("CreateTransform");
        return new Transform { ArrayData = numbers };
    }
}

internal static class PlaybackTests
{
    internal static readonly double[] Identity = { 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0 };
    private const string Heading = "q_mm,arm_x_mm,arm_y_mm,arm_z_mm,arm_qw,arm_qx,arm_qy,arm_qz";
    private const string Half = "0.70710678118654757";
    private const string Table = Heading + "\n0,0,0,0,1,0,0,0\n1,100,0,0," + Half + ",0,0," + Half + "\n";

    internal static void Check(bool holds, string what)
    {
        if (!holds) throw new Exception(what);
    }

    internal static void Near(double[] found, double x, double y, double z)
    {
        double[] expected = { x, y, z };
        for (int k = 0; k < 3; k++)
            Check(Math.Abs(found[k] - expected[k]) < 1e-12, "found " + string.Join(" ", found) + ", expected " + string.Join(" ", expected));
    }

    private static Playback Of(Assembly assembly, string table)
    {
        return new Playback(assembly, PoseTable.Read(new StringReader(table)));
    }

    private static void Refused(Action action, string part)
    {
        try { action(); }
        catch (PlaybackException error)
        {
            Check(error.Message.Contains(part), error.Message);
            return;
        }
        throw new Exception("not refused: " + part);
    }

    private static void CallsAreInOrderAndInMetres()
    {
        var assembly = new Assembly();
        // Drawn at 0.5 m along y, its x along y of the assembly.
        double[] drawn = { 0, 1, 0, -1, 0, 0, 0, 0, 1, 0, 0.5, 0, 1, 0, 0, 0 };
        var arm = new Component("arm-1", drawn, assembly.Calls);
        assembly.Components.Add(arm);
        assembly.Components.Add(new Component("cover-1", Identity, assembly.Calls));
        var playback = Of(assembly, Table);
        Check(playback.Count == 2 && playback.Unmatched.Count == 0, "two rows");
        playback.Show(0);
        Near(arm.Point(0.2, 0, 0), 0, 0.7, 0);
        playback.Show(1);
        // By hand: (0, 0.7) is turned to (−0.7, 0), and shifted by 0.1 m.
        Near(arm.Point(0.2, 0, 0), -0.6, 0, 0);
        Near(arm.Point(0, 0, 0.3), -0.4, 0, 0.3);
        Check(arm.Array[12] == 1 && arm.Array[13] == 0 && arm.Array[14] == 0 && arm.Array[15] == 0, "scale and zeros");
        string frame = "CreateTransform, Transform2 arm-1, GraphicsRedraw2";
        string expected = "GetMathUtility, GetComponents True, " + frame + ", " + frame;
        Check(string.Join(", ", assembly.Calls) == expected, string.Join(", ", assembly.Calls));
    }

    private static void BadInputHasItsReason()
    {
        Refused(() => PoseTable.Read(new StringReader("")), "no poses");
        Refused(() => PoseTable.Read(new StringReader("time,q_mm\n0,1\n")), "no poses");
        Refused(() => PoseTable.Read(new StringReader("arm_x_mm,arm_qw\n0,1\n")), "no whole pose of arm");
        Refused(() => PoseTable.Read(new StringReader(Heading + "\n")), "no rows");
        Refused(() => PoseTable.Read(new StringReader(Heading + "\n0,0,0\n")), "no number for");
        Refused(() => PoseTable.Read(new StringReader(Table.Replace("100,", "NaN,"))), "no number for arm_x_mm");
        Refused(() => PoseTable.Read(new StringReader(Table.Replace(Half, "1"))), "a quaternion");
        var assembly = new Assembly();
        Refused(() => Of(assembly, Table), "no component has the name of a link");
        assembly.Components.Add(new Component("arm-1", Identity, assembly.Calls) { Fixed = true });
        Refused(() => Of(assembly, Table), "arm-1 is fixed");
        assembly.Components.Add(new Component("arm-2", Identity, assembly.Calls));
        Refused(() => Of(new Assembly { Active = null }, Table), "open the assembly first");
        ((Component)assembly.Components[0]).Fixed = false;
        Refused(() => Of(assembly, Table), "two components have the name of the link arm");
    }

    /// A table of the command: rods of a tilted robot move along z, and the platform keeps its rotation a rotation.
    private static void TablesOfTheCommandArePlayed(string path)
    {
        var assembly = new Assembly();
        var parts = new Dictionary<string, Component>();
        foreach (string name in new[] { "rod 1", "rod 2", "rod 3", "platform" })
        {
            parts[name] = new Component(name + "-1", Identity, assembly.Calls);
            assembly.Components.Add(parts[name]);
        }
        Playback playback;
        using (var reader = new StreamReader(path)) playback = new Playback(assembly, PoseTable.Read(reader));
        playback.Show(playback.Count - 1);
        Near(parts["rod 1"].Point(0, 0, 0), 0, 0, 0.0031);
        Near(parts["rod 2"].Point(0, 0, 0), 0, 0, -0.00155);
        double[] a = parts["platform"].Array;
        double tilt = Math.Acos(a[8]) * 180 / Math.PI;
        Check(Math.Abs(Math.Tan(tilt * Math.PI / 180) - 0.00465 / (1.5 * 0.093218)) < 1e-4, "tilt " + tilt);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
            {
                double product = a[3 * i] * a[3 * j] + a[3 * i + 1] * a[3 * j + 1] + a[3 * i + 2] * a[3 * j + 2];
                Check(Math.Abs(product - (i == j ? 1 : 0)) < 1e-12, "rows are not orthonormal");
            }
    }

    private static int Main(string[] arguments)
    {
        try
        {
            CallsAreInOrderAndInMetres();
            BadInputHasItsReason();
            AddInTests.Run(arguments);
            if (arguments.Length > 0) TablesOfTheCommandArePlayed(arguments[0]);
        }
        catch (Exception error)
        {
            Console.WriteLine("failed: " + error);
            return 1;
        }
        Console.WriteLine("passed" + (arguments.Length > 0 ? ", with a table of the command" : "") + (arguments.Length > 1 ? " and the library" : ""));
        return 0;
    }
}
