// An add-in of SolidWorks with two commands: play a table of poses, and move an assembly by global variables with the names of drives.
//
// Build Jointplay.SolidWorks.csproj, put jointplay.dll next to the result, and register it by regasm /codebase.
using System;
using System.Collections.Generic;
using System.IO;
using System.Runtime.InteropServices;
using System.Threading;
using Microsoft.Win32;
using SolidWorks.Interop.sldworks;
using SolidWorks.Interop.swpublished;

namespace Jointplay.SolidWorks
{
    /// <summary>The add-in; SolidWorks calls its methods by their names.</summary>
    [ComVisible(true), Guid("5B0A7D5C-6E0B-4F0C-9C0A-3B1F4B3B8E21"), ProgId("Jointplay.SolidWorks.AddIn")]
    public sealed class AddIn : ISwAddin
    {
        private const int Group = 7401;
        // swCommandItemType_e: swMenuItem and swToolbarItem.
        private const int MenuAndToolbar = 3;
        // swMessageBoxIcon_e and swMessageBoxBtn_e.
        private const int Warning = 1, Information = 2, Ok = 2;

        private SldWorks application;
        private int cookie;
        private Driver driver;
        private ModelDoc2 driven;

        /// <summary>Time between configurations of a table [ms].</summary>
        public int Interval = 40;

        public bool ConnectToSW(object ThisSW, int Cookie)
        {
            application = (SldWorks)ThisSW;
            cookie = Cookie;
            application.SetAddinCallbackInfo2(0, this, cookie);
            var manager = (CommandManager)application.GetCommandManager(cookie);
            int errors = 0;
            var group = (CommandGroup)manager.CreateCommandGroup2(Group, "Jointplay", "Jointplay", "Motions within the play of joints", -1, true, ref errors);
            if (group == null) return false;
            group.AddCommandItem2("Play motion", -1, "Moves the components by a table of poses", "Play motion", 0, "PlayMotion", "", 1, MenuAndToolbar);
            group.AddCommandItem2("Drive mechanism", -1, "Moves the components by global variables with the names of drives", "Drive mechanism", 1, "DriveMechanism", "", 2, MenuAndToolbar);
            group.HasMenu = true;
            group.HasToolbar = true;
            return group.Activate();
        }

        public bool DisconnectFromSW()
        {
            Forget();
            ((CommandManager)application.GetCommandManager(cookie)).RemoveCommandGroup2(Group, true);
            application = null;
            return true;
        }

        /// <summary>Command: plays a table of `jointplay move --poses`.</summary>
        public void PlayMotion()
        {
            Guarded(() =>
            {
                string path = Chosen("Table of poses", "Tables (*.csv)|*.csv|");
                if (path == null) return;
                PoseTable table;
                using (var file = File.OpenText(path)) table = PoseTable.Read(file);
                var playback = new Playback(application, table);
                for (int k = 0; k < playback.Count; k++)
                {
                    playback.Show(k);
                    if (Interval > 0) Thread.Sleep(Interval);
                }
                Report(playback.Unmatched);
            });
        }

        /// <summary>Command: places the components for the global variables; the mechanism file is asked for once for each assembly.</summary>
        public void DriveMechanism()
        {
            Guarded(() =>
            {
                var model = application.ActiveDoc as ModelDoc2;
                if (driver == null || !ReferenceEquals(driven, model))
                {
                    string path = Chosen("Mechanism file", "Mechanisms (*.toml)|*.toml|");
                    if (path == null) return;
                    Forget();
                    driver = new Driver(application, File.ReadAllText(path));
                    driven = model;
                    Report(driver.Unmatched);
                }
                driver.Show(Variables(model, driver.Drives));
            });
        }

        /// <summary>Values of the global variables of an assembly that have the names of drives (mm, degrees).</summary>
        private static Dictionary<string, double> Variables(ModelDoc2 model, IList<string> drives)
        {
            var values = new Dictionary<string, double>();
            EquationMgr equations = model.GetEquationMgr();
            for (int k = 0; k < equations.GetCount(); k++)
            {
                // A global variable is written "name" = value.
                string[] parts = equations.get_Equation(k).Split('"');
                if (parts.Length < 3 || parts[0].Trim().Length > 0 || !drives.Contains(parts[1])) continue;
                double value = equations.get_Value(k);
                if (double.IsNaN(value) || double.IsInfinity(value)) throw new PlaybackException("the global variable " + parts[1] + " has no value");
                values[parts[1]] = value;
            }
            if (values.Count == 0) throw new PlaybackException("no global variable has the name of a drive; drives are " + string.Join(", ", drives));
            return values;
        }

        private string Chosen(string title, string filter)
        {
            int options;
            string configuration, display;
            string path = application.GetOpenFileName(title, "", filter, out options, out configuration, out display);
            return string.IsNullOrEmpty(path) ? null : path;
        }

        private void Report(List<string> unmatched)
        {
            if (unmatched.Count > 0) application.SendMsgToUser2("Links without a component: " + string.Join(", ", unmatched), Information, Ok);
        }

        /// <summary>No exception leaves a command.</summary>
        private void Guarded(Action command)
        {
            try { command(); }
            catch (Exception error) { application.SendMsgToUser2(error.Message, Warning, Ok); }
        }

        private void Forget()
        {
            if (driver != null) driver.Dispose();
            driver = null;
            driven = null;
        }

        [ComRegisterFunction]
        public static void Register(Type type)
        {
            using (RegistryKey key = Registry.LocalMachine.CreateSubKey(Key(type)))
            {
                key.SetValue(null, 0);
                key.SetValue("Title", "Jointplay");
                key.SetValue("Description", "Motions within the play of joints");
            }
        }

        [ComUnregisterFunction]
        public static void Unregister(Type type)
        {
            Registry.LocalMachine.DeleteSubKey(Key(type), false);
        }

        private static string Key(Type type)
        {
            return @"SOFTWARE\SolidWorks\AddIns\{" + type.GUID.ToString().ToUpperInvariant() + "}";
        }
    }
}
