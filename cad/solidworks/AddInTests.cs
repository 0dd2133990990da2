// Runs the add-in as SolidWorks does: by the names of its commands, against an application that records each call.
using System;
using System.Collections.Generic;
using System.IO;
using System.Reflection;
using Jointplay.SolidWorks;
using SolidWorks.Interop.swpublished;

internal static class AddInTests
{
    private const string Table = "arm_x_mm,arm_y_mm,arm_z_mm,arm_qw,arm_qx,arm_qy,arm_qz\n0,0,0,1,0,0,0\n100,0,0,1,0,0,0\n";

    private static void Command(Assembly application, string name)
    {
        MethodInfo method = application.Callbacks.GetType().GetMethod(name, Type.EmptyTypes);
        PlaybackTests.Check(method != null && method.IsPublic, "no command " + name);
        method.Invoke(application.Callbacks, null);
    }

    private static Assembly Connected()
    {
        var application = new Assembly();
        ISwAddin addIn = new AddIn { Interval = 0 };
        PlaybackTests.Check(addIn.ConnectToSW(application, 7), "the add-in does not connect");
        return application;
    }

    private static void CommandsAreRegisteredAndRemoved()
    {
        Assembly application = Connected();
        string expected = "SetAddinCallbackInfo2 0 7, GetCommandManager 7, CreateCommandGroup2 7401 Jointplay, "
            + "AddCommandItem2 PlayMotion 1 3, AddCommandItem2 DriveMechanism 2 3, Activate True True";
        PlaybackTests.Check(string.Join(", ", application.Calls) == expected, string.Join(", ", application.Calls));
        application.Calls.Clear();
        PlaybackTests.Check(((ISwAddin)application.Callbacks).DisconnectFromSW(), "the add-in does not disconnect");
        PlaybackTests.Check(string.Join(", ", application.Calls) == "GetCommandManager 7, RemoveCommandGroup2 7401 True", string.Join(", ", application.Calls));
    }

    private static void TablesArePlayedAndErrorsShown(string folder)
    {
        Assembly application = Connected();
        var arm = new Component("arm-1", PlaybackTests.Identity, application.Calls);
        application.Components.Add(arm);
        // Nothing is chosen.
        Command(application, "PlayMotion");
        PlaybackTests.Check(application.Messages.Count == 0, "a message without a reason");
        application.Chosen = Path.Combine(folder, "table.csv");
        Command(application, "PlayMotion");
        PlaybackTests.Check(application.Messages.Count == 1, "a file that is missing has a message");
        File.WriteAllText(application.Chosen, Table);
        Command(application, "PlayMotion");
        PlaybackTests.Near(arm.Point(0, 0, 0), 0.1, 0, 0);
        PlaybackTests.Check(application.Messages.Count == 1, string.Join("; ", application.Messages));
        File.WriteAllText(application.Chosen, "time_s\n0\n");
        Command(application, "PlayMotion");
        PlaybackTests.Check(application.Messages[1].StartsWith("1 2 the table has no poses"), application.Messages[1]);
        File.WriteAllText(application.Chosen, Table.Replace("arm", "leg") );
        Command(application, "PlayMotion");
        PlaybackTests.Check(application.Messages[2].Contains("no component has the name"), application.Messages[2]);
    }

    /// The add-in solves what the command has solved: the last row of its table.
    private static void AssembliesAreDriven(string table, string mechanism)
    {
        Assembly application = Connected(), expected = new Assembly();
        var driven = new Dictionary<string, Component>();
        var played = new Dictionary<string, Component>();
        // Each part is drawn elsewhere in its link.
        double[] drawn = { 0, 1, 0, -1, 0, 0, 0, 0, 1, 0.1, 0.5, 0.2, 1, 0, 0, 0 };
        foreach (string name in new[] { "rod 1", "rod 2", "rod 3", "platform" })
        {
            application.Components.Add(driven[name] = new Component(name + "-1", drawn, application.Calls));
            expected.Components.Add(played[name] = new Component(name + "-1", drawn, expected.Calls));
        }
        using (var reader = new StreamReader(table))
        {
            var playback = new Playback(expected, PoseTable.Read(reader));
            playback.Show(playback.Count - 1);
        }
        application.Chosen = mechanism;
        Command(application, "DriveMechanism");
        PlaybackTests.Check(application.Messages.Count == 1 && application.Messages[0].Contains("no global variable"), string.Join("; ", application.Messages));
        application.Equations.Add(new KeyValuePair<string, double>("\"rod 1\" = 3.1", 3.1));
        application.Equations.Add(new KeyValuePair<string, double>("\"rod 2\"=-1.55", -1.55));
        application.Equations.Add(new KeyValuePair<string, double>("\"D1@Sketch1\" = 20", 20));
        application.Equations.Add(new KeyValuePair<string, double>("\"rod 3\" = \"rod 2\"", -1.55));
        application.Calls.Clear();
        Command(application, "DriveMechanism");
        PlaybackTests.Check(application.Messages.Count == 1, string.Join("; ", application.Messages));
        string places = "CreateTransform, Transform2 rod 1-1, CreateTransform, Transform2 rod 2-1, CreateTransform, Transform2 rod 3-1, CreateTransform, Transform2 platform-1, GraphicsRedraw2";
        PlaybackTests.Check(string.Join(", ", application.Calls) == places, string.Join(", ", application.Calls));
        foreach (var one in driven)
            for (int k = 0; k < 16; k++)
                PlaybackTests.Check(Math.Abs(one.Value.Array[k] - played[one.Key].Array[k]) < 1e-9, one.Key + " is elsewhere than in the table");
        double[] before = driven["platform"].Array;
        application.Equations[0] = new KeyValuePair<string, double>("\"rod 1\" = 9000", 9000);
        Command(application, "DriveMechanism");
        PlaybackTests.Check(application.Messages.Count == 2 && driven["platform"].Array == before, "a drive without a solution moves nothing");
        application.Equations[0] = new KeyValuePair<string, double>("\"rod 1\" = 1/0", double.NaN);
        Command(application, "DriveMechanism");
        PlaybackTests.Check(application.Messages[2].Contains("rod 1 has no value"), application.Messages[2]);
        // Without a value the drive stays.
        application.Equations.RemoveAt(0);
        Command(application, "DriveMechanism");
        PlaybackTests.Near(driven["rod 1"].Point(0, 0, 0), 0.1, 0.5, 0.2031);
        PlaybackTests.Check(application.Messages.Count == 3, string.Join("; ", application.Messages));
        PlaybackTests.Check(((ISwAddin)application.Callbacks).DisconnectFromSW(), "the add-in does not disconnect");
    }

    /// <param name="arguments">A table of the command, and the mechanism file of it where the library is there.</param>
    internal static void Run(string[] arguments)
    {
        string folder = Path.Combine(Path.GetTempPath(), Path.GetRandomFileName());
        Directory.CreateDirectory(folder);
        try
        {
            CommandsAreRegisteredAndRemoved();
            TablesArePlayedAndErrorsShown(folder);
            if (arguments.Length > 1) AssembliesAreDriven(arguments[0], arguments[1]);
        }
        finally { Directory.Delete(folder, true); }
    }
}
